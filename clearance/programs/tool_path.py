"""Where a tool is to be: straight lines, arcs and corners between them, in the frame of one link.

Every stretch is a sum of two strokes, s1 and s2 in [0, 1]:

    p = p0 + f1(s1) + f2(s2),   f(s) = d s (line)  or  r (cos(phi s) - 1) e1 + r sin(phi s) e2 (arc),
    R = exp(s2 w2) exp(s1 w1) R0.

On a line and an arc s2 is 0. In a corner zone s1 = 2 u - u^2 and s2 = u^2 with u from 0 to 1, so that the path
touches both its neighbours where it begins and ends (between two lines it is Bezier's parabola), and turns as on
them. Not for: how fast (`time_law`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from clearance.errors import BadProgram
from clearance.geometry.quaternions import half_skew, rotation_vector
from clearance.programs.series import (
    ORDER,
    majorant_of_turns,
    matrix_product,
    moved,
    sine_and_cosine,
    turns_about,
)


@dataclass(frozen=True, eq=False)
class Straight:
    """A straight way (3,) of a stroke [m]."""

    way: np.ndarray

    @property
    def length(self) -> float:
        """[m]."""
        return float(np.linalg.norm(self.way))

    @property
    def bend(self) -> float:
        """[m] How fast its slope changes: not at all."""
        return 0.0

    def part(self, start: float, end: float) -> Straight:
        """From one share to another."""
        return Straight((end - start) * self.way)

    def share_within(self, distance: float) -> float:
        """The share from an end to where it is so far from that end [m]."""
        return distance / self.length

    def slopes(self, strokes: np.ndarray) -> np.ndarray:
        """(n, 3) [m] how the point moves with the stroke at strokes (n,)."""
        return np.tile(self.way, (len(strokes), 1))

    def series(self, stroke: np.ndarray) -> np.ndarray:
        """(ORDER + 1, n, 3) [m] the point from where it begins, at a series (ORDER + 1, n)."""
        return stroke[:, :, None] * self.way

    def majorant(self, by_stroke: np.ndarray) -> np.ndarray:
        """(ORDER + 2, n) [m] of the point, by that of the stroke."""
        return by_stroke * self.length


@dataclass(frozen=True, eq=False)
class Arc:
    """A circle's arc, with the properties of `Straight`.

    Attributes:
        first, second: (3,) from the centre to the start, and at right angles to it [m].
        angle: [rad] from start to end.
    """

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

    @property
    def length(self) -> float:
        """[m]."""
        return self.angle * self.radius

    @property
    def bend(self) -> float:
        """[m] How fast its slope changes."""
        return self.angle**2 * self.radius

    def part(self, start: float, end: float) -> Arc:
        """From one share to another."""
        sine, cosine = np.sin(self.angle * start), np.cos(self.angle * start)
        return Arc(
            cosine * self.first + sine * self.second,
            cosine * self.second - sine * self.first,
            (end - start) * self.angle,
        )

    def share_within(self, distance: float) -> float:
        """The share from an end to where it is so far from that end, straight [m]."""
        return float(2.0 * np.arcsin(min(1.0, 0.5 * distance / self.radius)) / self.angle)

    def slopes(self, strokes: np.ndarray) -> np.ndarray:
        """(n, 3) [m] how the point moves with the stroke at strokes (n,)."""
        angles = self.angle * strokes[:, None]
        return np.asarray(self.angle * (np.cos(angles) * self.second - np.sin(angles) * self.first))

    def series(self, stroke: np.ndarray) -> np.ndarray:
        """(ORDER + 1, n, 3) [m] the point from where it begins, at a series (ORDER + 1, n)."""
        sine, cosine = sine_and_cosine(self.angle * stroke)
        cosine[0] -= 1.0
        return cosine[:, :, None] * self.first + sine[:, :, None] * self.second

    def majorant(self, by_stroke: np.ndarray) -> np.ndarray:
        """(ORDER + 2, n) [m] of the point, by that of the stroke."""
        return self.radius * majorant_of_turns(self.angle * by_stroke)


STILL = Straight(np.zeros(3))
NO_TURN = np.zeros(3)


class JointsOnPath(NamedTuple):
    """Which joints follow a path, and how far the others go on it.

    Attributes:
        free: (k,) which follow it. held: (2, k) how far the others go with each stroke [rad or m].
        least_time: [s] in which they go so far, as fast as they may.
    """

    free: np.ndarray
    held: np.ndarray
    least_time: float = 0.0

    def part(self, share: float) -> JointsOnPath:
        """Of a share of the path."""
        return self._replace(held=share * self.held, least_time=share * self.least_time)


@dataclass(frozen=True, eq=False)
class Stretch:
    """A part of a tool's path.

    Attributes:
        start: (4, 4) the tool's pose at its beginning [m].
        ways: how each stroke moves the tool's point. turns: (2, 3) rotation vectors of both [rad].
        is_corner: the strokes are those of a corner zone.
        joints_on_path: None where nobody has asked.
    """

    start: np.ndarray
    ways: tuple[Straight | Arc, Straight | Arc]
    turns: np.ndarray
    is_corner: bool = False
    joints_on_path: JointsOnPath | None = None

    @property
    def least_time(self) -> float:
        """[s] That joints take which go to a given place."""
        return 0.0 if self.joints_on_path is None else self.joints_on_path.least_time

    @property
    def length(self) -> float:
        """[m] Of the first stroke's way."""
        return self.ways[0].length

    @property
    def farthest(self) -> float:
        """[m] No point of it is farther from the origin."""
        return float(np.linalg.norm(self.start[:3, 3])) + sum(way.length for way in self.ways)

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
        first, second = self.ways
        origin = first.series(strokes[:, :, 0]) + second.series(strokes[:, :, 1])
        origin[0] += self.start[:3, 3]
        return turn, origin

    def majorants(self, strokes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(ORDER + 2, n) majorants of the rotation and of the origin [m], at series of strokes."""
        by_stroke = moved(strokes)
        turn = majorant_of_turns(by_stroke @ np.linalg.norm(self.turns, axis=1))
        first, second = self.ways
        return turn, first.majorant(by_stroke[:, :, 0]) + second.majorant(by_stroke[:, :, 1])

    def part(self, start: float, end: float) -> Stretch:
        """From one share to another of a line or an arc; the whole of it as it is."""
        if (start, end) == (0.0, 1.0):
            return self
        first = self.poses(np.array([[start, 0.0]]))[0]
        way, share = self.ways[0].part(start, end), end - start
        turns, on_path = share * self.turns, self.joints_on_path and self.joints_on_path.part(share)
        return replace(self, start=first, ways=(way, STILL), turns=turns, joints_on_path=on_path)


def corner(before: Stretch, after: Stretch) -> Stretch:
    """The nominal path of a corner zone that takes the place of the parts of two lines or arcs."""
    ways, turns = (before.ways[0], after.ways[0]), np.array([before.turns[0], after.turns[0]])
    on_path = before.joints_on_path
    if on_path is not None and after.joints_on_path is not None:
        on_path = JointsOnPath(
            on_path.free, np.array([on_path.held[0], after.joints_on_path.held[0]])
        )
    return Stretch(before.start, ways, turns, is_corner=True, joints_on_path=on_path)


def line(start: np.ndarray, end: np.ndarray) -> Stretch:
    """The straight line from a pose to another (4, 4), its orientation about one axis at a constant rate."""
    turn = _turn_of(end[:3, :3] @ start[:3, :3].T)
    way = Straight(end[:3, 3] - start[:3, 3])
    return Stretch(start, (way, STILL), np.array([turn, NO_TURN]))


def arc(start: np.ndarray, via: np.ndarray, end: np.ndarray, along: bool) -> Stretch:
    """The arc from a pose (4, 4) through a point (3,) to the point of another pose.

    Args:
        along: the orientation stays the same to the path; else it goes from that of the start to that of the end.

    Raises:
        BadInput: the points lie on a line or coincide, or the circle is wider than 100 m.
    """
    found = _circle(start[:3, 3], via, end[:3, 3])
    turn = found.normal * found.angle if along else _turn_of(end[:3, :3] @ start[:3, :3].T)
    return Stretch(start, (found, STILL), np.array([turn, NO_TURN]))


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
    return Arc(first, second, angle)


def _turn_of(rotation: np.ndarray) -> np.ndarray:
    """(3,) axis times angle [rad] of a rotation (3, 3).

    Raises:
        BadInput: half a turn, which may go either way.
    """
    found = rotation_vector(rotation)
    if float(np.linalg.norm(found)) > np.pi - 2e-6:
        raise BadProgram(
            "the tool turns by half a turn", valid="turn it by less, or write a move between"
        )
    return found


def _turned_by(vector: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, 3, 3) the series of exp(stroke vector) (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        found = np.zeros((*stroke.shape, 3, 3))
        found[0] = np.eye(3)
        return found
    return turns_about(vector / angle, angle * stroke)
