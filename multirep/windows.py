"""Windows: the part of a stale stretch that is looked at, and how the rest is left alone.

A view of a part of T costs that part, however long the stale stretch around it is. The value of a
kind is one continuous curve, though, and beyond the window it still follows what is no longer true,
perhaps far away. So a window is spliced in with an *apron* on each side where stale curve goes on:
over it the target fades, with two continuous derivatives, from the authors to what the kind holds.
The apron stays stale, so its fit may be loose; only the window is up to date.

A kind without a value begins from a crude one, a fit of a handful of points that is stale
everywhere.
"""

from __future__ import annotations

from collections.abc import Iterator

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.bulk import controls_on
from multirep.errors import MultirepError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, chord_bounds
from multirep.splices import SpliceList
from multirep.state import State

#: Length of an apron in terms of its window. Longer costs samples, shorter costs control points
#: when the fade gets steeper than the curve.
APRON = 1 / 4
#: The shortest window, and apron, in terms of T: a fade needs room for its knots.
SHORTEST = 2.0**-12
#: Where no more than so many aprons of stale stretch are left beside a window, it takes them too.
SMALL_REST = 2.0
#: A stale stretch of which so large a part is asked for is brought up to date as a whole.
MOST = 1 / 2
#: How much more than a hop, in hops, the fit may be off on an apron. Larger saves control points
#: there, and unbalances the equations.
LOOSER = 15.0
#: A window in which the curve would be followed by fewer chords than this is widened.
CHORDS = 64.0
#: By how many times its length at most, or else by what holds so many controls of the authors: to
#: follow these costs no more than a few splices do anyway.
MOST_GROWTH = 4.0
AFFORDABLE = 16384.0
#: In so many chords a window is looked at for that.
LOOKS = 128
#: Parameters on each apron at which the fade is laid out.
FADE_POINTS = 16
#: Where authors are looked at for a crude value, in terms of T: uneven, lest a periodic curve is
#: met at the same point each time.
CRUDE = np.array([0.0, 0.1, 0.23, 0.38, 0.5, 0.65, 0.77, 0.91, 1.0])
#: How far a crude value may be from those points, in terms of how far they are apart.
CRUDE_SHARE = 1 / 4


@attrs.frozen
class Window:
    """What one splice brings up to date, and the stale stretch in which its aprons may lie.

    Parameters
    ----------
    fresh : Interval
        What becomes up to date.
    stale : Interval
        Holds ``fresh``; where it reaches beyond, the window is cut.
    apron : float
        Length of an apron; there is room for more than one on each side that is cut.
    """

    fresh: Interval
    stale: Interval
    apron: float = 0.0

    @property
    def cut(self) -> bool:
        """Whether stale curve is left on some side."""
        return self.fresh is not self.stale and self.fresh != self.stale

    def target(self) -> Interval:
        """Return the least that a splice must cover: the window and its aprons."""
        return self._extended(self.apron, 0.0) if self.cut else self.fresh

    def within(self, reach: float, room: Interval) -> Interval:
        """Return the most that a splice may cover.

        Beside what is stale that is two aprons times ``reach``, elsewhere the window's length times
        ``reach``, as far as the room goes.
        """
        return self._extended(2.0 * reach * self.apron, reach * self.fresh.length).clipped(room)

    def refreshed(self, target: Interval) -> Interval:
        """Return what is up to date after a splice on ``target``: all but the aprons."""
        if not self.cut:
            return target
        (a, b), (low, high) = self.fresh, self.stale
        return Interval(a if low < a else target.start, b if b < high else target.stop)

    def after(self, t: float) -> Window:
        """Return the window when all up to ``t`` is up to date already."""
        if self.stale.start >= t:
            return self
        start = max(self.fresh.start, t)
        return Window(Interval(start, self.fresh.stop), Interval(t, self.stale.stop), self.apron)

    def is_near(self, later: Window) -> bool:
        """Whether nothing stale lies between two windows, and less than either is long."""
        gap = later.fresh.start - self.fresh.stop
        whole = self.fresh.stop == self.stale.stop and later.fresh.start == later.stale.start
        return whole and gap < min(later.fresh.length, self.fresh.length)

    def hull(self, other: Window) -> Window:
        """Return the window that covers both and what is between them."""
        return Window(
            self.fresh.hull(other.fresh), self.stale.hull(other.stale), max(self.apron, other.apron)
        )

    def _extended(self, cut: float, whole: float) -> Interval:
        (a, b), (low, high) = self.fresh, self.stale
        return Interval(
            max(a - cut, low) if low < a else a - whole,
            min(b + cut, high) if b < high else b + whole,
        )


def windows(stale: SpliceList, where: SpliceList, domain: Interval) -> Iterator[Window]:
    """Return what to bring up to date of ``stale`` so that nothing of it is left on ``where``.

    Parameters
    ----------
    stale, where : SpliceList
    domain : Interval
        T.

    Returns
    -------
    iterator of Window
        From left to right. Little rests beside a window are taken with it, and so are gaps between
        windows in which two aprons have no room; half of a stretch or more is all of it.

    Examples
    --------
    >>> T = Interval(0, 1)
    >>> for window in windows(SpliceList([T]), SpliceList([(0, 0.1), (0.5, 0.6)]), T):
    ...     print(window.fresh, "of", window.stale)
    [0, 0.1] of [0, 0.5]
    [0.5, 0.6] of [0.1, 1]
    """
    for stretch in stale:
        if where.contains(stretch):
            yield Window(stretch, stretch)
            continue
        parts = list(where & SpliceList([stretch]))
        if not parts:
            continue
        taken: list[Interval] = []
        for asked in parts:
            growth = max(0.5 * (SHORTEST * domain.length - asked.length), 0.0)
            part = _with_rests(asked.widened(growth).clipped(stretch), stretch, domain)
            while taken and not _have_room(taken[-1], part, domain):
                part = _with_rests(taken.pop().hull(part), stretch, domain)
            taken.append(part)
        if sum(part.length for part in taken) >= MOST * stretch.length:
            taken = [stretch]
        ends = [stretch.start, *(part.stop for part in taken)]
        starts = [*(part.start for part in taken), stretch.stop]
        for k, part in enumerate(taken):
            around = Interval(ends[k], starts[k + 1])
            yield Window(part, around, _apron(part, domain))


