"""Points of contact: where a line or circle touches a circle in a point that lies on both.

Such a point is a double root of the equations as they are counted: an error of 1e-13 in the radius moves it by
4e-7 along the line. The same is said by an equation that is regular there: its radius is perpendicular to the
line, or the point lies on the line of the centres. Plans and counts use the equations of touching; questions and
repairs at a solution use the regular ones. Not for: contacts in no point of the sketch: those are
regular.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.sketch.equations import CODES, Across, FromCircle, FromLine, InLine, are
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


def contacts_of(system: System, plain: np.ndarray, sound: np.ndarray) -> Contacts | None:
    """The points of contact among equations; None for none.

    Args:
        plain: (m,) marks the incidences: equations that never have a value.
        sound: (m,) marks the equations of parts in which none follows from others: there, another would follow
        if one of touching were replaced.
    """
    equations = system.plain.equations
    both = np.flatnonzero(are(system.code, FromLine, FromCircle)).tolist()
    touching = [row for row in both if equations[row][-1] >= 0 and sound[row]]
    if not touching:
        return None
    on: dict[tuple[int, int], list[int]] = {}
    for row in both:
        if equations[row][-1] < 0 and plain[row]:
            on.setdefault(_carrier(equations[row]), []).append(equations[row].px)
    found = [(row, _regular(equations[row], on)) for row in touching]
    known = [(row, other) for row, other in found if other is not None]
    if not known:
        return None
    variables = np.full((len(known), 8), -1)
    for k, (_, other) in enumerate(known):
        variables[k, : len(other)] = other
    rows, codes = [row for row, _ in known], [CODES[type(other)] for _, other in known]
    return Contacts(np.array(rows), np.array(codes), variables)


def _carrier(e: FromLine | FromCircle) -> tuple[int, int]:
    """What a point lies on: the numbers of a line, or a circle's centre and radius."""
    return (e.theta, e.d) if isinstance(e, FromLine) else (e.cx, e.r)


def _regular(e: FromLine | FromCircle, on: dict) -> Across | InLine | None:
    """The equation that says the same as one of touching; None without a point of contact.

    `on` are the points (first variables) on every line and circle.
    """
    others = on.get((e.px, e[-1]), [])  # those on the circle about p
    p = next((p for p in on.get(_carrier(e), []) if p in others), None)
    if p is None:
        return None
    if isinstance(e, FromLine):
        return Across(p, p + 1, e.px, e.py, e.theta)
    return InLine(p, p + 1, e.cx, e.cy, e.px, e.py)
