"""Benchmarks: named workloads, swept over size, beside what a program without this library does.

    python -m benchmarks.drag            # one drag step through each representation
    python -m benchmarks.repeated        # a thousand drag steps: nothing may creep up

Times are CPU times on whatever machine runs them; ratios are what counts, and the time that copying
16 MB takes is printed beside them. None of this is a test.
"""
