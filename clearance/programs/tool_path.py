"""Where a tool is to be: straight lines, arcs and the parabolas of corner zones, in the frame of the robot's root.

Every stretch is a sum of two strokes, s1 and s2 in [0, 1]:

    p = p0 + d1 s1 + d2 s2 (line, parabola)  or  c + r (cos(phi s1) e1 + sin(phi s1) e2) (arc),
    R = exp(s2 w2) exp(s1 w1) R0.

On a line and an arc s2 is 0. In a corner zone s1 = 2 u - u^2 and s2 = u^2 with u from 0 to 1, so that the
position is the parabola that touches both lines (Bezier), and the turn begins and ends as on them. Not for: how
fast (`time_law`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.errors import BadProgram
from clearance.geometry.quaternions import quaternions_of
from clearance.programs.series import (
    ORDER,
    half_skew,
    majorant_of_turns,
    matrix_product,
    moved,
    sine_and_cosine,
)

NO_TURN = np.zeros(3)


@dataclass(frozen=True, eq=False)
class Arc:
    """A circle's arc.

    Attributes:
        centre: (3,) [m]. first, second: (3,) from the centre to the start, and at right angles to it [m].
        angle: [rad] from start to end.
    """

    centre: np.ndarray
    first: np.ndarray
    second: np.ndarray
    angle: float

    @property
    def radius(self) -> float:
        """[m]."""
        return float(np.linalg.norm(self.first))

    @property
    def normal(self) -> np.ndarray:
        """(3,) unit vector about which it turns."""
        cross = np.cross(self.first, self.second)
        return np.asarray(cross / np.linalg.norm(cross))


@dataclass(frozen=True, eq=False)
class Stretch:
    """A part of a tool's path.

    Attributes:
        start: (4, 4) `root_from_tool` at its beginning [m].
        ways: (2, 3) how far each stroke moves the tool's point [m]. turns: (2, 3) rotation vectors of both [rad].
        arc: instead of the first way. is_corner: the strokes are those of a corner zone.
    """

    start: np.ndarray
    ways: np.ndarray
    turns: np.ndarray
    arc: Arc | None = None
    is_corner: bool = False

    @property
    def length(self) -> float:
        """[m] Of the first stroke's way."""
        if self.arc is not None:
            return abs(self.arc.angle) * self.arc.radius
        return float(np.linalg.norm(self.ways[0]))

    @property
    def turned(self) -> float:
        """[rad] By the first stroke."""
        return float(np.linalg.norm(self.turns[0]))

    def strokes(self, share: np.ndarray, rate: np.ndarray, change: np.ndarray) -> np.ndarray:
        """(3, n, 2) both strokes, their first [1/s] and their second derivatives [1/s^2].

        Args:
            share, rate, change: (n,) of the way through the stretch; in a corner the change is 0.
        """
        if not self.is_corner:
            return np.stack(
                [np.stack([one, np.zeros_like(one)], axis=1) for one in (share, rate, change)]
            )
        second = np.stack([share**2, 2.0 * share * rate, 2.0 * rate**2])
        first = np.stack([2.0 * share, 2.0 * rate, np.zeros_like(rate)]) - second
        return np.stack([first, second], axis=2)

    def poses(self, strokes: np.ndarray, turn_strokes: np.ndarray | None = None) -> np.ndarray:
        """(n, 4, 4) [m] at strokes (n, 2), of the rotation too if it has no others."""
        still = np.zeros((ORDER, *strokes.shape))
        both = [
            None if one is None else np.concatenate([one[None], still])
            for one in (strokes, turn_strokes)
        ]
        assert both[0] is not None
        turn, origin = self.series(both[0], both[1])
        found = np.tile(np.eye(4), (len(strokes), 1, 1))
        found[:, :3, :3], found[:, :3, 3] = turn[0], origin[0]
        return found

    def rates(self, strokes: np.ndarray, by_time: np.ndarray) -> np.ndarray:
        """(n, 6) [m/s] and [rad/s] how the tool moves and turns at strokes (n, 2) that change by (n, 2) [1/s]."""
        series = np.zeros((ORDER + 1, *strokes.shape))
        series[0], series[1] = strokes, by_time
        turn, origin = self.series(series)
        spin = turn[1] @ np.swapaxes(turn[0], 1, 2)
        return np.hstack([origin[1], half_skew(spin)])

    def series(
        self, strokes: np.ndarray, turn_strokes: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The series of rotation (ORDER + 1, n, 3, 3) and origin (ORDER + 1, n, 3), at series of strokes (…, n,
        2).

        Args:
            turn_strokes: those of the rotation, where they are others than those of the point.
        """
        turns = strokes if turn_strokes is None else turn_strokes
        turn = _turned_by(self.turns[0], turns[:, :, 0]) @ self.start[:3, :3]
        if self.turns[1].any():
            turn = matrix_product(_turned_by(self.turns[1], turns[:, :, 1]), turn)
        origin = strokes[:, :, 1, None] * self.ways[1]
        if self.arc is None:
            origin = origin + strokes[:, :, 0, None] * self.ways[0]
            origin[0] += self.start[:3, 3]
        else:
            sine, cosine = sine_and_cosine(self.arc.angle * strokes[:, :, 0])
            origin = (
                origin + cosine[:, :, None] * self.arc.first + sine[:, :, None] * self.arc.second
            )
            origin[0] += self.arc.centre
        return turn, origin

    def majorants(self, strokes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(ORDER + 2, n) majorants of the rotation and of the origin [m], at series of strokes."""
        by_stroke = moved(strokes)
        sizes = np.linalg.norm(self.turns, axis=1)
        turn = majorant_of_turns(by_stroke @ sizes)
        if self.arc is None:
            return turn, by_stroke @ np.linalg.norm(self.ways, axis=1)
        round_it = majorant_of_turns(abs(self.arc.angle) * by_stroke[:, :, 0])
        return turn, self.arc.radius * round_it


def line(start: np.ndarray, end: np.ndarray) -> Stretch:
    """The straight line from a pose to another (4, 4), its orientation about one axis at a constant rate."""
    turn = rotation_vector(end[:3, :3] @ start[:3, :3].T)
    ways = np.array([end[:3, 3] - start[:3, 3], NO_TURN])
    return Stretch(start, ways, np.array([turn, NO_TURN]))


def arc(start: np.ndarray, via: np.ndarray, end: np.ndarray, along: bool) -> Stretch:
    """The arc from a pose (4, 4) through a point (3,) to the point of another pose.

    Args:
        along: the orientation stays the same to the path; else it goes from that of the start to that of the end.

    Raises:
        BadInput: the points lie on a line or coincide, or the circle is wider than 100 m.
    """
    found = _circle(start[:3, 3], via, end[:3, 3])
    turn = found.normal * found.angle if along else rotation_vector(end[:3, :3] @ start[:3, :3].T)
    return Stretch(start, np.zeros((2, 3)), np.array([turn, NO_TURN]), found)


WIDEST = 100.0
"""[m] A circle of a greater radius is a line, or a mistake."""


def _circle(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> Arc:
    """The arc from a by b to c, points (3,) [m]."""
    to_b, to_c = b - a, c - a
    cross = np.cross(to_b, to_c)
    size = float(cross @ cross)
    shortest = min(float(np.linalg.norm(one)) for one in (to_b, to_c, c - b))
    if shortest < 1e-6:
        raise BadProgram("two of the arc's three points coincide", valid="start, via and end apart")
    if size <= (1e-6 * float(np.linalg.norm(to_b)) * float(np.linalg.norm(to_c))) ** 2:
        raise BadProgram(
            "the arc's three points lie on one line", valid="a via point off that line, or lin"
        )
    centre = a + (to_b @ to_b * np.cross(to_c, cross) - to_c @ to_c * np.cross(to_b, cross)) / (
        2.0 * size
    )
    first = a - centre
    radius = float(np.linalg.norm(first))
    if radius > WIDEST:
        raise BadProgram(
            f"the arc's radius is {radius:.4g} m", valid=f"{WIDEST:g} m or less, or lin"
        )
    second = np.cross(cross / np.sqrt(size), first)
    angle = float(np.arctan2((c - centre) @ second, (c - centre) @ first)) % (2.0 * np.pi)
    return Arc(centre, first, second, angle)


def rotation_vector(rotation: np.ndarray) -> np.ndarray:
    """(3,) axis times angle [rad] of a rotation (3, 3).

    Raises:
        BadInput: half a turn, which may go either way.
    """
    x, y, z, w = quaternions_of(rotation[None])[0]
    size = float(np.linalg.norm([x, y, z]))
    if w < 1e-6:
        raise BadProgram("the tool turns by half a turn", valid="less, or a move between")
    angle = 2.0 * np.arctan2(size, w)
    return np.array([x, y, z]) * (2.0 if size < 1e-12 else angle / size)


def _turned_by(vector: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, 3, 3) the series of exp(stroke vector) (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    found = np.zeros((*stroke.shape, 3, 3))
    found[0] = np.eye(3)
    if angle == 0.0:
        return found
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = sine_and_cosine(angle * stroke)
    found += sine[:, :, None, None] * cross - cosine[:, :, None, None] * (cross @ cross)
    found[0] += cross @ cross
    return found
