"""Pairs that touch all the time, as an arm's foot and its table, or links drawn into one another: hints.

Not for: pairs that touch for a while, which are what a run finds, but where a part changes hands (`handling`).
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np

from clearance.record.contact import ContactRows
from clearance.record.record import Record
from clearance.simulate.answers.handling import gap_between, handling_hints
from clearance.simulate.measure.sections import SectionPlan, section_plan
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.kinematic_chain import chain_between
from clearance.world.mimics import followers
from clearance.world.motion import Motion
from clearance.world.notice import listed
from clearance.world.pairs import BodyIndex
from clearance.world.self_pairs import neighbours


def standing_contacts(record: Record) -> list[tuple[str, str]]:
    """The two bodies of the measured pairs that touch at every moment, since neither ever moves."""
    if (
        record.rows.n_rows < 2 or not (record.clearances <= 0.0).any()
    ):  # one step is not "at every moment"
        return []
    case = record.case
    standing = [_standing_links(motion) for motion in record.motions]
    first = record.timeline.phases[0]
    poses = link_poses_at(first.case, first.motions, slice(0, 1))
    touching = []
    for pair in section_plan(record.timeline).pairs:
        if not all(_stands(case, body, standing) for body in (pair.a, pair.b)):
            continue
        pose_a, pose_b = (body.poses_in(first.case, poses)[0] for body in (pair.a, pair.b))
        shapes = pair.a.shape_in(case), pair.b.shape_in(case)
        if gap_between(shapes[0], pose_a, shapes[1], pose_b, far=0.0) <= 0.0:
            touching.append((pair.a.name_in(case), pair.b.name_in(case)))
    return touching


def standing_bodies(record: Record) -> frozenset[str]:
    """The names of the measured bodies that never move."""
    standing = [_standing_links(motion) for motion in record.motions]
    bodies = {body for pair in section_plan(record.timeline).pairs for body in (pair.a, pair.b)}
    case = record.case
    return frozenset(body.name_in(case) for body in bodies if _stands(case, body, standing))


def _stands(case: Case, body: BodyIndex, standing: list[set[str]]) -> bool:
    """True for an obstacle that stands and is never carried, and for a link that no joint moves."""
    if body.is_obstacle:
        carried = any(carry.part == body.name_in(case) for carry in case.carries)
        return case.obstacles[body.i_body].stands and not carried
    if case.robots[body.i_robot].mount is not None:
        return False
    return body.own_name_in(case) in standing[body.i_robot]


def always_in_contact(record: Record) -> list[tuple[str, str]]:
    """The pairs that touch at every step of several at which they are measured.

    A link that a joint moves against an obstacle that stands is excluded: that is what a run finds.
    """
    rows = record.contacts
    if not isinstance(rows, ContactRows) or not len(rows) or record.rows.n_rows < 2:
        return []
    case, plan = record.case, section_plan(record.timeline)
    n_steps = np.bincount(rows.pairs, minlength=len(plan.pairs))
    n_measured = _n_measured(plan)
    standing: list[set[str]] = [set() for _ in case.robots]
    return [
        (pair.a.name_in(case), pair.b.name_in(case))
        for pair, n_touching, n_all in zip(plan.pairs, n_steps, n_measured, strict=True)
        if n_touching == n_all > 1 and (pair.a.is_obstacle or not _stands(case, pair.b, standing))
    ]


def touching_throughout(record: Record) -> list[tuple[str, str]]:
    """The pairs of both kinds: what never moves and touches, and what touches at every step."""
    return list(dict.fromkeys([*standing_contacts(record), *always_in_contact(record)]))


def _n_measured(plan: SectionPlan) -> np.ndarray:
    """(p,) at how many steps each pair of a run is measured; a step where two phases meet is one."""
    n_steps = np.zeros(len(plan.pairs), dtype=np.int64)
    last = np.full(len(plan.pairs), -1, dtype=np.int64)
    for section in sorted(plan.sections, key=lambda section: section.phase.first):
        phase, own = section.phase, section.places
        n_steps[own] += phase.n_steps - (last[own] == phase.first)
        last[own] = phase.last
    return n_steps


def standing_hint(record: Record) -> list[str]:
    """One hint for each kind of such pairs, and for parts that touch as they change hands; the last has the block
    of the case file that leaves all of them out."""
    standing = standing_contacts(record)
    always = [pair for pair in always_in_contact(record) if pair not in standing]
    obstacles = {one.name for one in record.case.obstacles}
    links = [pair for pair in always if obstacles.isdisjoint(pair)]
    known = {frozenset(pair) for pair in (*standing, *always)}
    parts = [hint for hint in handling_hints(record) if hint.pair not in known]
    hints = [
        *_hint(standing, "all the time, since the link never moves"),
        *(
            one + _on_links(record.case, links)
            for one in _hint(links, "at every step, link against link")
        ),
        *_hint([pair for pair in always if pair not in links], "whenever they are measured"),
        *map(str, sorted(parts, key=lambda hint: not hint.is_deeper)),
    ]
    rows = [json.dumps(pair, ensure_ascii=False) for pair in (*standing, *links, *always)]
    rows += [hint.row for hint in parts if not hint.is_deeper]
    if rows:
        block = ", ".join(dict.fromkeys(rows))
        lines = (
            f"its rows of allow: {block}" if record.case.allow else f"the case: allow: [{block}]"
        )
        hints[-1] += f"; where that is meant, add to {lines}"
    return hints


def _on_links(case: Case, pairs: list[tuple[str, str]]) -> str:
    """Why links may touch that need not: an SRDF does not excuse neighbours unless it says so, and nobody opens
    fingers whose joint nobody gives."""
    unexcused, resting = [], dict[str, None]()
    for i, placed in enumerate(case.robots):
        bodies, matrix = placed.robot.bodies, placed.self_clearance and placed.self_clearance.matrix
        links = {BodyIndex(i, k).name_in(case): body.name for k, body in enumerate(bodies)}
        given = {*(placed.trajectory.joint_names if placed.trajectory else ())}
        given |= {*placed.fixed_positions}
        joined = neighbours(placed.robot) if matrix else frozenset()
        for a, b in (pair for pair in pairs if links.keys() >= {*pair}):
            unexcused += [f"{a} - {b}"] * (frozenset((links[a], links[b])) in joined)
            between = chain_between(placed.robot, links[a], links[b]).masters
            resting |= {one.name: None for one in between if one.name not in given}
    said = ""
    if unexcused:
        said += f"; the SRDF does not excuse the neighbours {listed(unexcused)}"
    if resting:
        are = (
            "is given by nobody and stays" if len(resting) == 1 else "are given by nobody and stay"
        )
        names = listed([*map(repr, resting)])
        said += f"; {names} between them {are} at 0: robot: {{joints: …}} may part them"
    return said


def _hint(pairs: list[tuple[str, str]], when: str) -> Iterator[str]:
    if pairs:
        count = "1 pair touches" if len(pairs) == 1 else f"{len(pairs)} pairs touch"
        yield f"{count} {when}: {listed([' - '.join(pair) for pair in pairs])}"


def _standing_links(motion: Motion) -> set[str]:
    """The links that no joint moves."""
    robot = motion.placed.robot
    moved = set(_moved_joints(motion))
    still = {robot.link_names[0]}
    for joint in robot.joints:
        if joint.parent in still and joint.name not in moved:
            still.add(joint.child)
    return still


def _moved_joints(motion: Motion) -> Iterator[str]:
    """The joints that move at any time, those that follow another included."""
    going = np.ptp(motion.positions, axis=0) > 0.0
    if motion.velocities is not None:
        going |= (motion.velocities != 0.0).any(axis=0)
    moving = {name for name, goes in zip(motion.joint_names, going, strict=True) if goes}
    for one in followers(motion.placed.robot):
        if one.master in moving and one.factor:
            yield one.joint.name
