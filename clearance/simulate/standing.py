"""Pairs that touch all the time, as an arm's foot and its table, or links drawn into one another: hints.

Not for: pairs that touch for a while, which are what a run looks for.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.query.distance import distance
from clearance.simulate.contact_rows import ContactRows
from clearance.simulate.record import Record
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.mimics import followers
from clearance.world.motion import Motion
from clearance.world.pairs import BodyIndex, measured_pairs


def standing_contacts(record: Record) -> list[tuple[str, str]]:
    """(link, obstacle) of the measured pairs that touch at every moment, since their link never moves."""
    if (
        record.steps.num_rows < 2 or not (record.clearances <= 0.0).any()
    ):  # one step is not "at every moment"
        return []
    case = record.case
    standing = [_standing_links(motion) for motion in record.motions]
    poses = link_poses_at(case, record.motions, slice(0, 1))
    touching = []
    for pair in measured_pairs(case)[0]:
        if not all(_stands(case, body, standing) for body in (pair.a, pair.b)):
            continue
        pose_a, pose_b = (body.poses_in(case, poses)[0] for body in (pair.a, pair.b))
        if _touch(pair.a.shape_in(case), pose_a, pair.b.shape_in(case), pose_b):
            touching.append((pair.a.name_in(case), pair.b.name_in(case)))
    return touching


def _stands(case: Case, body: BodyIndex, standing: list[set[str]]) -> bool:
    """True for an obstacle, and for a link that no joint moves."""
    if body.is_obstacle:
        return True
    return case.robots[body.i_robot].robot.bodies[body.i_body].name in standing[body.i_robot]


def links_always_in_contact(record: Record) -> list[tuple[str, str]]:
    """The measured pairs of two links that touch at every step of several."""
    if record.steps.num_rows < 2 or not isinstance(record.contacts, ContactRows):
        return []
    measured, rows = measured_pairs(record.case)[0], record.contacts
    of_links = [i for i, pair in enumerate(measured) if not pair.b.is_obstacle]
    if not of_links or not (record.clearances <= 0.0).any():
        return []
    n_steps = np.bincount(rows.pairs, minlength=len(measured))
    return [rows.names[i] for i in of_links if n_steps[i] == record.steps.num_rows]


def standing_hint(record: Record) -> list[str]:
    """One hint for each kind of such pairs, with the line of the case file that leaves them out."""
    standing = standing_contacts(record)
    links = [pair for pair in links_always_in_contact(record) if pair not in standing]
    return [
        *_hint(standing, "all the time, since the link never moves"),
        *_hint(links, "at every step, link against link"),
    ]


def _hint(pairs: list[tuple[str, str]], when: str) -> Iterator[str]:
    if pairs:
        count = "1 pair touches" if len(pairs) == 1 else f"{len(pairs)} pairs touch"
        line = ", ".join(json.dumps(pair, ensure_ascii=False) for pair in pairs)
        yield f"{count} {when}; where that is meant, add to the case: allow: [{line}]"


def _touch(
    a: Polyhedron, world_from_a: np.ndarray, b: Polyhedron, world_from_b: np.ndarray
) -> bool:
    """True if two bodies touch; balls about their boxes that are apart decide without a search."""
    centres = [pose[:3, :3] @ shape.bounds.mean(axis=0) + pose[:3, 3]
               for shape, pose in ((a, world_from_a), (b, world_from_b))]  # fmt: skip
    radii = [np.linalg.norm(np.ptp(shape.bounds, axis=0)) / 2.0 for shape in (a, b)]
    if np.linalg.norm(centres[0] - centres[1]) > 1.001 * sum(radii):
        return False
    return distance(a, b, pose_a=world_from_a, pose_b=world_from_b).distance <= 0.0


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
