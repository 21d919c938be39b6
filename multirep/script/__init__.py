"""Scripts of editing sessions: read and checked here, run against the framework, reported as JSON.

Reading order: ``model`` (what a script says), ``strict`` (plain data to attrs classes, nothing
converted quietly), ``reading`` (TOML to model), ``outlines`` and ``svg_paths`` (an SVG path as an
exact NURBS), ``sources`` (the curve that a script starts from), ``running``, ``report``, ``files``.
"""
