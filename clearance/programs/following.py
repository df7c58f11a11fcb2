"""The joints along a stretch of a tool's path, from where they are at its beginning: found step by step, and
refused where they cannot follow. Not for: what lies between samples (`enclosure`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadProgram
from clearance.programs.arm import Arm
from clearance.programs.inverse import joints_at, least_motion
from clearance.programs.joint_way import fastest
from clearance.programs.tool_path import JointsOnPath, Stretch
from clearance.world.cubic import cubics_of, position_on

SHORTEST = 2.0**-14
"""The least part of a stretch that a step may be: less is a singularity, or the end of what can be reached."""

LONGEST = 0.25
"""[rad] or [m]: the most that a joint may go in one step."""

FORESEEN = 0.05
"""[rad] or [m]: how far joints may be from where their rates say that they go."""

REACHED = 1e-9
"""[m] and [rad]: a pose that is missed by more is not reached."""


@dataclass(frozen=True, eq=False)
class Follower:
    """An arm whose tool follows a stretch.

    Attributes:
        start: (k,) where its joints are at the beginning [rad or m].
    """

    arm: Arm
    stretch: Stretch
    start: np.ndarray

    @property
    def joints_on_path(self) -> JointsOnPath:
        """Which joints follow, and how far the others go."""
        return self.stretch.joints_on_path or JointsOnPath(
            self.arm.follows, np.zeros((2, len(self.start)))
        )

    @property
    def free(self) -> np.ndarray:
        """(k,) which joints follow the path."""
        return self.joints_on_path.free

    def rates(self, positions: np.ndarray, strokes: np.ndarray) -> np.ndarray:
        """(n, k) [1/s] how fast the joints go at positions (n, k), in the least motion.

        Args:
            strokes: (3, n, 2) of the stretch.
        """
        _, rates = self.arm.tool.poses_and_rates(positions)
        found = strokes[1] @ self.joints_on_path.held
        wanted = self.stretch.rates(strokes[0], strokes[1]) - (rates @ found[..., None])[..., 0]
        found[:, self.free] = least_motion(rates[:, :, self.free], wanted[:, :, None])[:, :, 0]
        return found

    def positions(self, shares: np.ndarray) -> np.ndarray:
        """(n, k) the joints at shares (n,) of the stretch, which increase from 0 to 1.

        Raises:
            BadInput: the tool cannot go on; where it is, and the joints.
        """
        at, found, rates = self._coarse
        i = np.clip(np.searchsorted(at, shares, side="right") - 1, 0, len(at) - 2)
        cubics = cubics_of(at, found, rates)
        near = position_on(
            type(cubics)(*(part[i] for part in cubics)),
            ((shares - at[i]) / np.diff(at)[i])[:, None],
        )
        strokes = self._strokes(shares)[0]
        near[:, ~self.free] = (self.start + strokes @ self.joints_on_path.held)[:, ~self.free]
        poses = self.stretch.poses(strokes)
        solved = joints_at(self.arm.tool, poses, near, self.free)
        bad = int(np.argmax(solved.residual))
        if solved.residual[bad] > REACHED:
            raise _stuck(self.arm, poses[bad], near[bad])
        return solved.positions

    def _strokes(self, shares: np.ndarray) -> np.ndarray:
        return self.stretch.strokes(shares, np.ones_like(shares), np.zeros_like(shares))

    def rates_at(self, position: np.ndarray, share: float) -> np.ndarray:
        """(k,) how the joints go with the share."""
        return self.rates(position[None], self._strokes(np.array([share])))[0]

    @cached_property
    def _coarse(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Shares (m,), joints and their derivatives by the share (m, k), near enough for cubics between them."""
        shares, found, rates = [0.0], [self.start], [self.rates_at(self.start, 0.0)]
        step = 1.0
        while shares[-1] < 1.0:
            step = min(step, 1.0 - shares[-1], LONGEST / max(float(np.abs(rates[-1]).max()), 1e-9))
            near = found[-1] + step * rates[-1]
            share = 1.0 if shares[-1] + step > 1.0 - 1e-12 else shares[-1] + step
            strokes = self._strokes(np.array([share]))[0]
            near[~self.free] = (self.start + strokes @ self.joints_on_path.held)[0, ~self.free]
            pose = self.stretch.poses(strokes)
            solved = joints_at(self.arm.tool, pose, near[None], self.free)
            if (
                solved.residual[0] <= REACHED
                and np.abs(solved.positions[0] - near).max() <= FORESEEN
            ):
                shares.append(share)
                found.append(solved.positions[0])
                rates.append(self.rates_at(found[-1], share))
                step *= 2.0
            elif (step := 0.5 * step) < SHORTEST:
                raise _stuck(self.arm, pose[0], found[-1])
        return np.array(shares), np.array(found), np.array(rates)


def joints_on_path(
    arm: Arm, hold: Mapping[str, float] | None, start: np.ndarray, free_beside: Collection[str] = ()
) -> JointsOnPath:
    """What a line or an arc from where the joints are (k,) says of them.

    Args:
        hold: where joints go meanwhile, by name. free_beside: joints beside the arm that follow the path too; the
            others go only where `hold` says.

    Raises:
        UnknownJoint: one that is told is none of the program. BadInput: fewer than six are left.
    """
    free, change = arm.follows.copy(), np.zeros(len(start))
    free[len(arm.own) :] = False
    for name in free_beside:
        column = arm.column(name, "free")
        if column < len(arm.own) or not arm.follows[column]:
            fault = f"joint {name!r} is not between the frame of the target and the arm"
            raise BadProgram(fault, where="free", valid="a joint below a frame, beside the arm")
        free[column] = True
    for name, value in (hold or {}).items():
        column = arm.column(name, "hold")
        free[column], change[column] = False, value - start[column]
        low, high = arm.ranges[column]
        if not low <= value <= high:
            fault = f"{value:.4g} is beyond the limit of joint {name!r}"
            raise BadProgram(fault, where="hold", valid=f"{low:.4g} to {high:.4g}")
    if free.sum() < 6:
        raise BadProgram(
            f"{int(free.sum())} joints are free to follow the tool's path",
            valid="six or more: a frame on what the arm does not move"
            if arm.seen_from
            else "six or more; an arm of fewer goes by joint moves",
        )
    least_time = float((np.abs(change) / fastest(arm.joints)).max(initial=0.0))
    return JointsOnPath(free, np.stack([change, np.zeros_like(change)]), least_time)


def _stuck(arm: Arm, pose: np.ndarray, joints: np.ndarray) -> BadProgram:
    shown = ", ".join(f"{value:.4g}" for value in joints)
    return BadProgram(
        f"the tool cannot go on at {arm.place(pose)}, with joints at {shown}",
        valid="a target within reach, and no singularity on the way",
    )
