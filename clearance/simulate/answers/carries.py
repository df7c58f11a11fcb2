"""Carries of parts that may not be meant: what grips is far away, goes away or passes by, has the part already, or
leaves a shape behind; and parts that leave the cell in somebody's hands.

Not for: contact as a part changes hands (`handling`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from clearance.geometry.pose import inverse
from clearance.kernels.motion.kinematics import FIXED, NO_PARENT
from clearance.simulate.answers.handling import gap_between
from clearance.world.body import Mount
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.extents import metres
from clearance.world.forest import (
    WORLD,
    carried_by,
    forest_of,
    link_poses_at,
    owner_of,
    positions_along,
)
from clearance.world.notice import Notice, Severity, listed
from clearance.world.pairs import OBSTACLE, BodyIndex, bodies_of
from clearance.world.phase import Phase
from clearance.world.timing import time_text

FAR_GRASP = 0.3
"""[m] No gripper that a model leaves out is so long: a part that is farther away is picked up too soon."""

GOES_AWAY = 0.1
"""[m] Fingers go no farther away from a part while their hand carries it."""

PASSES, BRIEFLY = 0.05, 1e-3
"""[m/s], [s] A hand that grips, or lets go, is no faster; so long before and after its speed is looked at."""

GOES_ON = 0.1
"""[-] A hand whose velocity changes by no more than this part of it goes on as it went."""


def notices_on_carries(phases: Sequence[Phase]) -> Iterator[Notice]:
    """A warning on each carry that may not be meant."""
    first, held = phases[0], dict[Carry, list[Phase]]()
    texts = [*_left_behind(first.case)]
    for phase in phases:
        for carry in phase.carried.values():
            if carry.part not in {one.part for one in held} and phase is not first:
                texts += _held_before(first.case, carry)
            held.setdefault(carry, []).append(phase)
    for carry, during in held.items():
        check = "its place" if during[0] is first else "the times of its carry"
        texts += _far_away(carry, _gaps(carry, during), check)
    for before, phase in itertools.pairwise(phases):
        texts += _in_passing(before, phase)
        texts += _leaves_too(before, phase)
    return (Notice(Severity.WARNING, "carry", text) for text in texts)


def _far_away(carry: Carry, gaps: Sequence[tuple[float, float]], check: str) -> Iterator[str]:
    """A line on a part that is far from what carries it: as it is picked up, or later.

    Args:
        gaps: [m], [s] how far it is, and when. check: the advice for the first of them.
    """
    if not gaps:
        return
    (gap, _), (most, then) = gaps[0], max(gaps)
    if FAR_GRASP < gap < np.inf:
        yield (
            f"part {carry.part!r} is {metres(gap)} m away from all of what picks it up at "
            f"{time_text(carry.window.start)} s ({carry.by}): check {check}"
        )
    elif GOES_AWAY < most - gap < np.inf:
        yield (
            f"part {carry.part!r} is {metres(most - gap)} m farther away from all of what picked it up "
            f"({carry.by}) at {time_text(then)} s: check who carries it"
        )


def _in_passing(before: Phase, phase: Phase) -> Iterator[str]:
    """A line on each standing part that is gripped, and each part that is let go, by what does not stop for it."""
    for one in (*before.carried.values(), *phase.carried.values()):
        if one.part in before.carried and one.part in phase.carried:
            continue  # it stays in a hand, or goes to another
        grips = one.part in phase.carried
        name, place = one.part, _place_of(phase, one.part)
        if grips and np.linalg.norm(_velocity(before, name, place, at_end=True)) > PASSES:
            continue
        came, goes = _velocity(before, one.by, place, at_end=True), _velocity(phase, one.by, place)
        speed = float(np.linalg.norm(came))
        if speed > PASSES and np.linalg.norm(goes - came) <= GOES_ON * speed:
            deed = "picks up" if grips else "lets go of"
            yield (
                f"{one.by!r} {deed} part {name!r} at {time_text(phase.span[0])} s in passing, at "
                f"{metres(speed)} m/s: check the times of its carry"
            )


def _place_of(phase: Phase, part: str) -> np.ndarray:
    """(3,) [m] Where the middle of a part is as a phase begins."""
    case = phase.case
    body = BodyIndex(OBSTACLE, [one.name for one in case.obstacles].index(part))
    pose = body.poses_in(case, link_poses_at(case, phase.motions, slice(0, 1)))[0]
    return pose[:3, :3] @ body.shape_in(case).bounds.mean(axis=0) + pose[:3, 3]


def _velocity(phase: Phase, name: str, place: np.ndarray, *, at_end: bool = False) -> np.ndarray:
    """(3,) [m/s] How the point of what is called so moves that is at a place (3,) as a phase begins, or ends."""
    link = forest_of(phase.case).link_called(phase.case, name)
    if link == WORLD:
        return np.zeros(3)
    step = phase.n_steps - 2 if at_end else 0
    length = float(phase.times[step + 1] - phase.times[step])
    brief = min(0.5, BRIEFLY / length)
    shares = np.array([1.0 - brief, 1.0] if at_end else [0.0, brief])
    positions = positions_along(phase.case, phase.motions, step, shares)
    start, end = forest_of(phase.case).poses(positions)[:, link]
    way = (end - start) @ inverse(end if at_end else start) @ [*place, 1.0]
    return way[:3] / (brief * length)


def _leaves_too(before: Phase, phase: Phase) -> Iterator[str]:
    """A line on each part that is in the cell no more since the robot that carries it is not (after: absent)."""
    case = phase.case
    for i in phase.absent_obstacles - before.absent_obstacles:
        carry = phase.carried.get(case.obstacles[i].name)
        is_obstacle, owner = (True, 0) if carry is None else owner_of(case, Mount(carry.by))
        if carry is not None and not is_obstacle and case.robots[owner].timing.after == "absent":
            yield (
                f"part {carry.part!r} leaves the cell at {time_text(phase.span[0])} s with {carry.by} (after: "
                "absent): nothing is measured against it from then on"
            )


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


def _gaps(carry: Carry, during: Sequence[Phase]) -> list[tuple[float, float]]:
    """[m] From a part to the nearest body of what carries it, and when [s]: at first, halfway, and at last.

    Shapes of one object that change hands together are one: the nearest counts, for the first of them; none of the
    others. Infinite if what carries it has no body.
    """
    case, whole = during[0].case, carry.part.rpartition("/")[0]
    together = {
        one.part
        for one in during[0].carried.values()
        if one == carry
        or (
            whole
            and (one.part.rpartition("/")[0], one.by, one.window) == (whole, carry.by, carry.window)
        )
    }
    parts = [BodyIndex(OBSTACLE, i) for i, one in enumerate(case.obstacles) if one.name in together]
    if carry.part != parts[0].name_in(case):
        return []
    bodies, found = _gripping(case, carry.by, parts), []
    halfway = during[len(during) // 2]
    for phase, step in (
        (during[0], 0),
        (halfway, halfway.n_steps // 2),
        (during[-1], during[-1].n_steps - 1),
    ):
        poses = link_poses_at(phase.case, phase.motions, slice(step, step + 1))
        placed = {
            one: (one.shape_in(case), one.poses_in(phase.case, poses)[0])
            for one in (*parts, *bodies)
        }
        gaps = (gap_between(*placed[a], *placed[b]) for a in parts for b in bodies)
        found.append((min(gaps, default=np.inf), float(phase.times[step])))
    return found


def _gripping(case: Case, name: str, parts: Sequence[BodyIndex]) -> list[BodyIndex]:
    """The bodies beside the parts of what is called so: all that fixed joints join to it, and all below that.

    Where none of this has a shape, it is what that hangs on. An obstacle that stands has what stands on it.
    """
    bodies = [body for body in bodies_of(case) if body not in parts]
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
