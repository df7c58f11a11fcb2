"""An arm's program: moves, straight lines, waits and grips one after another, sampled at equal times.

Tool poses are in the world; the arm stands anywhere in it. Not for: what the moves are (`handover`, `turntable`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from scripts.makers.paths import Arm, ToolPose, smooth

LINE_PARTS = 6
"""Waypoints of a straight line: between them the tool is off it by less than 0.1 mm."""


class Program:
    """Joint positions over time, each step at rest at its beginning and its end.

    Args:
        arm: what moves. base: (4, 4) `world_from_base` [m].
        home: (k,) where it begins. grip: [m] how far each finger is from the middle.
        step: [s] between samples.
    """

    def __init__(
        self, arm: Arm, base: np.ndarray, home: Sequence[float], grip: float, step: float
    ) -> None:
        self._arm, self._base, self._step = arm, base, step
        self._rows = [np.array([*home, grip])]

    @property
    def positions(self) -> np.ndarray:
        """(n, k + 1) the arm's joints and the grip."""
        return np.array(self._rows)

    @property
    def now(self) -> float:
        """[s] when what is planned so far ends."""
        return round((len(self._rows) - 1) * self._step, 6)

    def move(self, until: float, *targets: ToolPose | Sequence[float]) -> None:
        """Through tool poses or joint positions."""
        self._through(self._solved(targets), until)

    def line(self, until: float, target: ToolPose) -> None:
        """Straight to a tool pose, turning about one axis."""
        here = self._base @ self._arm.tip_pose(self._rows[-1][:-1])
        turns = Rotation.concatenate(
            [Rotation.from_matrix(here[:3, :3]), Rotation.from_euler("xyz", target.rpy)]
        )
        shares = np.linspace(0.0, 1.0, LINE_PARTS + 1)[1:]
        rpys = Slerp([0.0, 1.0], turns)(shares).as_euler("xyz")
        places = here[:3, 3] + shares[:, None] * (np.array(target.xyz) - here[:3, 3])
        self._through(
            self._solved([ToolPose(tuple(p), tuple(r)) for p, r in zip(places, rpys, strict=True)]),
            until,
        )

    def wait(self, until: float) -> None:
        """Nothing moves."""
        self._rows += [self._rows[-1]] * self._n_samples(until)

    def grip(self, until: float, grip: float) -> None:
        """The fingers alone."""
        end = np.array([*self._rows[-1][:-1], grip])
        self._add(smooth(np.array([self._rows[-1], end]), self._n_samples(until) + 1))

    def follow(self, times: Sequence[float], targets: Sequence[ToolPose]) -> None:
        """Through tool poses at given times, the first now; a cubic spline in time, at rest at both ends."""
        knots = np.vstack([self._rows[-1][:-1], self._solved(targets)])
        samples = self.now + self._step * np.arange(1, self._n_samples(times[-1]) + 1)
        rows = CubicSpline([self.now, *times], knots, bc_type="clamped")(samples)
        grip = np.full((len(rows), 1), self._rows[-1][-1])
        self._rows += list(np.hstack([rows, grip]))

    def _solved(self, targets: Sequence[ToolPose | Sequence[float]]) -> np.ndarray:
        """(n, k) of the arm, one after another from where it is."""
        found, last = [], self._rows[-1][:-1]
        for target in targets:
            last = (
                self._arm.positions(self._in_base(target), last)
                if isinstance(target, ToolPose)
                else np.asarray(target, dtype=float)
            )
            found.append(last)
        return np.array(found)

    def _in_base(self, target: ToolPose) -> ToolPose:
        turn = Rotation.from_matrix(self._base[:3, :3]).inv()
        place = turn.apply(np.array(target.xyz) - self._base[:3, 3])
        rpy = (turn * Rotation.from_euler("xyz", target.rpy)).as_euler("xyz")
        return ToolPose(tuple(place), tuple(rpy))

    def _through(self, waypoints: np.ndarray, until: float) -> None:
        grip = np.full((len(waypoints), 1), self._rows[-1][-1])
        knots = np.vstack([self._rows[-1], np.hstack([waypoints, grip])])
        self._add(smooth(knots, self._n_samples(until) + 1))

    def _add(self, rows: np.ndarray) -> None:
        self._rows += list(rows[1:])

    def _n_samples(self, until: float) -> int:
        return round((until - self.now) / self._step)


def placed(x: float, y: float, z: float, yaw: float = 0.0) -> np.ndarray:
    """(4, 4) a pose in the world [m, rad]."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("z", yaw).as_matrix()
    pose[:3, 3] = x, y, z
    return pose


def ease(shares: np.ndarray) -> np.ndarray:
    """How far a motion from rest to rest is after a share of its time (Flash and Hogan 1985)."""
    s = np.clip(shares, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
