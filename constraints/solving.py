"""Meeting many linear conditions on a NURBS at once, by the smallest change of control points.

Only the control points that act where a condition is broken may move, and a few rings around them
if these are too few; every condition that they act on is a row of the system, broken or not, so
nothing that held is lost. The ends of the curve
and the direction in which it leaves a frozen stretch stay if possible. Where the rows leave too
little freedom, knots are inserted around their parameters and the solve is tried again, a few
times; conditions that still cannot be told apart are a conflict. The moves of a gesture share what
they factor.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from multirep.aim import Aim
from multirep.arrays import Flags
from multirep.constraints.condition import Condition, Rows
from multirep.edit import Edit
from multirep.errors import ConflictError, FrozenError
from multirep.memory import Memory, factored_once
from multirep.representations.nurbs import Nurbs
from multirep.representations.nurbs.borders import acts_on, bends_at, halfway_knots
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.splines import LeastNorm

#: A solve of this quality (see :func:`multirep.splines.least_norm`) is taken at once. Larger
#: inserts more knots, smaller lets the curve swing more between close conditions.
GOOD = 0.05
#: A solve below this is none: changes would be a thousand times what is missed.
LEAST = 1e-3
#: How often knots may be inserted around the parameters; each time the spans there are halved.
REFINEMENTS = 6
#: Two targets of one condition are the same within this part of the largest coordinate.
SAME = 1e-12
#: What counts as met, likewise: it only keeps rounding from being "corrected". It is also what a
#: control point must contribute to a row, in terms of its largest entry, to act there.
MET = 1e-14
#: A control point that would move by no more than this, likewise, stays.
STILL = 2.0**-52
#: How far the freedom may spread along a chain of conditions, from those that are broken to those
#: whose control points they share. More rarely helps: the share falls off with every one.
RINGS = 4

Named = tuple[str, Condition]


def solved(curve: Nurbs, named: Sequence[Named], scene: Scene) -> Edit[Nurbs]:
    """Return an edit that meets all conditions; each comes with the name of its constraint.

    What the tool asked for (``scene.aims``) is kept as well where that is possible, and so is the
    place of a point of which only the direction is told.

    Raises
    ------
    ConflictError, FrozenError
    """
    value, splices = _with_corners(curve, named, scene.frozen)
    wanted = _merged(value, named)
    kept = [*_aimed(value, scene.aims, wanted), *_standing(value, wanted)]
    found = _attempted(value, [*wanted, *kept], scene)
    if kept and not isinstance(found, Edit):
        found = _attempted(value, wanted, scene)
    if isinstance(found, Edit):
        return Edit(found.value, splices | found.splices)
    names = tuple(dict.fromkeys(name for name, _ in found))
    listed = " and ".join(map(repr, names))
    places = sorted({condition.t for _, condition in found})
    raise ConflictError(
        f"{listed} ask for more than the control points around t = "
        f"{', '.join(map(repr, places))} can give",
        constraints=names,
    )


def _with_corners(
    curve: Nurbs, named: Iterable[Named], frozen: SpliceList
) -> tuple[Nurbs, SpliceList]:
    """Raise the knots at corners to full multiplicity; FrozenError where that is frozen."""
    domain = curve.domain
    missing: dict[float, int] = {}
    for name, condition in named:
        t = condition.t
        if not condition.breaks or not domain.start < t < domain.stop or _is_corner(curve, t):
            continue
        if frozen.contains(t):
            raise FrozenError(
                f"{name!r} needs a corner at t = {t!r}: the curve is frozen on {frozen}",
                constraints=(name,),
            )
        missing[t] = curve.degree - _multiplicity(curve, t)
    edit = curve.insert_knots([t for t, count in missing.items() for _ in range(count)])
    return edit.value, edit.splices


def _merged(curve: Nurbs, named: Iterable[Named]) -> list[Named]:
    """Sort conditions by t and drop repeated ones.

    Raises
    ------
    ConflictError
        When two ask for different things in one place.
    """
    found: dict[tuple[float, int, str], Named] = {}
    scale = curve.magnitude
    for name, condition in named:
        sided = condition.order == 1 and _is_corner(curve, condition.t)
        key = (condition.t, condition.order, condition.side if sided else "")
        if key not in found:
            found[key] = (name, condition)
            continue
        other, target = found[key][0], np.asarray(found[key][1].target)
        if target.shape != np.shape(condition.target):
            continue  # the wrong dimension is reported with the rows
        apart = float(np.linalg.norm(target - condition.target))
        if apart > SAME * max(scale, float(np.abs(target).max())):
            what = "points" if condition.order == 0 else "derivatives"
            off = apart * float(Rows.of(curve, [condition]).lengths[0])
            raise ConflictError(
                f"{other!r} and {name!r} ask for different {what} at t = {condition.t!r}, "
                f"{apart:.3g} apart",
                constraints=dict.fromkeys((other, name)),
                residuals={other: off, name: off},
            )
    return sorted(found.values(), key=lambda item: _place(item[1]))


def _place(condition: Condition) -> tuple[float, bool]:
    # The left side of a corner reads control points before those of the right side.
    return condition.t, condition.order == 0 or condition.side == "right"


def _is_corner(curve: Nurbs, t: float) -> bool:
    return _multiplicity(curve, t) >= curve.degree


def _multiplicity(curve: Nurbs, t: float) -> int:
    knots = curve.knots
    return int(knots.searchsorted(t, "right") - knots.searchsorted(t))


def _aimed(curve: Nurbs, aims: Iterable[Aim], wanted: Sequence[Named]) -> list[Named]:
    """Conditions, without a name, that keep the curve at the aims where it is now."""
    points = {c.t for _, c in wanted if c.order == 0}
    slopes = {(c.t, c.side) for _, c in wanted if c.order == 1}
    found: list[Named] = []
    for aim in aims:
        if not curve.domain.contains(aim.t):
            continue
        if aim.point is not None and aim.t not in points:
            found.append(("", Condition(aim.t, 0, tuple(curve(aim.t).tolist()))))
        for side, target in (("left", aim.left), ("right", aim.right)):
            if target is not None and (aim.t, side) not in slopes:
                slope = curve.derivative(aim.t, side=side)
                found.append(("", Condition(aim.t, 1, tuple(slope.tolist()), side)))  # type: ignore[arg-type]
    return found


def _standing(curve: Nurbs, wanted: Sequence[Named]) -> list[Named]:
    """Conditions, without a name, that keep the curve in place where only its direction is told.

    Without them a turned tangent drags the point along (NURBS book, figure 11.36b and c).
    """
    points = {c.t for _, c in wanted if c.order == 0}
    slopes = {c.t for _, c in wanted if c.order == 1}
    return [("", Condition(t, 0, tuple(curve(t).tolist()))) for t in sorted(slopes - points)]


def _attempted(curve: Nurbs, named: Sequence[Named], scene: Scene) -> Edit[Nurbs] | list[Named]:
    """Meet the conditions, or return those that exclude each other."""
    named = sorted(named, key=lambda item: _place(item[1]))
    steps = [Edit(curve, SpliceList.EMPTY)]
    culprits: list[Named] = []
    for _ in range(REFINEMENTS + 1):
        value = steps[-1].value
        found = _met(value, named, scene, gentle=True, enough=GOOD)
        if isinstance(found, Edit):
            return _after(steps[-1], found)
        culprits = found
        finer = halfway_knots(value, [c.t for _, c in culprits], scene.frozen)
        if not finer:
            break
        steps.append(_after(steps[-1], value.insert_knots(finer)))
    for step, gentle, enough in (
        (steps[0], False, GOOD),
        (steps[-1], True, LEAST),
        (steps[-1], False, LEAST),
        (steps[0], False, LEAST),
    ):
        found = _met(step.value, named, scene, gentle=gentle, enough=enough)
        if isinstance(found, Edit):
            return _after(step, found)
    return culprits


def _after(first: Edit[Nurbs], second: Edit[Nurbs]) -> Edit[Nurbs]:
    return Edit(second.value, first.splices | second.splices)


def _met(
    curve: Nurbs, named: Sequence[Named], scene: Scene, *, gentle: bool, enough: float
) -> Edit[Nurbs] | list[Named]:
    """Meet the conditions on the control points there are, or return those that crowd them."""
    frozen = scene.frozen
    conditions = [condition for _, condition in named]
    system = Rows.of(curve, conditions)
    broken = system.missed > MET * curve.magnitude
    if not broken.any():
        return Edit(curve, SpliceList.EMPTY)
    columns = system.starts[:, None] + np.arange(system.rows.shape[1])
    acting = np.abs(system.rows) > MET * np.abs(system.rows).max(axis=1, keepdims=True)
    allowed = ~acts_on(curve, system.first, len(system.points), frozen)
    _check_ice(system, broken, allowed, named, frozen)
    if gentle:
        allowed &= ~_better_left(curve, system, conditions, frozen)
    moving = broken
    culprits: list[Named] = []
    for _ in range(RINGS):
        movable = np.zeros(len(system.points), dtype=bool)
        movable[columns[moving][acting[moving]]] = True
        concerned = (movable[columns] & acting).any(axis=1)
        found = _solve(system, concerned, movable & allowed, scene.memory)
        if found.quality >= enough:
            return _moved(
                curve, system, found, conditions, concerned, movable & allowed, scene.memory
            )
        culprits = [named[k] for k in np.flatnonzero(concerned)[found.culprits].tolist()]
        if (concerned == moving).all():
            break
        moving = concerned
    return culprits


def _moved(
    curve: Nurbs,
    system: Rows,
    found: LeastNorm,
    conditions: Sequence[Condition],
    concerned: Flags,
    free: Flags,
    memory: Memory,
) -> Edit[Nurbs]:
    """Move the control points, and once more for what rounding has left."""
    edit = _shifted(curve, system, found)
    again = Rows.of(edit.value, conditions)
    if again.missed.max() <= MET * curve.magnitude:
        return edit
    return _after(edit, _shifted(edit.value, again, _solve(again, concerned, free, memory)))


def _shifted(curve: Nurbs, system: Rows, found: LeastNorm) -> Edit[Nurbs]:
    """Move control points, but none by less than rounding: who need not move keeps his bits."""
    change = found.change
    change[np.abs(change).max(axis=1) <= STILL * curve.magnitude] = 0.0
    return curve.move_control_points(system.first, system.points + change)


def _better_left(
    curve: Nurbs, system: Rows, conditions: Sequence[Condition], frozen: SpliceList
) -> Flags:
    """Control points that had better stay: ends of the curve, and how it leaves what is frozen."""
    count = len(system.points)
    left = bends_at(curve, system.first, count, frozen)
    index = system.first + np.arange(count)
    if conditions[0].t > curve.domain.start:
        left |= index == 0
    if conditions[-1].t < curve.domain.stop:
        left |= index == curve.size - 1
    return left


def _check_ice(
    system: Rows, broken: Flags, allowed: Flags, named: Sequence[Named], frozen: SpliceList
) -> None:
    """Raise when all that acts on a broken condition is frozen."""
    if not frozen:
        return
    columns = system.starts[:, None] + np.arange(system.rows.shape[1])
    acting = (np.abs(system.rows) * allowed[columns]).max(axis=1)
    stuck = broken & (acting <= LEAST * np.abs(system.rows).max(axis=1))
    if stuck.any():
        names = tuple(dict.fromkeys(named[k][0] for k in np.flatnonzero(stuck).tolist()))
        place = named[int(stuck.argmax())][1].t
        raise FrozenError(
            f"{' and '.join(map(repr, names))} cannot hold at t = {place!r}: "
            f"the curve is frozen on {frozen}",
            constraints=names,
        )


def _solve(system: Rows, concerned: Flags, free: Flags, memory: Memory) -> LeastNorm:
    starts, rows = system.starts[concerned], system.rows[concerned]
    return factored_once(memory, starts, rows, free).solve(system.wanted[concerned])
