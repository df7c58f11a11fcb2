"""Ruler and compass: one vertex (or a line) placed in closed form from what already stands.

A point comes from the loci of its conditions (`sketch.solve.loci`), a line from the points that it passes at known
distances; the sketch's side stays. Where a condition is missing the sketch is moved least (the paper's
assumptions): the nearest point of a locus, a line's old direction.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from clearance.sketch.equations import Across, MiddleOn
from clearance.sketch.graph.graph import POINT, SIZE, TURN, PlanStep
from clearance.sketch.solve.loci import locus, meet, nearest_on, root_of
from clearance.sketch.solve.system import PlainSystem


def place(
    s: PlainSystem, step: PlanStep, x: list[float], sketch: list[float], turned: float
) -> bool:
    """Places what a closed step places, in place on x; False when there is no such place.

    `turned` -1 is the branch on the other side than the sketch's, 1 the sketch's.
    """
    kind = s.kind[step.vertex]
    if kind == POINT:
        return step.partner < 0 and _place_point(s, step, x, sketch, turned)
    if kind == TURN:
        return _Line(s, step, x, sketch).placed(turned)
    if not step.rows:
        s.assign(step.vertex, sketch[s.root[step.vertex]], x)
        return True
    return len(step.rows) == 1 and _place_number(s, step, x)


def _place_point(
    s: PlainSystem, step: PlanStep, x: list[float], sketch: list[float], turned: float
) -> bool:
    """Places a point on at most two loci."""
    i = s.root[step.vertex]
    p = sketch[i], sketch[i + 1]
    found: tuple[float, float] | None = p
    loci = [at for at in (locus(s, row, i, x) for row in step.rows) if at is not None]
    drawn = [at for at in (locus(s, row, i, sketch) for row in step.rows) if at is not None]
    if len(step.rows) > 2 or not len(loci) == len(drawn) == len(step.rows):
        return False
    if len(loci) == 1:
        found = nearest_on(loci[0], p)
    elif len(loci) == 2:
        found = meet(loci[0], loci[1], (drawn[0], drawn[1]), p, turned)
    if found is None:
        return False
    x[i], x[i + 1] = found
    return True


def _place_number(s: PlainSystem, step: PlanStep, x: list[float]) -> bool:
    """Places an offset or a radius, in which every equation is linear; a radius must not be
    negative."""
    v, row = step.vertex, step.rows[0]
    s.assign(v, 0.0, x)
    at_zero = s.residual(row, x)
    s.assign(v, 1.0, x)
    slope = s.residual(row, x) - at_zero
    if abs(slope) < 1e-12:
        return False
    s.assign(v, -at_zero / slope, x)
    return s.kind[v] != SIZE or all(x[i] >= 0.0 for i in s.members[v])


class _Passes(NamedTuple):
    """A line at the distance w from a point: n . p - d = w."""

    px: float
    py: float
    w: float


class _Faces(NamedTuple):
    """A line's normal is parallel to a vector."""

    ux: float
    uy: float


class _Line:
    """A line, or a direction alone, that a step places from at most two conditions."""

    def __init__(self, s: PlainSystem, step: PlanStep, x: list[float], sketch: list[float]) -> None:
        self.s, self.step, self.x, self.sketch = s, step, x, sketch
        self.own = s.root[step.partner] - 1 if step.partner >= 0 else s.root[step.vertex]
        theta = sketch[self.own]
        self.normal = -math.sin(theta), math.cos(theta)

    def placed(self, turned: float) -> bool:
        """Places it; False when there is no such line."""
        conditions = [self._condition(row, self.x) for row in self.step.rows]
        passes = [c for c in conditions if isinstance(c, _Passes)]
        faces = [c for c in conditions if isinstance(c, _Faces)]
        if len(conditions) > 2 or len(faces) > 1 or (passes and self.step.partner < 0):
            return False
        if len(passes) == 2:
            return self._set_tangent(passes[0], passes[1], turned)
        nx, ny = self.normal
        if faces:
            ux, uy = faces[0]
            length = math.hypot(ux, uy)
            if length == 0.0:
                return False
            length = -length if nx * ux + ny * uy < 0.0 else length
            nx, ny = ux / length, uy / length
        d = (
            nx * passes[0].px + ny * passes[0].py - passes[0].w
            if passes
            else self.sketch[self.own + 1]
        )
        return self._set(nx, ny, d)

    def _condition(self, row: int, x: list[float]) -> _Passes | _Faces:
        """The condition of an equation on the line."""
        s, e, w = self.s, self.s.equations[row], self.s.value[row]
        if isinstance(e, Across):
            ux, uy = x[e.qx] - x[e.px], x[e.qy] - x[e.py]
            turn = s.shift[e.theta] - s.shift[self.own]
            c, si = math.cos(turn), math.sin(turn)
            return _Faces(c * ux + si * uy, c * uy - si * ux)
        px, py = x[e[0]], x[e[1]]
        if isinstance(e, MiddleOn):
            px, py, w = 0.5 * (px + x[e.qx]), 0.5 * (py + x[e.qy]), 0.0
        else:
            w += s.coef[row][0] * x[e.r]
        same = 1.0 if math.cos(s.shift[e.theta] - s.shift[self.own]) > 0.0 else -1.0
        return _Passes(px, py, same * (w + s.shift[e.d]))

    def _set_tangent(self, first: _Passes, second: _Passes, turned: float) -> bool:
        """Places the line at its distances from two points, on the sketch's side of them."""
        dx, dy = first.px - second.px, first.py - second.py
        length = math.hypot(dx, dy)
        if length == 0.0:
            return False
        along = (first.w - second.w) / length
        h = root_of((1.0 - along) * (1.0 + along), 1.0)
        if h < 0.0:
            return False
        a, b = (self._condition(row, self.sketch) for row in self.step.rows)
        (nx, ny), ux, uy = self.normal, dx / length, dy / length
        h *= turned if (a[0] - b[0]) * ny - (a[1] - b[1]) * nx >= 0.0 else -turned
        nx, ny = along * ux - h * uy, along * uy + h * ux
        return self._set(nx, ny, nx * first.px + ny * first.py - first.w)

    def _set(self, nx: float, ny: float, d: float) -> bool:
        """Gives the line a normal and an offset; its direction stays near the sketch's."""
        theta = math.atan2(-nx, ny)
        theta += 2.0 * math.pi * round((self.sketch[self.own] - theta) / (2.0 * math.pi))
        self.s.assign(self.step.vertex, theta - self.s.shift[self.own], self.x)
        if self.step.partner >= 0:
            self.s.assign(self.step.partner, d, self.x)
        return True
