"""Pairs that a tool's tolerance keeps too near: what is fixed to a tool goes no farther than the tool may.

A point that is R off the tool's origin moves no farther than the origin may and R times the angle it may turn. Not
for: stretches of a path that are kept (`obstruction`).
"""

from __future__ import annotations

import numpy as np

from clearance.gains.lower_bounds import INWARD, way_needed
from clearance.gains.obstruction import KEPT_STILL, Obstruction, pair_at
from clearance.gains.offsets import JointOffsets
from clearance.gains.shortfalls import SAME, State
from clearance.gains.tool_poses import ToolKeep
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import moves_with_joints
from clearance.world.forest import WORLD, forest_of


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
        phase = approach.section.phase
        times = phase.times[approach.steps - phase.first]
        for keep in offsets.tool_keeps:
            for row in np.flatnonzero(np.abs(times - keep.time) <= SAME).tolist():
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
    corners = np.stack(np.meshgrid(*body.shape_in(case).bounds.T), axis=-1).reshape(-1, 3)
    pose = body.poses_in(case, approach.poses[row : row + 1])[0]
    world = corners @ pose[:3, :3].T + pose[:3, 3]
    arms = np.linalg.norm(world - approach.poses[row, tool, :3, 3], axis=1)
    return keep.far + keep.turn * float(arms.max())
