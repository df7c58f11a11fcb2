"""Moments at which a tool may not move farther, nor turn more, than it is given: rows of a path's offsets.

The rows bound its way in 26 directions from outside, and in the direction that it is off; what is measured after
each step decides. Not for: which link is the tool (`tool`).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadChange, BadDimension
from clearance.gains.shortfalls import Rows
from clearance.gains.turn import ARM
from clearance.world.tool import Tool, pose_errors

_SIDES = np.array([side for side in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(side)])
DIRECTIONS = _SIDES / np.linalg.norm(_SIDES, axis=1)[:, None]

LEAST = 1e-6
"""[m] or, as rad, twice that: what is to be kept closer is to be kept as it is."""


WEIGHT = 10.0
"""[-] Where not all can be kept, a tool a millimetre too far off counts as bodies ten millimetres too near."""


@dataclass(frozen=True)
class ToolKeep:
    """A moment at which a tool is to stay about where it is.

    Attributes:
        time: [s] of the run. far: [m] its origin may move. turn: [rad] it may turn.

    Raises:
        BadInput: a time that is not finite. BadDimension: room that is none.
    """

    time: float
    far: float
    turn: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise BadChange(f"a tool is kept at {self.time} s", valid="a time of the run")
        if not (self.far >= LEAST and self.turn >= LEAST):
            raise BadDimension(
                f"a tool may move {self.far * 1e3:g} mm and turn {math.degrees(self.turn):g} deg",
                valid="0.001 mm and 0.0001 deg or more; --keep for a path that stays as it is",
            )


@dataclass(frozen=True)
class ToolMove:
    """How far a tool is moved and turned at a moment [m] and [rad], and what is given."""

    link: str
    keep: ToolKeep
    far: float
    turn: float


@dataclass(frozen=True, eq=False)
class ToolPoses:
    """What is kept of a tool at k moments.

    Attributes:
        positions: (k, joints) of the table then, before it is changed. splines: (k, m) what each adds to a joint.
    """

    tool: Tool
    keeps: tuple[ToolKeep, ...]
    positions: np.ndarray
    splines: np.ndarray

    def moves(self, x: np.ndarray) -> list[ToolMove]:
        """How far the tool is moved by offsets of these splines."""
        off = pose_errors(self.tool.poses(self._at(x)), self.tool.poses(self.positions))
        sizes = np.linalg.norm(off.reshape(-1, 2, 3), axis=2)
        return [
            ToolMove(self.tool.name, keep, float(far), float(turn))
            for keep, (far, turn) in zip(self.keeps, sizes, strict=True)
        ]

    def rows(self, x: np.ndarray, beyond: float) -> Rows:
        """How much of what is given is missing [m], a radian as `ARM`, times `WEIGHT`, and what that grows by.

        Args:
            beyond: [m] that is to cover rounding.
        """
        poses, rates = self.tool.poses_and_rates(self._at(x))
        off = pose_errors(poses, self.tool.poses(self.positions))
        parts = [np.empty(0)], [np.empty((0, x.size))]
        for i, keep in enumerate(self.keeps):
            for part, most, arm in (
                (slice(0, 3), keep.far, WEIGHT),
                (slice(3, 6), keep.turn, WEIGHT * ARM),
            ):
                own = off[i, part]
                sides = _with_own(own)
                parts[0].append(arm * (sides @ own - most) + beyond)
                by_joint = -arm * sides @ rates[i, part]
                by_spline = by_joint[:, :, None] * self.splines[i]
                parts[1].append(by_spline.reshape(len(sides), -1))
        return Rows(np.concatenate(parts[0]), np.concatenate(parts[1]))

    def _at(self, x: np.ndarray) -> np.ndarray:
        offsets = self.splines @ x.reshape(self.positions.shape[1], -1).T
        return np.asarray(self.positions + offsets)


def _with_own(off: np.ndarray) -> np.ndarray:
    """The directions in which a way is bounded, and that of the way itself."""
    length = float(np.linalg.norm(off))
    return DIRECTIONS if length < 1e-9 else np.vstack([DIRECTIONS, off / length])
