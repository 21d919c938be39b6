"""Slow definitions of what the polyline does, the law behind every edit, and tiny blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from multirep import blocks, capsules, nearest_tree
from multirep.arrays import Array
from multirep.edit import Edit
from multirep.representations.polyline import (
    Polyline,
    boxes,
    differences,
    evaluation,
)
from multirep.sampled import SampledSplice


def values(t: Array, points: Array, at: Array) -> Array:
    """Evaluate by ``np.interp``, coordinate by coordinate."""
    return np.stack([np.interp(at, t, column) for column in np.asarray(points).T], axis=1)


def dense(*parameters: Array, between: int = 5) -> Array:
    """All the given parameters, and ``between`` more in each gap."""
    marks = np.unique(np.concatenate([np.asarray(p) for p in parameters]))
    steps = np.linspace(0.0, 1.0, between + 2)[:-1]
    inner = marks[:-1, None] + steps * np.diff(marks)[:, None]
    return np.clip(np.append(inner.ravel(), marks[-1]), marks[0], marks[-1])


def distance_on_chords(polyline: Polyline, sampled: SampledSplice) -> Array:
    """The largest distance from L on each chord, seen at all corners of both and in between."""
    a, b = sampled.interval
    t = np.asarray(polyline.t)
    at = dense(t[(t >= a) & (t <= b)], sampled.t)
    off = values(t, polyline.points, at) - values(sampled.t, sampled.points, at)
    distance = np.linalg.norm(off, axis=1)
    seen = np.zeros(len(sampled.t) - 1)
    for side in ("left", "right"):
        chord = np.clip(sampled.t.searchsorted(at, side=side) - 1, 0, len(seen) - 1)
        np.maximum.at(seen, chord, distance)
    return seen


def check_edit(before: Polyline, edit: Edit[Polyline]) -> Polyline:
    """Check what must hold after any edit of a polyline; return the new value."""
    after = edit.value
    edit.splices.check()
    t = np.asarray(after.t)
    assert (t[1:] > t[:-1]).all()
    assert (t[0], t[-1]) == tuple(before.domain)
    assert len(after.points) == len(t) == after.size
    assert np.isfinite(np.asarray(after)).all()
    assert edit.splices.contains(before.changes(after))
    assert edit.splices.contains(after.changes(before))
    outside = [s for s in dense(before.t, t) if not edit.splices.contains(s)]
    ends = [s for splice in edit.splices for s in splice if s not in tuple(before.domain)]
    at = np.array([*outside, *ends])
    assert before(at).tobytes() == after(at).tobytes()
    for one, other in ((before, after), (after, before)):
        kept = [s for s in np.asarray(one.t).tolist() if not _inside(edit, s)]
        assert np.isin(kept, np.asarray(other.t)).all()
    assert after.magnitude == np.abs(np.asarray(after)).max()
    return after


def _inside(edit: Edit[Polyline], s: float) -> bool:
    """Whether a parameter lies in the interior of the splices (relative to the domain)."""
    a, b = edit.value.domain
    return any(x < s < y or (s == a == x) or (s == b == y) for x, y in map(tuple, edit.splices))


@pytest.fixture
def tiny_blocks() -> Iterator[None]:
    """Blocks of 8 rows and leaves of 3, so that short curves have many."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "BLOCK_ROWS", 8)
        patch.setattr(boxes, "LEAF", 3)
        patch.setattr(capsules, "FAN", 2)
        patch.setattr(nearest_tree, "FAN", 2)
        patch.setattr(nearest_tree, "_CHILDREN", np.arange(2))
        patch.setattr(differences, "NARROW", 4)
        patch.setattr(evaluation, "NARROW", 4)
        yield
