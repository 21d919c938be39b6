"""The sketch tool: strokes become the curve, over the same domain."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.arrays import Array
from multirep.errors import EditError, EditRejectedError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.strokes import curve_from_strokes, sketched
from multirep.testing import ToolSuite, check_certificate, check_edit
from multirep.testing.strategies import strokes
from multirep.tools import Sketch

ANGLE = np.linspace(0, 5, 300)
ARC = np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)
LINE = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]]


def drawn(seed: int) -> Array:
    return ARC + 0.01 * np.random.default_rng(seed).normal(size=ARC.shape)


class TestSketchSuite(ToolSuite):
    """The laws of tools."""

    malformed = (
        {},
        {"stroke": LINE, "strokes": [LINE]},
        {"stroke": []},
        {"stroke": [[0, 0], [float("nan"), 1]]},
        {"stroke": [[0, 0], [1]]},
        {"stroke": 3},
        {"strokes": []},
        {"strokes": [LINE, []]},
        {"strokes": 3},
        {"stroke": LINE, "noise": -1.0},
        {"stroke": LINE, "corner_angle": 0.0},
        {"stroke": LINE, "corner_angle": 200.0},
        {"stroke": LINE, "corner_window": 0.0},
    )

    @pytest.fixture
    def value(self) -> Polyline:
        return Polyline([1, 2, 4], LINE)

    @pytest.fixture
    def tool(self) -> Sketch:
        return Sketch(stroke=drawn(0), noise=0.01, corner_window=0.2)

    @pytest.fixture
    def refused(self) -> Sequence[Sketch]:
        return (
            Sketch(stroke=[[1, 1]]),
            Sketch(stroke=[[1, 1]] * 5),
            Sketch(stroke=[[0, 0, 0], [1, 1, 1]]),
            Sketch(stroke=LINE, noise=100.0),
            Sketch(strokes=[LINE, [[0, 50], [2, 50]]]),
        )


class TestSketchStrokesSuite(TestSketchSuite):
    """The laws of tools, for several strokes over each other."""

    @pytest.fixture
    def tool(self) -> Sketch:
        return Sketch(strokes=[drawn(0), drawn(1)[::-1], drawn(2)[50:200]])


@given(strokes(), st.sampled_from([(0.0, 1.0), (-3.0, 5.0), (1e6, 1e6 + 1)]))
def test_a_stroke_becomes_the_whole_curve(stroke: Array, domain: tuple[float, float]) -> None:
    """T stays, parameters follow the chord length, the splice is all of T."""
    before = Polyline(domain, [[0.0, 0.0], [1.0, 1.0]])
    edit = check_edit(
        before, lambda value: Sketch(stroke=stroke, noise=0.0).edit(value, mr.Scene())
    )
    after = edit.value
    assert after.domain == before.domain
    assert edit.splices == mr.SpliceList([domain])
    assert (np.asarray(after.points) == sketched([stroke], noise=0.0).points).all()
    chords = np.linalg.norm(np.diff(np.asarray(after.points), axis=0), axis=1)
    share = np.diff(np.asarray(after.t)) / (domain[1] - domain[0])
    assert share == pytest.approx(chords / chords.sum(), abs=1e-6)


def test_all_representations_follow_a_sketch() -> None:
    """Strokes with noise and corners, drawn over a curve that has been viewed: certified."""
    start = Nurbs(degree=1, knots=[0, 0, 1, 1], points=[[0, 0], [1, 1]])
    ears = np.concatenate([ARC, [[0.5, -1.5], [0.9, -1.0], [1.2, -1.6], [2.0, 0.0]]])
    curve = mr.MultiRepresentation(start, tolerance=0.01)
    for kind in (Polyline, Nurbs, WaveletBSpline):
        curve.view(kind)
    session = mr.Session()
    session.add("cat", curve)
    outcome = session.apply("cat", Sketch(strokes=[ears, drawn(1)]))
    assert outcome.changed == mr.SpliceList([(0, 1)])
    check_certificate(curve)
    session.undo()
    assert (curve.view(Nurbs).points[:] == [[0, 0], [1, 1]]).all()
    check_certificate(curve)


def test_a_session_that_starts_with_a_sketch() -> None:
    """A new curve from strokes equals the sketch tool on any curve over [0, 1]."""
    several = [drawn(0), drawn(1)]
    curve = curve_from_strokes(several, tolerance=0.01)
    check_certificate(curve)
    edit = Sketch(strokes=several).edit(Polyline([0, 1], [[0, 0], [1, 1]]), mr.Scene())
    assert not curve.view(Polyline).changes(edit.value)


def test_the_digitised_pen_strokes_become_curves() -> None:
    """Every third of the Hershey drawings: each stroke a curve whose views are certified."""
    data = Path(__file__).parents[1] / "data" / "strokes.json"
    seen = 0
    for item in json.loads(data.read_text())["items"][::3]:
        longest = max(item["strokes"], key=len)
        if len(longest) < 3:
            continue
        curve = curve_from_strokes([longest], tolerance=0.1)
        check_certificate(curve)
        seen += 1
    assert seen >= 20


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"stroke": [[1, 1]]}, "tool 'sketch': the stroke has 1 sample"),
        ({"stroke": [[1, 1], [1, 1]]}, "has no length"),
        ({"stroke": [[0, 0, 0], [1, 1, 1]]}, "the stroke has 3 coordinates, the curve 2"),
        ({"strokes": [LINE, [[0, 50], [2, 50]]]}, "stroke 2 is not drawn over the ones before"),
    ],
)
def test_refusals_say_what_was_found(parameters: dict[str, Any], message: str) -> None:
    """In a session: the tool, the reason, and nothing changed."""
    session = mr.Session()
    session.add("line", mr.MultiRepresentation.from_points(LINE, tolerance=0.01))
    before = session.curve("line").snapshot()
    with pytest.raises(EditRejectedError, match=message):
        session.apply("line", Sketch(**parameters))
    assert session.curve("line").snapshot() is before


def test_stroke_or_strokes() -> None:
    """Exactly one of the two is given."""
    with pytest.raises(EditError, match="either 'stroke' or 'strokes'; got neither"):
        Sketch()
    with pytest.raises(EditError, match="got both"):
        Sketch(stroke=LINE, strokes=[LINE])
