"""Carries of parts that may not be meant: what grips is far away, has the part already, or leaves a shape behind.

Not for: contact as a part changes hands (`handling`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.kernels.motion.kinematics import FIXED, NO_PARENT
from clearance.simulate.answers.handling import gap_between
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.extents import metres
from clearance.world.forest import carried_by, forest_of, link_poses_at, owner_of
from clearance.world.mount import Mount
from clearance.world.notice import Notice, Severity, listed
from clearance.world.pairs import OBSTACLE, BodyIndex
from clearance.world.phase import Phase
from clearance.world.timing import time_text

FAR_GRASP = 0.3
"""[m] No gripper that a model leaves out is so long: a part that is farther away is picked up too soon."""


def notices_on_carries(phases: Sequence[Phase]) -> Iterator[Notice]:
    """A warning on each carry that may not be meant."""
    seen: set[Carry] = set()
    texts = [*_left_behind(phases[0].case)]
    for phase in phases:
        for carry in phase.carried.values():
            if carry in seen:
                continue
            if carry.part not in {one.part for one in seen} and phase is not phases[0]:
                texts += _held_before(phases[0].case, carry)
            seen.add(carry)
            gap = _grasp_gap(phase, carry)
            if FAR_GRASP < gap < np.inf:
                check = "its place" if phase is phases[0] else "the times of its carry"
                texts.append(
                    f"part {carry.part!r} is {metres(gap)} m away from all of what picks it up at "
                    f"{time_text(carry.window.start)} s ({carry.by}): check {check}"
                )
    return (Notice(Severity.WARNING, "carry", text) for text in texts)


def _held_before(case: Case, carry: Carry) -> Iterator[str]:
    """A line if a part rides on its carrier before that picks it up."""
    mounts = {one.name: one.mount for one in case.obstacles}
    mount, forest = mounts[carry.part], forest_of(case)
    if mount is not None and forest.link_called(case, mount.on) == forest.link_called(
        case, carry.by
    ):
        yield (
            f"part {carry.part!r} is on {carry.by!r} already when that picks it up at "
            f"{time_text(carry.window.start)} s: it rides along from the start; give it a place in the "
            "cell if it lies there until then"
        )


def _left_behind(case: Case) -> Iterator[str]:
    """A line on each object of which some shapes are carried, and others stand all the time."""
    parts = dict.fromkeys(carry.part for carry in case.carries)
    for whole in dict.fromkeys(part.rpartition("/")[0] for part in parts):
        shapes = [one for one in case.obstacles if whole and one.name.rpartition("/")[0] == whole]
        left = [repr(one.name) for one in shapes if one.name not in parts and one.stands]
        if left:
            taken = [repr(one.name) for one in shapes if one.name in parts]
            yield (
                f"object {whole!r} is carried in part: {listed(taken, 4)} moves, {listed(left, 4)} stays; "
                f"part: {whole} carries all"
            )


def _grasp_gap(phase: Phase, carry: Carry) -> float:
    """[m] From a part to the nearest body of what carries it, as it is picked up; infinite if that has no body."""
    case = phase.case
    part = BodyIndex(OBSTACLE, [one.name for one in case.obstacles].index(carry.part))
    poses = link_poses_at(case, phase.motions, slice(0, 1))
    placed = part.shape_in(case), part.poses_in(case, poses)[0]
    gaps = (
        gap_between(*placed, one.shape_in(case), one.poses_in(case, poses)[0])
        for one in _gripping(case, carry.by, part)
    )
    return min(gaps, default=np.inf)


def _gripping(case: Case, name: str, part: BodyIndex) -> list[BodyIndex]:
    """The bodies beside the part of what is called so: all that fixed joints join to it, and all below that.

    Where none of this has a shape, it is what that hangs on. An obstacle that stands has what stands on it.
    """
    bodies = [BodyIndex(OBSTACLE, i) for i in range(len(case.obstacles))]
    for i, placed in enumerate(case.robots):
        bodies += [BodyIndex(i, k) for k in range(len(placed.robot.bodies))]
    bodies.remove(part)
    forest = forest_of(case)
    above = {one: {*carried_by(forest, one.frame_in(case))} for one in bodies}
    for top in carried_by(forest, forest.link_called(case, name)):
        is_rigid = forest.links.kinds[top] == FIXED and forest.links.parents[top] != NO_PARENT
        found = [] if is_rigid else [one for one, links in above.items() if top in links]
        if found:
            return found
    return [one for one in bodies if one.is_obstacle and _is_on(case, one.i_body, name)]


def _is_on(case: Case, i_obstacle: int, name: str) -> bool:
    """True for an obstacle that is, or stands on, one that stands and is called so."""
    mount = case.obstacles[i_obstacle].mount
    owner = (True, i_obstacle) if mount is None else owner_of(case, mount)
    return owner == owner_of(case, Mount(name))
