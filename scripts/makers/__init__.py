"""What makes our robot and our scenes, and what tests and benchmarks both draw: hostile shapes, cells, sketches.

Not part of the package: nothing imports it at run time.
"""
