"""Notices of links that may be inside an obstacle, or round one, whose surface is too open to tell.

The clearance of such a pair is that of its surfaces: it may be that of a robot that runs inside a solid. Not for:
pairs where a winding number decides (`kernels.containment`); those are in contact in the rows themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.query.distance import distance
from clearance.query.inside import Doubt, doubt_of
from clearance.simulate.steps import pair_names
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.notice import Notice, Severity
from clearance.world.pairs import Pair

AT_ONCE = 1024
"""Steps whose poses are looked at together."""

FEWER = "close the mesh's holes, or accept: [inside] in the case if it is hollow"


def notices(case: Case, motions: Sequence[Motion], pairs: Sequence[Pair]) -> tuple[Notice, ...]:
    """One notice for each pair of which it is open at some step whether one body is inside the other."""
    names = pair_names(case, pairs)
    found = []
    for i, pair in enumerate(pairs):
        doubt = doubt_of(*_shapes(case, pair))
        if doubt is not None:
            step = next(_steps_in_doubt(case, motions[pair.i_robot], pair, doubt), None)
            if step is not None:
                time = motions[0].times[step]
                found.append(Notice(Severity.SUSPECT, "inside", _text(names[0][i], names[1][i], step, time)))
    return tuple(found)


def _text(link: str, obstacle: str, step: int, time: float) -> str:
    return (
        f"link {link} may be inside obstacle {obstacle}, or round it, at {time:.3f} s (step {step}): the surface has "
        f"holes, so that inside and outside cannot be told there, and the clearance is that of the surfaces alone; "
        f"{FEWER}"
    )


def _shapes(case: Case, pair: Pair) -> tuple[Polyhedron, Polyhedron]:
    body = case.robots[pair.i_robot].robot.bodies[pair.i_body]
    return body.shape, case.obstacles[pair.i_obstacle].body.shape


def _steps_in_doubt(case: Case, motion: Motion, pair: Pair, doubt: Doubt) -> Iterator[int]:
    """The steps at which a pair is in doubt and not in contact."""
    link, obstacle = _shapes(case, pair)
    world_from_obstacle = case.obstacles[pair.i_obstacle].world_from_body
    robot = motion.placed.robot
    i_link = robot.link_names.index(robot.bodies[pair.i_body].name)
    for start in range(0, motion.n_steps, AT_ONCE):
        poses = motion.poses(start, min(start + AT_ONCE, motion.n_steps))[:, i_link]
        standing = np.broadcast_to(world_from_obstacle, poses.shape).copy()
        for k in np.flatnonzero(doubt.at(poses.copy(), standing)):
            if not distance(link, obstacle, pose_a=poses[k], pose_b=world_from_obstacle).contact:
                yield start + int(k)
