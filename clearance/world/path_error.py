"""The effect on clearances of joints off their path. Not for: how far they are off (`quintic`), or tolerances."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from clearance.world.case import Case
from clearance.world.joint_positions import turns
from clearance.world.mimics import followers
from clearance.world.motion import Motion
from clearance.world.reach import farthest_reach, length_of_robot

ROOT_3 = 3.0**0.5


def path_error_of(case: Case, motions: Sequence[Motion]) -> float:
    """[m] The most that the clearance of any pair can be below its value along the cubics of the motions.

    A joint that is off by an angle moves each point below it by at most the angle times its distance. A carried
    part has the joint errors of the grasp, of now, or of the release.

    Exactness: an upper bound: no point is farther from a joint than its robot is long or, where robots carry
        others, than the cell is wide, and a part than that from each that has carried it.
    """
    if not any(_error(motion) for motion in motions):
        return 0.0
    given = [placed.mount for placed in case.robots] + [one.mount for one in case.obstacles]
    mounts = [mount for mount in given if mount is not None]
    n_holds = 1 + 2 * _most_carries(case, {mount.on for mount in mounts})
    if case.carries or mounts:
        longest = [2.0 * ROOT_3 * farthest_reach(case, motions) * n_holds] * len(motions)
    else:
        longest = [length_of_robot(motion) for motion in motions]
    moved = sum(map(_moved, motions, longest))
    return float(
        moved * n_holds * (1.0 + 1e-3)
    )  # the path itself is within a thousandth of these lengths


def _most_carries(case: Case, bearing: set[str]) -> int:
    """How often a part is carried; where parts bear or carry others (`bearing`: names), all count for each."""
    times = Counter(one.part for one in case.carries)
    if times.keys() & (bearing | {one.by for one in case.carries}):
        return times.total()
    return max(times.values(), default=0)


def _error(motion: Motion) -> float:
    """[rad or m] Simulated motion is no path of a table."""
    asked = motion.placed.trajectory
    return 0.0 if asked is None or motion.velocities is None else asked.path_error


def _moved(motion: Motion, longest: float) -> float:
    """[m] How far all joints of a robot together move any point that is no farther than the longest from them."""
    named = () if motion.placed.trajectory is None else motion.placed.trajectory.joint_names
    ways = (
        abs(one.factor) * (longest if turns(one.joint) else 1.0)
        for one in followers(motion.placed.robot)
        if one.master in named
    )
    return _error(motion) * float(np.sum([*ways]))
