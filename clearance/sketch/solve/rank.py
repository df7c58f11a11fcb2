"""Closed steps whose equations do not determine their place: two loci that are one, or run side by side.

The count of freedoms does not see them (a distance from a circle and one from its centre, say); the
derivative at the solution does. Not for: whole parts (`clearance.sketch.freedom`).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clearance.sketch.graph.graph import POINT, TURN
from clearance.sketch.graph.steps import PlanStep
from clearance.sketch.solve.system import System

ALIKE = 1e-12
"""Determinant of the unit derivatives' products at which they count as one: sine squared, 1e-6 each. What only
touches is marked as well."""


def singular_steps(
    s: System, steps: Iterable[PlanStep], x: np.ndarray, size: float
) -> list[PlanStep]:
    """The closed steps with two or three equations that are not independent at x."""
    closed = [step for step in steps if not step.numeric and len(step.rows) > 1]
    if not closed:
        return []
    rows = np.array([(step.rows + (-1,))[:3] for step in closed])
    vertex = np.array([step.vertex for step in closed])
    partner = np.array([step.partner for step in closed])
    used = rows >= 0
    slopes = s.all_rows.slopes(x)[rows]
    var = np.where(used[..., None], s.var[rows], -1)
    owner = np.where(var >= 0, s.vertex_of[var], -1)
    own, with_it = owner == vertex[:, None, None], owner == partner[:, None, None]
    with_it &= owner >= 0
    point = (s.kind[vertex] == POINT)[:, None, None]
    second = own & point & (var != s.root[vertex][:, None, None])
    factor = np.where(point & own, 1.0, s.scale[var])
    factor = np.where((s.kind[vertex] == TURN)[:, None, None] & own, factor / size, factor)
    slopes = slopes * factor
    unit = np.stack(
        [np.sum(slopes * mine, axis=2) for mine in (own & ~second, second, with_it)], axis=2
    )
    length = np.linalg.norm(unit, axis=2, keepdims=True)
    unit = unit / np.where(length > 0.0, length, 1.0)
    gram = unit @ unit.transpose(0, 2, 1)
    gram[:, 2, 2] += ~used[:, 2]
    singular = np.linalg.det(gram) <= ALIKE
    return [step for step, bad in zip(closed, singular.tolist(), strict=True) if bad]
