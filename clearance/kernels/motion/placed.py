"""The poses of the bodies, each at its last visit, and their motion up to then.

Not for: which bodies need a visit (`schedule`), and their motion between the steps (`joint_motion_bound`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.features.bounds import displacement
from clearance.kernels.motion.kinematics import NO_PARENT, copy_pose, place_links

GROWTH = 1.0 + 1e-9
"""Covers the rounding of a sum of up to four million displacements."""


class PlacedBodies(NamedTuple):
    """The poses at the last visit of each body.

    Attributes:
        links: (links, 4, 4) `world_from_link` [m] of the links wanted at the last visit.
        wanted: (links,) the last visit at which each was wanted, or -1.
        poses: (bodies, 4, 4) `world_from_body` [m].
        moves: (bodies,) how often its pose has changed.
        visits: (bodies,) how often it was visited after the first time.
    """

    links: Floats3
    wanted: Integers
    poses: Floats3
    moves: Integers
    visits: Integers


@inline
def new_placed_bodies(n_links, n_bodies):
    """Bodies without poses yet."""
    return PlacedBodies(
        np.empty((n_links, 4, 4)), np.full(n_links, -1), np.empty((n_bodies, 4, 4)),
        np.zeros(n_bodies, dtype=np.int64), np.zeros(n_bodies, dtype=np.int64),
    )  # fmt: skip


@inline(force=True)
def _want(links, link, visit, wanted):
    """Marks a link and all above it."""
    while link != NO_PARENT and wanted[link] != visit:
        wanted[link] = visit
        link = links.parents[link]


@inline(force=True)
def _has_moved(before, after):
    """True if two (4, 4) poses are not the same to the last bit of each number."""
    for i in range(3):
        for k in range(4):
            if before[i, k] != after[i, k]:
                return True
    return False


@inline
def put_all(world, positions, placed):
    """Places every body with the joints at `positions` (columns,); this is visit 0."""
    for body in range(len(world.frames)):
        _want(world.links, world.frames[body], 0, placed.wanted)
    place_links(world.links, positions, placed.links, placed.wanted, 0)
    for body in range(len(world.frames)):
        frame = world.frames[body]
        pose = placed.links[frame] if frame >= 0 else world.standing[body]
        copy_pose(pose, placed.poses[body])


@inline(force=True)
def bring(surface, world, bodies, positions, visit, placed, moved):
    """Places `bodies`, all carried by links, with the joints at `positions` (columns,).

    Args:
        moved: (bodies,) [m] total motion of each, increased.
    """
    for body in bodies:
        _want(world.links, world.frames[body], visit, placed.wanted)
    place_links(world.links, positions, placed.links, placed.wanted, visit)
    for body in bodies:
        before, after = placed.poses[body], placed.links[world.frames[body]]
        placed.visits[body] += 1
        if _has_moved(before, after):
            placed.moves[body] += 1
            moved[body] += (
                displacement(surface, surface.roots[world.solids[body]], before, after) * GROWTH
            )
            copy_pose(after, before)
