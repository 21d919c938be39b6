"""Benchmarks: named workloads, swept over size, beside what programs without this library do.

    python -m benchmarks run [--full]          # everything: results.json, docs/performance.md, .svg
    python -m benchmarks show drag --size 1000 # some workloads, other sizes; prints, writes nothing
    python -m benchmarks table                 # the page and the picture again, without measuring
    python -m benchmarks check                 # a quick part again: have we lost more than a third?

A workload (`benchmarks.workloads`) is a value: cases, and for each case its contestants, ours and
peers. One runner measures all contestants of a case in turns in the same process. Times are CPU
times on whatever machine runs them; ratios are what counts, and the time that copying 16 MB takes
is noted beside them. None of this is a test.
"""

import os

# One thread, for us and the peers; numpy reads this when it is imported.
for _name in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ.setdefault(f"{_name}_NUM_THREADS", "1")
