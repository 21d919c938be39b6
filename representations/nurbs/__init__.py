"""NURBS: splines of any degree, rational or not, on any knots.

Read in this order: `curve` (the value), `evaluation`, `changes` (which parameters an edit touches),
the primitive operations `controls`, `insertion`, `moving`, `removal`, `elevation`, `ends`, then
how a curve follows a polyline: `problem`, `joining`, `refinement`, `thinning`, `splicing`, `fitting`.
"""

from multirep.representations.nurbs.curve import Nurbs

__all__ = ["Nurbs"]
