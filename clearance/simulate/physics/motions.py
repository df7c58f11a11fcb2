"""The simulated motions of a case's robots, each in a world of its own; what that leaves out is said or refused.

A robot follows its own table; one on a base that moves is simulated in the frame of the base, in which gravity
turns. What is carried has no weight. Not for: the physics engine (`bullet`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from clearance.errors import NotSimulated
from clearance.simulate.physics.bullet import GRAVITY, SETTLE_TIME, simulated_motion
from clearance.simulate.physics.course import notices_on_limits
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of, link_poses_at, positions_between
from clearance.world.motion import Motion, kinematic_motion, place_in
from clearance.world.robot_in_cell import link_below, robots_below
from clearance.world.timeline import Timeline, timeline_of


def simulated_motions(case: Case) -> tuple[Motion, ...]:
    """The motion of each robot at the times of its own table, its notes with what was ignored.

    Raises:
        BadInput: what pushes back does not stand, or a robot loops. And what `simulated_motion` raises.
    """
    if case.contact_response:
        _require_standing_world(case)
    _require_no_loops(case)
    asked = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    made = [_simulated(case, asked, i) for i in range(len(case.robots))]
    weights = _weights(asked)
    return tuple(
        _judged(case, _with_notes(motion, [*motion.notes, *weights[i]], several=len(made) > 1))
        for i, motion in enumerate(made)
    )


def _require_standing_world(case: Case) -> None:
    """Nothing, if there is one robot among obstacles that stand: only these push back."""
    carried = {carry.part for carry in case.carries}
    moving = [o.name for o in case.obstacles if not o.stands or o.name in carried]
    if len(case.robots) > 1:
        raise NotSimulated(
            f"{len(case.robots)} robots: in simulated motion robots do not push one another",
            where="contact_response",
            valid="contact_response: false, or one robot",
        )
    if moving:
        raise NotSimulated(
            f"{', '.join(moving)} would not push back in simulated motion: only obstacles that stand do",
            where="contact_response",
            valid="contact_response: false, or obstacles that stand",
        )


def _require_no_loops(case: Case) -> None:
    for placed in case.robots:
        if placed.trajectory is not None and placed.timing.after == "loop":
            raise NotSimulated(
                f"robot {placed.robot.name!r}: after: loop in simulated motion, which knows one round",
                valid="after: hold or absent, or kinematic motion",
            )


def _simulated(case: Case, asked: Timeline, i_robot: int) -> Motion:
    placed = case.robots[i_robot]
    if placed.trajectory is None:
        note = "simulated motion: it has no trajectory; it stands as given and is not simulated"
        return replace(kinematic_motion(placed), notes=(note,))
    settle_time = 0.0 if placed.timing.after == "absent" else SETTLE_TIME
    if placed.mount is None:
        return simulated_motion(placed, case.obstacles, case.contact_response, settle_time)
    standing = _standing_base(asked, i_robot)
    if standing is not None:
        there = replace(placed, mount=None, world_from_base=standing)
        found = simulated_motion(there, case.obstacles, case.contact_response, settle_time)
        return replace(found, placed=placed)

    def gravity_at(times: np.ndarray) -> np.ndarray:
        turned = _base_rotations(asked, i_robot, placed.timing.run_times(times))
        return np.array(GRAVITY) @ turned  # the base sees it turned back

    found = simulated_motion(placed, settle_time=settle_time, gravity_at=gravity_at)
    note = (
        f"simulated motion: the acceleration of its base on {placed.mount.on} is not felt; gravity is, "
        "turned as the trajectories turn the base"
    )
    return replace(found, notes=(*found.notes, note))


def _standing_base(asked: Timeline, i_robot: int) -> np.ndarray | None:
    """(4, 4) `world_from_base` [m] of a robot on something that never moves, or None."""
    poses = []
    for phase in asked.phases:
        forest = forest_of(phase.case)
        start = forest.robot_starts[i_robot]
        if forest.rigid_part(start) != WORLD:
            return None
        poses.append(link_poses_at(phase.case, phase.motions, slice(0, 1))[0, start])
    return poses[0] if all(np.array_equal(pose, poses[0]) for pose in poses) else None


def _base_rotations(asked: Timeline, i_robot: int, times: np.ndarray) -> np.ndarray:
    """(n, 3, 3) `world_from_base` at times [s] of the run; before and after it, those of its ends."""
    found = np.empty((len(times), 3, 3))
    for row, time in enumerate(times):
        step, share = place_in(asked.times, time)
        phase = asked.phase_of(step)
        columns = positions_between(phase.case, phase.motions, step - phase.first, share)
        forest = forest_of(phase.case)
        found[row] = forest.poses(columns[None])[0, forest.robot_starts[i_robot], :3, :3]
    return found


def _weights(asked: Timeline) -> dict[int, list[str]]:
    """Of each robot a note on what is on it, if anything is at some time."""
    on: dict[int, dict[str, None]] = {i: {} for i in range(len(asked.motions))}
    for i_robot, name in _loads(asked):
        on[i_robot][name] = None
    return {
        i: [f"simulated motion: the weight of {', '.join(names)}, which it carries, is not felt"]
        if names
        else []
        for i, names in on.items()
    }


def _loads(asked: Timeline) -> Iterator[tuple[int, str]]:
    """Each robot by its place in the case, and the name of something that is on it in some phase."""
    for phase in asked.phases:
        for i in range(len(phase.case.robots)):
            yield from (
                (below, phase.case.robots[i].robot.name) for below in robots_below(phase.case, i)
            )
        for i, obstacle in enumerate(phase.case.obstacles):
            below_it = link_below(phase, i)
            if below_it is not None:
                yield below_it[0], obstacle.name


def _judged(case: Case, motion: Motion) -> Motion:
    """The motion with notices where it takes joints beyond their limits."""
    if motion.n_steps == 1:
        return motion
    placed, rule = motion.placed, case.limits.joints
    found = notices_on_limits(placed, motion.times, motion.positions, rule, case.prefix_of(placed))
    return replace(motion, notices=(*motion.notices, *found))


def _with_notes(motion: Motion, notes: list[str], *, several: bool) -> Motion:
    """The motion with notes; where there are several robots each says of which it is."""
    if several:
        of_this = f"simulated motion of {motion.placed.robot.name}"
        notes = [note.replace("simulated motion", of_this, 1) for note in notes]
    return replace(motion, notes=tuple(notes))
