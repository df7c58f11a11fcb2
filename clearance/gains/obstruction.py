"""What no change of a kind can mend: a pair at a step that falls short, and that nothing of it moves.

Not for: what is too far to reach (`lower_bounds`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from clearance.gains.lower_bounds import INWARD, way_needed
from clearance.gains.offsets import JointOffsets
from clearance.gains.shortfalls import SAME, Gradient, State
from clearance.gains.tool_poses import ToolKeep
from clearance.record.record import Record
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import moves_with_joints
from clearance.simulate.answers.transfers import CombinedTransfers, Transfers
from clearance.world.forest import WORLD, forest_of

NOT_MOVED = "nothing of this change moves them"
KEPT_STILL = "that moment is to be kept"
NOT_SEPARATED = "small changes of this kind do not separate them there"
NOT_FOUND = "the search found no change that gives more"
NOT_PROVEN = "the motion there, between two steps, is not proven to keep them"
TOO_FAR = "no change within what is allowed is large enough"
TOO_SLOW = "no slow-down that was tried gives more"
HOWEVER_SLOW = "however slow it goes, it is no farther from them by then"
AT_REST = "they stand there whatever the delay"
ON_ITS_WAY = "its path leads there whatever the delay"
TOO_LATE = "no delay that was tried gives more"


SHOWN = 5e-7
"""[m] Half of the last digit of a clearance in words."""

HOPELESS = (NOT_MOVED, KEPT_STILL, TOO_FAR, HOWEVER_SLOW, AT_REST, ON_ITS_WAY)
"""With these no change of the kind, however large, makes every rule hold."""


@dataclass(frozen=True)
class Obstruction:
    """A pair that stays too near.

    Attributes:
        body_a, body_b: names, as in tables. time: [s]. clearance: [m] less padding and depth. wanted: [m].
        why: one of the reasons of this file.
    """

    body_a: str
    body_b: str
    time: float
    clearance: float
    wanted: float
    why: str

    def __str__(self) -> str:
        far = f"{self.clearance * 1e3:.3f} mm apart"
        if self.clearance < 0.0:
            far = f"{-self.clearance * 1e3:.3f} mm deep in each other"
        claim = f"{self.body_a} and {self.body_b} are {far} at {self.time:.3f} s"
        needed = f"{self.wanted * 1e3:.6g} mm"
        if abs(self.clearance - self.wanted) < SHOWN:
            return (
                f"{claim}, equal to the {needed} that are needed but for rounding, and {self.why}"
            )
        return f"{claim}, {needed} are needed, and {self.why}"


def blocked_by(
    state: State, gradient: Gradient, transfers: Transfers | CombinedTransfers
) -> Obstruction | None:
    """The worst pair that falls short and that no change moves; None without one.

    Args:
        transfers: parts that the change hands over elsewhere, which it moves though none of it carries them then.
    """
    near = [one for one in state.near if not transfers.has(one)]
    found = [one_pair for one in near if (one_pair := _worst(state, one, gradient)) is not None]
    return min(found, key=lambda one_pair: one_pair.clearance - one_pair.wanted, default=None)


def approach_of(blocked: Obstruction, state: State) -> Approach:
    """The approach that something is blocked by."""
    names = {blocked.body_a, blocked.body_b}
    return next(one for one in state.near if {body.name_in(one.case) for body in one.pair} == names)


def kept_still(blocked: Obstruction, windows: Sequence[tuple[float, float]]) -> Obstruction:
    """The same, for the reason that a path stays as it is then, if one of the windows [s of the run] says so."""
    within = any(start <= blocked.time <= end for start, end in windows)
    return replace(blocked, why=KEPT_STILL) if within and blocked.why == NOT_SEPARATED else blocked


def pair_at(state: State, approach: Approach, row: int, why: str) -> Obstruction:
    """What falls short in a row of an approach."""
    case = approach.case
    return Obstruction(
        approach.pair.a.name_in(case),
        approach.pair.b.name_in(case),
        float(approach.times[row]),
        float(approach.clearances[row]),
        approach.rule.limits.fail + state.margin,
        why,
    )


def worst_pair(state: State, why: str) -> Obstruction | None:
    """The pair that falls short by most; None where none does at a step.

    What is wanted beyond, for the motion between the steps, does not count.
    """
    rows = [(float(own.max()), i, int(own.argmax())) for i, one in enumerate(state.near)
            if len(own := state.margin + one.rule.limits.least_kept - one.clearances)]  # fmt: skip
    if not rows or max(rows)[0] <= 0.0:
        return None
    _, i, row = max(rows)
    return pair_at(state, state.near[i], row, why)


def unproven(record: Record, margin: float) -> Obstruction:
    """The most critical moment in a run whose steps keep what is wanted, and that is not proven."""
    moment = record.worst
    wanted = record.rule(moment.rule).limits.fail + margin
    return Obstruction(
        moment.link, moment.obstacle, moment.time, moment.clearance, wanted, NOT_PROVEN
    )


def _worst(state: State, approach: Approach, gradient: Gradient) -> Obstruction | None:
    missing, by_unit = state.missing(approach), gradient(approach, None)
    stays = missing > state.wanted.beyond
    if by_unit is not None:
        stays &= ~by_unit.any(axis=1)
    rows = np.flatnonzero(stays)
    if not len(rows):
        return None
    why = NOT_MOVED if by_unit is None else NOT_SEPARATED
    return pair_at(state, approach, int(rows[np.argmax(missing[rows])]), why)


def tool_obstruction(state: State, offsets: JointOffsets) -> Obstruction | None:
    """A pair that no path parts while its tool stays within what it is given; None without one.

    Moments are looked at that are steps of the run.
    """
    if offsets.tool_poses is None:
        return None
    link = offsets.tool_poses.tool.link
    for approach in state.near:
        if offsets.transfers.has(approach):
            continue
        for keep in offsets.tool_keeps:
            for row in np.flatnonzero(np.abs(approach.times - keep.time) <= SAME).tolist():
                most = _most(offsets, approach, row, keep, link)
                if INWARD * float(way_needed(approach, state.margin)[row]) > most:
                    return pair_at(state, approach, row, KEPT_STILL)
    return None


def _most(offsets: JointOffsets, approach: Approach, row: int, keep: ToolKeep, link: int) -> float:
    """[m] How far the bodies of an approach may move against each other; infinite if neither is fixed to the
    tool.
    """
    case = approach.case
    moved = [body for body in approach.pair if moves_with_joints(case, body, offsets.columns)]
    if len(moved) != 1:
        return float("inf")
    (body,) = moved
    forest, frame = forest_of(case), body.frame_in(case)
    tool = forest.robot_starts[offsets.i_robot] + link
    if frame == WORLD or forest.rigid_part(frame) != forest.rigid_part(tool):
        return float("inf")
    corners = body.shape_in(case).box_corners
    pose = body.poses_in(case, approach.poses[row : row + 1])[0]
    world = corners @ pose[:3, :3].T + pose[:3, 3]
    arms = np.linalg.norm(world - approach.poses[row, tool, :3, 3], axis=1)
    return keep.far + keep.turn * float(arms.max())
