"""Pairs that touch all the time because neither of them moves, as an arm's foot and its table: one hint for all.

Not for: pairs that touch for a while, which are what a run looks for.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from clearance.simulate.record import PairMinimum, Record
from clearance.world.case import Case
from clearance.world.mimics import followers
from clearance.world.motion import Motion


def standing_contacts(record: Record) -> list[tuple[str, str]]:
    """(link, obstacle) of the pairs that touch at every moment, since their link never moves."""
    if not (record.clearances <= 0.0).any():
        return []
    standing = _standing_links(record.case, record.motions)
    return [
        (standing[row.link], row.obstacle) for row in _touching(record.pair_minima) if row.link in standing
    ]


def standing_hint(record: Record) -> list[str]:
    """The hint, if there is such a pair, with the line of the case file that leaves them out."""
    pairs = standing_contacts(record)
    if not pairs:
        return []
    count = "1 pair touches" if len(pairs) == 1 else f"{len(pairs)} pairs touch"
    line = ", ".join(json.dumps(pair, ensure_ascii=False) for pair in pairs)
    told = f"{count} all the time, since the link never moves"
    return [f"{told}; where that is meant, add to the case: allow: [{line}]"]


def _touching(minima: Sequence[PairMinimum]) -> list[PairMinimum]:
    """The pairs in contact, which come first; no more of the others are looked at than needed."""
    n_asked = 8
    while True:
        rows = list(minima[:n_asked])
        touching = [row for row in rows if row.clearance <= 0.0]
        if len(touching) < len(rows) or len(rows) < n_asked:
            return touching
        n_asked *= 4


def _standing_links(case: Case, motions: Sequence[Motion]) -> dict[str, str]:
    """The links that no joint moves: as they are called in the record, and by their own names."""
    standing = {}
    for motion in motions:
        robot = motion.placed.robot
        prefix = f"{robot.name}/" if len(case.robots) > 1 else ""
        moved = _moved_joints(motion)
        still = {robot.link_names[0]}
        for joint in robot.joints:
            if joint.parent in still and joint.name not in moved:
                still.add(joint.child)
        standing |= {prefix + name: name for name in still}
    return standing


def _moved_joints(motion: Motion) -> set[str]:
    """The joints that move at any time, those that follow another included."""
    going = np.ptp(motion.positions, axis=0) > 0.0
    if motion.velocities is not None:
        going |= (motion.velocities != 0.0).any(axis=0)
    moving = {name for name, goes in zip(motion.joint_names, going, strict=True) if goes}
    return {one.joint.name for one in followers(motion.placed.robot) if one.master in moving and one.factor}
