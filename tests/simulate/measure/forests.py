"""The links of robots as a sweep takes them, and how far they move by their columns alone."""

from dataclasses import replace

import numpy as np

from clearance.kernels.motion.interval_motion_bound import (
    fill_motion_radii,
    interval_motion_bound_of,
)
from clearance.world.case import Case
from clearance.world.forest import forest_of


def links_of(placed):
    """The links of some placed robots behind one another."""
    named = [
        replace(one, robot=replace(one.robot, name=f"robot_{i}")) for i, one in enumerate(placed)
    ]
    return forest_of(Case("forest", tuple(named), ())).links


def ways_in(surface, world, positions):
    """(k,) [m] the bound on the motion of the first body from the first step to each."""
    radii, noise = np.empty((len(world.frames), positions.shape[1])), np.empty(len(world.frames))
    fill_motion_radii(surface, world, positions, radii, noise)
    steps = range(len(positions))
    return np.array(
        [interval_motion_bound_of(positions, 0, step, radii[0], noise[0]) for step in steps]
    )
