"""What a representation stores, element by element, with the stretch on which each matters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.representation import Representation
from multirep.splices import SpliceList


@attrs.frozen(eq=False)
class Elements:
    """One stored array: rows, and the support of each row.

    An edit must not change, by one bit, a row whose support does not meet the interior of its
    splices; rows may move up or down in the array when others come or go.

    Parameters
    ----------
    name : str
        For messages, as in "points".
    starts, stops : (n,) arrays
        The support of each row; equal for rows that sit at one parameter (a knot, say).
    rows : (n, k) array
    """

    name: str
    starts: Array
    stops: Array
    rows: Array

    def outside(self, splices: SpliceList) -> Array:
        """Return the rows whose support does not meet the interior of ``splices``, in order.

        Examples
        --------
        >>> knots = np.array([0.0, 0.25, 0.5, 1.0])
        >>> stored = Elements("knots", knots, knots, knots[:, None])
        >>> stored.outside(SpliceList([(0.25, 1)])).tolist()
        [[0.0], [0.25], [1.0]]
        """
        keep = np.ones(len(self.rows), dtype=bool)
        for splice in splices:
            point = (self.starts == self.stops) & (splice.start < self.starts)
            keep &= ~(point & (self.stops < splice.stop))
            keep &= ~((self.starts < splice.stop) & (splice.start < self.stops) & ~point)
        kept: Array = self.rows[keep]
        return kept


#: A function that lists what a representation stores; plugins may bring their own.
ElementsOf: TypeAlias = Callable[[Representation], Sequence[Elements]]


def default_elements(value: Representation) -> list[Elements]:
    """List what splines (``knots``, ``points``, ``weights``) and polylines (``t``) store.

    A control point i matters on [knots[i], knots[i + degree + 1]]; a vertex between its neighbours;
    a knot or a vertex parameter at itself, where a knot at or beyond an end of T may change with
    whatever is beside that end. Anything else is not known: the list is empty, and only evaluation
    is compared.
    """
    stored = {
        name: np.asarray(getattr(value, name))
        for name in ("t", "knots", "points", "weights")
        if hasattr(value, name)
    }
    if "points" not in stored:
        return []
    rows = stored["points"]
    if "knots" in stored:
        knots = stored["knots"]
        order = len(knots) - len(rows)
        starts, stops = knots[:-order], knots[order:]
        first, last = value.domain
        before, after = knots <= first, knots >= last
        found = [
            Elements(
                "knots",
                np.where(after, np.nextafter(last, -np.inf), np.where(before, -np.inf, knots)),
                np.where(before, np.nextafter(first, np.inf), np.where(after, np.inf, knots)),
                knots[:, None],
            ),
            Elements("points", starts, stops, rows),
        ]
        if "weights" in stored:
            found.append(Elements("weights", starts, stops, stored["weights"][:, None]))
        return found
    if "t" in stored:
        t = stored["t"]
        return [
            Elements("t", t, t, t[:, None]),
            Elements("points", np.r_[t[0], t[:-1]], np.r_[t[1:], t[-1]], rows),
        ]
    return []
