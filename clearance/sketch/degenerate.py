"""Outcomes without extent, refused by name: a circle of radius 0, a line whose two points coincide."""

from __future__ import annotations

import numpy as np

from clearance.sketch.faults import DegenerateSketch
from clearance.sketch.graph.graph import RADIUS
from clearance.sketch.problem import RESIDUAL, Problem


def check_degenerate(sketch, problem: Problem, x: np.ndarray) -> None:
    """Passes a solution (n,) in which every line and circle has extent.

    Raises:
        DegenerateSketch: one has none; the message names it.
    """
    least = RESIDUAL * problem.size
    tables = problem.tables
    small = np.flatnonzero((tables.role == RADIUS) & ~(x > least))
    if small.size:
        name = _name_at(sketch, int(small[0]))
        raise DegenerateSketch(f"{name} would have the radius 0", valid="a radius above 0")
    line, a, b = tables.line_ends.T
    short = line[(a >= 0) & (np.hypot(x[a] - x[b], x[a + 1] - x[b + 1]) <= least)]
    if short.size:
        raise DegenerateSketch(
            f"the two points of {_name_at(sketch, int(short[0]))} would coincide",
            valid="a line of some length",
        )


def _name_at(sketch, variable: int) -> str:
    """The line, circle or arc whose numbers start at a variable."""
    return next(
        e.name for e in sketch.entities.values() if e.variable == variable and e.what != "point"
    )
