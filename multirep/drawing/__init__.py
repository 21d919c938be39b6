"""Pictures of curves: every representation with its controls, and the proved deviation.

Reading order: ``picture`` (what a picture is made of), ``svg`` and ``png`` (two ways to write it),
``palette``, ``frame`` (data to page), ``outline`` and ``controls`` (a curve, and what holds it),
``cards``, ``legend``, ``page``.
"""
