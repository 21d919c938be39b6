"""What the compiled core offers. Arrays that a function fills come last; see the C files."""

from typing import TypeAlias, TypeVar

from multirep.splines.arrays import Array, IntArray

_Run = TypeVar("_Run", bound=tuple[Array, ...])
_Runs: TypeAlias = tuple[tuple[Array, ...], ...]

#: A checksum of this file as it was when the core was built.
INTERFACE: int

class Rope:
    """The rows of blocks, end to end."""

def rope(parts: tuple[Array, ...] | tuple[Rope, ...], /) -> Rope: ...
def find_spans(knots: Array, degree: int, t: Array, spans: IntArray, /) -> None: ...
def basis_functions(
    knots: Array, degree: int, t: Array, spans: IntArray, values: Array, /
) -> None: ...
def points(
    knots: Array | tuple[Array, ...] | Rope,
    points: Array | tuple[Array, ...] | Rope,
    weights: Array | tuple[Array, ...] | Rope | None,
    degree: int,
    t: Array | float,
    order: int,
    left: bool,
    settled: bool,
    found: Array,
    /,
) -> None: ...
def capsule(points: Array, ends: Array, part: float, found: Array, /) -> None: ...
def merged_capsules(nodes: Array, fan: int, part: float, found: Array, /) -> None: ...

class Leaf:
    """The pieces of a leaf and their capsules."""