def _with_rests(part: Interval, stretch: Interval, domain: Interval) -> Interval:
    """Take what is left of a stretch beside a part where that is little."""
    rest = SMALL_REST * _apron(part, domain)
    return Interval(
        part.start if part.start - stretch.start > rest else stretch.start,
        part.stop if stretch.stop - part.stop > rest else stretch.stop,
    )


def _have_room(one: Interval, two: Interval, domain: Interval) -> bool:
    """Whether there is room for two aprons between two parts."""
    longer = max(_apron(one, domain), _apron(two, domain))
    return two.start - one.stop > SMALL_REST * longer


def worthwhile(state: State, window: Window, *, delta: float) -> Window:
    """Return a window that is not shorter than the curve's features, on the sides that are cut.

    Each splice leaves some control points for its joins, and costs the same however little happens
    in it. So a window in which the curve hardly bends takes in more of what is stale. The authors
    are looked at in a fixed number of places.
    """
    t = np.linspace(window.fresh.start, window.fresh.stop, LOOKS + 1)
    points = _looked(state, t)
    kinks = points[2:] - 2.0 * points[1:-1] + points[:-2]
    # so many chords of the sagitta delta make half the kink between two looks
    chords = np.sqrt(np.sqrt(np.einsum("ij,ij->i", kinks, kinks)) / (8.0 * delta))
    found = float(np.minimum(chords, 1.0).sum())
    if found >= CHORDS:
        return window
    most = max(MOST_GROWTH, AFFORDABLE / max(controls_on(state, window.fresh), 1))
    growth = 0.5 * window.fresh.length * min(CHORDS / max(found, CHORDS / most), most)
    (a, b), (low, high) = window.fresh, window.stale
    rest = SMALL_REST * APRON * growth
    start = a - growth if a - growth - rest > low else low
    stop = b + growth if b + growth + rest < high else high
    return Window(Interval(start, stop), window.stale, APRON * (stop - start))


def _apron(part: Interval, domain: Interval) -> float:
    return max(APRON * part.length, SHORTEST * domain.length)


def faded(
    sampled: SampledSplice, value: Representation, window: Window, *, delta: float
) -> SampledSplice:
    """Let what the authors say fade into ``value`` over the aprons of a window.

    Parameters
    ----------
    sampled : SampledSplice
        Of the authors, on the window and its aprons.
    value : Representation
        What the kind holds.
    window : Window
    delta : float
        The hop; what is allowed on an apron is a multiple of it.

    Returns
    -------
    SampledSplice
        On the window the same polyline, with the same certificates and allowances.
    """
    a, b = window.refreshed(sampled.interval)
    (start, stop), steps = sampled.interval, np.linspace(0.0, 1.0, FADE_POINTS + 1)
    t = np.concatenate((sampled.t, a - steps * (a - start), b + steps * (stop - b)))
    t = np.unique(t[(t >= start) & (t <= stop)])
    points = sampled(t)
    on_left, on_right = t < a, t > b
    for on, begin, end in ((on_left, start, a), (on_right, stop, b)):
        if on.any():
            share = _smoothstep((t[on] - begin) / (end - begin))[:, None]
            points[on] = (1.0 - share) * value(t[on]) + share * points[on]
    chords = np.minimum(sampled.t.searchsorted(t[:-1], "right") - 1, len(sampled.t) - 2)
    bounds = chord_bounds(sampled)[chords] + LOOSER * delta
    bounds[on_left[:-1] | on_right[1:]] = 0.0  # of what fades, the target is all there is
    return SampledSplice(
        t,
        points,
        bound=sampled.bound + LOOSER * delta,
        breaks=tuple(at for at in sampled.breaks if a <= at <= b),
        chord_bounds=bounds,
    )


def _smoothstep(u: Array) -> Array:
    """Return the polynomial that leads from 0 to 1 with two derivatives 0 at both ends."""
    rising: Array = u * u * u * (10.0 + u * (6.0 * u - 15.0))
    return rising


def crude(state: State, kind: type[Representation], *, delta: float) -> Representation | None:
    """Return a curve of a kind through a handful of points of the authors, or None if it cannot.

    Cost: that of so many evaluations, at any length of the curve.
    """
    domain = state.authors.domain
    t = domain.start + CRUDE * domain.length
    t[-1] = domain.stop
    points = _looked(state, t)
    size = float(np.abs(points - points[0]).max())
    try:
        value = kind.fit(SampledSplice(t, points), tolerance=max(CRUDE_SHARE * size, delta))
    except MultirepError:
        return None
    return value if value.domain == domain else None


def _looked(state: State, t: Array) -> Array:
    """Evaluate the authors at increasing parameters, (m,) -> (m, d)."""
    segments = state.authors.segments(Interval(float(t[0]), float(t[-1])))
    marks = [*t.searchsorted([part.start for part, _ in segments]).tolist(), len(t)]
    return np.concatenate(
        [
            state.author_value(name)(t[i:j])
            for i, j, (_, name) in zip(marks, marks[1:], segments, strict=False)
            if i < j
        ]
    )
