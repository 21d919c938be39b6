"""NURBS: splines of any degree, rational or not, on any knots.

Read in this order: `curve` (all that can be done with it), `value` (what it stores), `evaluation`,
`changes` (which parameters an edit touches); the primitive operations `controls`, `insertion` with
`boehm`, `moving`, `removal`, `elevation`, `ends`; then how a curve follows a polyline: `problem`,
`refinement`, `equalizing`, `search`, and with these `joining` and `splicing`, `simplification` and
`fitting`.
"""

from multirep.representations.nurbs.curve import Nurbs

__all__ = ["Nurbs"]
