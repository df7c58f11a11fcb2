"""The joints along a stretch of a tool's path, from where they are at its beginning: found step by step, and
refused where they cannot follow. Not for: what lies between samples (`enclosure`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadProgram
from clearance.programs.arm import Arm
from clearance.programs.carriage import Carriage, Moved
from clearance.programs.inverse import joints_at, least_motion
from clearance.programs.joint_way import fastest
from clearance.programs.time_law import SHORTEST as SHORTEST_PIECE
from clearance.programs.time_law import Piece
from clearance.programs.tool_path import JointsOnPath, Stretch
from clearance.world.cubic import Cubics, position_on

SHORTEST = 2.0**-14
"""The least part of a stretch that a step may be: less is a singularity, or the end of what can be reached."""

LONGEST = 0.25
"""[rad] or [m]: the most that a joint may go in one step."""

FORESEEN = 0.05
"""[rad] or [m]: how far joints may be from where their rates say that they go."""

REACHED = 1e-9
"""[m] and [rad]: a pose that is missed by more is not reached."""


@dataclass(frozen=True, eq=False)
class Ride:
    """When a stretch is gone through that is seen from what moves by itself.

    Attributes:
        began: [s] of the carriage's time. pieces: how fast.
    """

    carriage: Carriage
    began: float
    pieces: Sequence[Piece]

    @cached_property
    def _edges(self) -> np.ndarray:
        return np.cumsum([0.0, *(piece.duration for piece in self.pieces)])

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self._edges[-1])

    @cached_property
    def ends(self) -> list[float]:
        """[s] from the beginning: where the speed of the carriage changes at once, and the end."""
        own = self.carriage.turning_points - self.began
        own = own[(own > SHORTEST_PIECE) & (own < self.duration - SHORTEST_PIECE)]
        return [*own.tolist(), self.duration]

    def moved(self, times: np.ndarray, before: bool = False) -> Moved:
        """The carriage at times (n,) [s] from the beginning."""
        return self.carriage.at(self.began + times, before)

    def strokes(self, stretch: Stretch, times: np.ndarray) -> np.ndarray:
        """(3, n, 2) of the stretch at times (n,) [s] from the beginning."""
        edges = self._edges
        i = np.clip(np.searchsorted(edges, times, side="right") - 1, 0, len(edges) - 2)
        _, share, rate, change = np.array(self.pieces).T[:, i]
        passed = times - edges[i]
        shares = share + passed * (rate + 0.5 * change * passed)
        return stretch.strokes(shares, rate + change * passed, change)


@dataclass(frozen=True, eq=False)
class Follower:
    """An arm whose tool follows a stretch.

    How far it has come is a share of the stretch, from 0 to 1; on a ride it is the time [s].

    Attributes:
        start: (k,) where its joints are at the beginning [rad or m].
        ride: None where the stretch is seen from what stands, or from what its joints move.
    """

    arm: Arm
    stretch: Stretch
    start: np.ndarray
    ride: Ride | None = None

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

    @property
    def whole(self) -> float:
        """How far it comes in all."""
        return 1.0 if self.ride is None else self.ride.duration

    def strokes(self, come: np.ndarray) -> np.ndarray:
        """(3, n, 2) of the stretch, so far (n,)."""
        if self.ride is not None:
            return self.ride.strokes(self.stretch, come)
        return self.stretch.strokes(come, np.ones_like(come), np.zeros_like(come))

    def poses(self, come: np.ndarray) -> np.ndarray:
        """(n, 4, 4) the tool [m], so far (n,)."""
        poses = self.stretch.poses(self.strokes(come)[0])
        return poses if self.ride is None else self.ride.moved(come).poses @ poses

    def tool_rates(self, strokes: np.ndarray, moved: Moved | None) -> np.ndarray:
        """(n, 6) [m/s] and [rad/s] how the tool moves and turns.

        Args:
            strokes: (3, n, 2) of the stretch. moved: what carries it; None off a ride.
        """
        found = self.stretch.rates(strokes[0], strokes[1])
        return found if moved is None else moved.rates(self.stretch.poses(strokes[0]), found)

    def rates(
        self, positions: np.ndarray, strokes: np.ndarray, moved: Moved | None = None
    ) -> np.ndarray:
        """(n, k) [1/s] how fast the joints go at positions (n, k), in the least motion; as `tool_rates`."""
        _, rates = self.arm.tool.poses_and_rates(positions)
        found = strokes[1] @ self.joints_on_path.held
        wanted = self.tool_rates(strokes, moved) - (rates @ found[..., None])[..., 0]
        found[:, self.free] = least_motion(rates[:, :, self.free], wanted[:, :, None])[:, :, 0]
        return found

    def positions(self, come: np.ndarray) -> np.ndarray:
        """(n, k) the joints so far (n,), which increases from 0 to the whole.

        Raises:
            BadInput: the tool cannot go on; where it is, and the joints.
        """
        at, found, leave, reach = self._coarse
        i = np.clip(np.searchsorted(at, come, side="right") - 1, 0, len(at) - 2)
        step, length = (found[i + 1] - found[i]), np.diff(at)[i, None]
        cubics = Cubics(found[i], step, length * leave[i] - step, length * reach[i + 1] - step)
        near = position_on(cubics, (come - at[i])[:, None] / length)
        near[:, ~self.free] = self._held(come)[:, ~self.free]
        poses = self.poses(come)
        solved = joints_at(self.arm.tool, poses, near, self.free)
        bad = int(np.argmax(solved.residual))
        if solved.residual[bad] > REACHED:
            raise self._stuck(come[bad], near[bad])
        return solved.positions

    def _held(self, come: np.ndarray) -> np.ndarray:
        """(n, k) where joints are that do not follow."""
        return np.asarray(self.start + self.strokes(come)[0] @ self.joints_on_path.held)

    def rates_at(self, position: np.ndarray, come: float, before: bool = False) -> np.ndarray:
        """(k,) how the joints go with how far it comes, from then on; until then with `before`."""
        at = np.array([come])
        moved = None if self.ride is None else self.ride.moved(at, before)
        return self.rates(position[None], self.strokes(at), moved)[0]

    @cached_property
    def _coarse(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """How far (m,), joints and their derivatives by that (m, k), as they go on and as they come there, near
        enough for cubics between them."""
        come, found, rates = [0.0], [self.start], [self.rates_at(self.start, 0.0)]
        reached = rates.copy()
        step = whole = self.whole
        ends = [whole] if self.ride is None else self.ride.ends
        while come[-1] < whole:
            end = next(one for one in ends if one > come[-1])
            step = min(step, end - come[-1], LONGEST / max(float(np.abs(rates[-1]).max()), 1e-9))
            near = found[-1] + step * rates[-1]
            ahead = end if come[-1] + step > end - whole * 1e-12 else come[-1] + step
            at = np.array([ahead])
            near[~self.free] = self._held(at)[0, ~self.free]
            pose = self.poses(at)
            solved = joints_at(self.arm.tool, pose, near[None], self.free)
            off = np.abs(solved.positions[0] - near).max()
            if solved.residual[0] <= REACHED and off <= FORESEEN:
                come.append(ahead)
                found.append(solved.positions[0])
                rates.append(self.rates_at(found[-1], ahead))
                is_same = self.ride is None
                reached.append(rates[-1] if is_same else self.rates_at(found[-1], ahead, True))
                step *= 2.0
            elif (step := 0.5 * step) < SHORTEST * whole:
                raise self._stuck(ahead, found[-1])
        return np.array(come), np.array(found), np.array(rates), np.array(reached)

    def _stuck(self, come: float, joints: np.ndarray) -> BadProgram:
        place = self.arm.place(self.poses(np.array([come]))[0])
        shown, ride = ", ".join(f"{value:.4g}" for value in joints), self.ride
        when = "" if ride is None else f" at {ride.began + come:.3f} s with {ride.carriage.name!r},"
        return BadProgram(
            f"the tool cannot go on{when} at {place}, with joints at {shown}",
            valid="a target within reach, and no singularity on the way",
        )


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
