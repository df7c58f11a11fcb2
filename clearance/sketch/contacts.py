"""Points of contact: where a line or circle touches a circle in a point that lies on both.

Such a point is a double root of the equations as they are counted: an error of 1e-13 in the radius moves it by
4e-7 along the line. The same is said by an equation that is regular there: its radius is perpendicular to the
line, or the point lies on the line of the centres. Plans and counts keep the equations of touching; what is
asked or mended at a solution takes the regular ones. Not for: contacts in no point of the sketch: those are
regular.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.sketch.equations import (
    ACROSS,
    CIRCLE_CIRCLE,
    IN_LINE,
    LINE_CIRCLE,
    POINT_CIRCLE,
    POINT_LINE,
)
from clearance.sketch.solve.system import System


class Contacts(NamedTuple):
    """Equations of touching (k,) and the codes (k,) and variables (k, 8) of those that say the same."""

    rows: np.ndarray
    code: np.ndarray
    var: np.ndarray

    def regular(self, system: System) -> System:
        """The system with its equations of touching replaced."""
        code, var, value = system.code.copy(), system.var.copy(), system.value.copy()
        code[self.rows], var[self.rows], value[self.rows] = self.code, self.var, 0.0
        return system.replaced(code=code, var=var, value=value)


def contacts_of(
    code: np.ndarray, var: np.ndarray, plain: np.ndarray, sound: np.ndarray
) -> Contacts | None:
    """The points of contact among equations with codes (m,) and variables (m, 8); None for none.

    Args:
        plain: (m,) marks the incidences: equations that never have a value.
        sound: (m,) marks the equations of parts in which none follows from others: there, another would follow
        if one of touching were replaced.
    """
    touching = np.flatnonzero(((code == LINE_CIRCLE) | (code == CIRCLE_CIRCLE)) & sound)
    if not touching.size:
        return None
    on_line = _points_on(var, (code == POINT_LINE) & plain, (2, 3))
    on_circle = _points_on(var, (code == POINT_CIRCLE) & plain, (2, 4))
    found = [
        (int(row), *_regular(int(code[row]), var[row], on_line, on_circle)) for row in touching
    ]
    found = [entry for entry in found if entry[1]]
    if not found:
        return None
    rows, codes, variables = zip(*found, strict=True)
    return Contacts(np.array(rows), np.array(codes), np.array(variables).reshape(-1, 8))


def _points_on(var: np.ndarray, chosen: np.ndarray, slots: tuple[int, int]) -> dict:
    """The points (first variables) on every line or circle, by two of its variables."""
    out: dict[tuple[int, int], list[int]] = {}
    for row in var[chosen]:
        out.setdefault((int(row[slots[0]]), int(row[slots[1]])), []).append(int(row[0]))
    return out


def _regular(code: int, var: np.ndarray, on_line: dict, on_circle: dict) -> tuple[int, list[int]]:
    """(code, variables) of what says the same as an equation of touching; (0, []) without a point of contact."""
    c = [int(v) for v in var]
    if code == LINE_CIRCLE:
        first, second = on_line.get((c[2], c[3]), []), on_circle.get((c[0], c[4]), [])
    else:
        first, second = on_circle.get((c[0], c[4]), []), on_circle.get((c[2], c[5]), [])
    shared = [p for p in first if p in second]
    if not shared:
        return 0, []
    p = shared[0]
    if code == LINE_CIRCLE:
        return ACROSS, [p, p + 1, c[0], c[1], c[2], -1, -1, -1]
    return IN_LINE, [p, p + 1, c[0], c[1], c[2], c[3], -1, -1]
