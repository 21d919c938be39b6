"""Scripts of editing sessions: read and checked here, run against the framework, reported as JSON.

Reading order: ``model`` (what a script says), ``strict`` (plain data to attrs classes, nothing
converted quietly), ``reading`` and ``step_reading`` (TOML to model), ``outlines`` and ``svg_paths``
(an SVG path as an exact NURBS), ``sources`` (the curve that a script starts from), ``history`` and
``running`` (doing it), ``drawn`` (pen strokes) and ``pictures``, ``report``, ``files``; ``writing``
(the journal of a session to TOML).
"""
