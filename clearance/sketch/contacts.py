"""Points of contact: where a line or circle touches a circle in a point that lies on both.

Such a point is a double root of the equations as they are counted: an error of 1e-13 in the radius moves it by
4e-7 along the line. The same is said by an equation that is regular there: its radius is perpendicular to the
line, or the point lies on the line of the centres. Plans and counts use the equations of touching; questions and
repairs at a solution use the regular ones. Not for: contacts in no point of the sketch: those are
regular.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from clearance.sketch.equations import (
    CODES,
    KINDS,
    Across,
    CircleCircle,
    InLine,
    LineCircle,
    PointCircle,
    PointLine,
    are,
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
    touching = np.flatnonzero(are(code, LineCircle, CircleCircle) & sound)
    if not touching.size:
        return None
    on_line: dict[tuple[int, int], list[int]] = {}
    on_circle: dict[tuple[int, int], list[int]] = {}
    for row in _rows(code, var, np.flatnonzero(plain & are(code, PointLine))):
        on_line.setdefault((row.theta, row.d), []).append(row.px)
    for row in _rows(code, var, np.flatnonzero(plain & are(code, PointCircle))):
        on_circle.setdefault((row.cx, row.r), []).append(row.px)
    every = zip(touching.tolist(), _rows(code, var, touching), strict=True)
    found = [(row, _regular(equation, on_line, on_circle)) for row, equation in every]
    known = [(row, other) for row, other in found if other is not None]
    if not known:
        return None
    variables = np.full((len(known), 8), -1)
    for k, (_, other) in enumerate(known):
        variables[k, : len(other)] = other
    rows, codes = [row for row, _ in known], [CODES[type(other)] for _, other in known]
    return Contacts(np.array(rows), np.array(codes), variables)


def _rows(code: np.ndarray, var: np.ndarray, chosen: np.ndarray) -> Iterator[Any]:
    """Some equations, of the places of their numbers."""
    for kind, places in zip(code[chosen].tolist(), var[chosen].tolist(), strict=True):
        yield KINDS[kind](*places[: len(KINDS[kind]._fields)])


def _regular(
    e: LineCircle | CircleCircle, on_line: dict, on_circle: dict
) -> Across | InLine | None:
    """The equation that says the same as one of touching; None without a point of contact.

    `on_line` and `on_circle` are the points (first variables) on every line and circle.
    """
    if isinstance(e, LineCircle):
        first, second = on_line.get((e.theta, e.d), []), on_circle.get((e.cx, e.r), [])
    else:
        first, second = on_circle.get((e.ax, e.r), []), on_circle.get((e.bx, e.s), [])
    p = next((p for p in first if p in second), None)
    if p is None:
        return None
    if isinstance(e, LineCircle):
        return Across(p, p + 1, e.cx, e.cy, e.theta)
    return InLine(p, p + 1, e.ax, e.ay, e.bx, e.by)
