"""Mathematics of B-splines on plain numpy arrays.

Knows no representation and nothing of the kernel. A spline here is three things: its knots
``(n + p + 1,)``, its coefficients ``(n, D)`` (control points, or homogeneous ones with the weight
in the last column) and its degree p. Read in this order: `find_spans` and `basis_functions`,
`evaluate`, `blossom` with `refine` and `bernstein`, `sample_spline` with `corner_parameters`,
`polyline_rows` with `solve_window`, `simplified`; bounds are public in `multirep.bounds`.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multirep.splines.basis import basis_functions, find_spans
    from multirep.splines.corners import corner_parameters
    from multirep.splines.evaluation import evaluate
    from multirep.splines.least_squares import polyline_rows, solve_window
    from multirep.splines.minimum_norm import Factored, LeastNorm, factored, least_norm
    from multirep.splines.polar import bernstein, blossom, refine
    from multirep.splines.sampling import sample_spline
    from multirep.splines.simplification import simplified

__all__ = [
    "Factored",
    "LeastNorm",
    "basis_functions",
    "bernstein",
    "blossom",
    "corner_parameters",
    "evaluate",
    "factored",
    "find_spans",
    "least_norm",
    "polyline_rows",
    "refine",
    "sample_spline",
    "simplified",
    "solve_window",
]

_HOMES = {
    "Factored": "minimum_norm",
    "LeastNorm": "minimum_norm",
    "basis_functions": "basis",
    "bernstein": "polar",
    "blossom": "polar",
    "corner_parameters": "corners",
    "evaluate": "evaluation",
    "factored": "minimum_norm",
    "find_spans": "basis",
    "least_norm": "minimum_norm",
    "polyline_rows": "least_squares",
    "refine": "polar",
    "sample_spline": "sampling",
    "simplified": "simplification",
    "solve_window": "least_squares",
}


def __getattr__(name: str) -> object:
    """Import the module that holds a public name when the name is first used (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