def leaf(
    starts: Array, stops: Array, nodes: Array, groups: Array, hulls: Array | None, fan: int, /
) -> Leaf: ...
def nearest(
    levels: tuple[Array, ...],
    leaves: list[Leaf | None],
    fan: int,
    points: Array,
    slack: float,
    unit: float,
    found: Array,
    /,
) -> list[int]: ...
def blossom(
    knots: Array,
    coefficients: Array,
    degree: int,
    spans: IntArray,
    arguments: Array,
    points: Array,
    /,
) -> None: ...
def polyline_rows(
    knots: Array,
    degree: int,
    t: Array,
    points: Array,
    per_span: int,
    rows: Array,
    targets: Array,
    weights: Array,
    /,
) -> int: ...
def solve_window(
    knots: Array,
    degree: int,
    free: int,
    stop: int,
    t: Array,
    targets: Array,
    row_weights: Array,
    basis_weights: Array | None,
    coefficients: Array,
    /,
) -> bool: ...
def fit(
    knots: Array,
    degree: int,
    free: int,
    stop: int,
    basis_weights: Array | None,
    t: Array,
    points: Array,
    breakpoints: Array,
    times: IntArray,
    corner_weight: float,
    chord_t: Array,
    allowance: Array | None,
    tightest: float,
    emphasis: Array | None,
    per_span: int,
    coefficients: Array,
    rows: Array,
    ratios: Array,
    firsts: IntArray,
    worst: Array,
    /,
) -> int: ...
def chord_bounds(
    knots: Array,
    coefficients: Array,
    degree: int,
    rational: bool,
    starts: Array,
    stops: Array,
    low: Array,
    high: Array,
    splits: int,
    allowance: Array,
    bounds: Array,
    /,
) -> None: ...
def sample(
    knots: Array,
    coefficients: Array,
    degree: int,
    rational: bool,
    start: float,
    stop: float,
    tolerance: float,
    /,
) -> tuple[bytearray, bytearray, bytearray] | None: ...
def attempt(
    t: Array,
    points: Array,
    slopes: Array,
    limits: Array,
    before: Array,
    after: Array,
    left_knots: Array | None,
    left_points: Array | None,
    right_knots: Array | None,
    right_points: Array | None,
    x: Array,
    control_points: Array,
    nets: Array,
    ratios: Array,
    /,
) -> float | None: ...
def spare(
    t: Array,
    points: Array,
    slopes: Array,
    limits: Array,
    before: Array,
    after: Array,
    left_knots: Array | None,
    left_points: Array | None,
    right_knots: Array | None,
    right_points: Array | None,
    x: Array,
    nets: Array,
    ratios: Array,
    first: int,
    last: int,
    rounds: int,
    /,
) -> tuple[bytearray, bytearray, bytearray, bytearray, float] | None: ...
def follow(
    t: Array, points: Array, slopes: Array, at: Array, values: Array, chords: IntArray, /
) -> None: ...
def predict(
    t: Array,
    points: Array,
    slopes: Array,
    allowances: Array,
    corners: Array,
    starts: Array,
    stops: Array,
    shortest: float,
    start: float,
    stop: float,
    margin: float,
    projections: Array,
    places: Array,
    /,
) -> bytearray: ...
def beginning(
    t: Array,
    points: Array,
    slopes: Array,
    allowances: Array,
    corners: Array,
    widths: Array,
    first: Array,
    last: Array,
    left_knots: Array | None,
    left_points: Array | None,
    right_knots: Array | None,
    right_points: Array | None,
    fewest: int,
    start: float,
    stop: float,
    shortest: float,
    margin: float,
    projection: Array,
    places: Array,
    /,
) -> bytearray | None: ...
def common(a: Array, b: Array, /) -> tuple[int, int]: ...
def changed_spans(
    degree: int, knots: Array, other_knots: Array, rows: list[tuple[Array, Array]], /
) -> list[tuple[float, float]]: ...
def recount(added: Array, removed: Array, counts: IntArray, /) -> None: ...
def insert_knots(
    knots: Array,
    points: Array,
    weights: Array | None,
    degree: int,
    added: Array,
    new_knots: Array,
    new_points: Array,
    new_weights: Array | None,
    /,
) -> tuple[list[float], list[float]] | None: ...
def halves(starts: Array, stops: Array, middles: Array, /) -> None: ...
def interpolate(
    t: Array | Rope, points: Array | Rope, at: Array | float, found: Array, /
) -> None: ...
def stretch(
    t: Array,
    points: Array,
    first: int,
    last: int,
    start: float,
    stop: float,
    limit: float,
    unit: float,
    new_t: Array | None,
    rows: Array | None,
    /,
) -> tuple[float, list[float]]: ...
def join(
    pieces: tuple[tuple[Array, Array, Array | None, float], ...],
    t: Array,
    points: Array,
    bounds: Array,
    /,
) -> float: ...
def simplify(
    t: Array,
    values: Array,
    targets: Array,
    allowed: Array,
    keep: IntArray,
    unit: float,
    rounds: int,
    /,
) -> tuple[bytearray, float]: ...
def breakpoints(
    knots: Array,
    start: float,
    stop: float,
    start_times: int,
    stop_times: int,
    degree: int,
    t: Array,
    heights: Array,
    corner: float,
    kink: float,
    nearest: float,
    /,
) -> tuple[bytearray, bytearray]: ...
def course(
    t: Array, points: Array, allowance: Array, kink: float, heights: Array, /
) -> tuple[float, float, float, tuple[bytearray, bytearray] | None]: ...
def target(
    t: Array,
    points: Array,
    allowances: Array,
    sharpness: float,
    share: float,
    about: Array,
    slopes: Array,
    /,
) -> tuple[list[float], list[float]]: ...
def between_common(
    t: Array, points: Array, other_t: Array, other_points: Array, /
) -> list[tuple[float, float]]: ...
def largest(one: Array, other: Array, /) -> float: ...
def refine_uniform(points: Array, end_rows: Array, refined: Array, /) -> None: ...
def add_details(details: Array, columns: Array, share: float, points: Array, /) -> None: ...
def analyse(
    points: Array, factors: Array, repeated: int, coarse: Array, details: Array, /
) -> None: ...
def plus(
    u: Array,
    knots: Array,
    spans: float,
    first: int,
    level_knots: Array,
    rows: Array,
    points: Array,
    /,
) -> None: ...
def thin(
    t: Array,
    points: Array,
    limits: Array | None,
    limit: float,
    rounds: int,
    merges: int,
    going_on: float,
    /,
) -> tuple[bytearray, bytearray]: ...
def insert_knot(
    degree: int,
    t: float,
    start: float,
    stop: float,
    knots: Array,
    at: int,
    points: Array,
    last: int,
    weights: Array | None,
    heaviest: int,
    new_knots: Array,
    new_points: Array,
    new_weights: Array | None,
    /,
) -> tuple[float, float] | None: ...
def place(runs: _Runs, ends: tuple[int, ...], row: int, /) -> tuple[Array, int, int, int]: ...
def searched(runs: _Runs, ends: tuple[int, ...], value: float, right: bool, /) -> int: ...
def with_block(
    runs: tuple[_Run, ...], ends: tuple[int, ...], run: int, k: int, block: Array, /
) -> tuple[tuple[_Run, ...], tuple[int, ...]]: ...
def joined(block: Array, start: int, stop: int, rows: Array, made: Array, /) -> None: ...
def shared_rows(runs: _Runs, ends: tuple[int, ...], others: _Runs, from_end: bool, /) -> int: ...
