"""What holds of the knots of every motion that is swept, whatever its joints move on."""

import numpy as np

from clearance.profiles.chain import chain_of
from clearance.profiles.chords import knots_of
from clearance.profiles.plane import Plane
from clearance.world.kinematics import link_poses


def assert_within_chord_and_turn(case, motion, positions_at, slack):
    """Points of the second link stay as near their chords, and the view turns as little, as the knots say.

    Args:
        positions_at: gives the joints' positions at instants.
        slack: [m] rounding.
    """
    plane, body = Plane.of("xz"), case.robots[0].robot.bodies[1]
    knots = knots_of(chain_of(case, (motion,), 2), body.shape, plane, 1.0, solid=False)
    for k in range(len(knots.chord)):
        share = np.linspace(0.0, 1.0, 21)
        instants = knots.instant[k] + share * (knots.instant[k + 1] - knots.instant[k])
        poses = link_poses(case.robots[0], positions_at(instants))[:, 2]
        path = plane.coordinates(
            body.shape.vertices @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
        )
        chord = path[0] + share[:, None, None] * (path[-1] - path[0])
        off = np.sqrt(((path - chord) ** 2).sum(axis=2)).max()
        assert off <= knots.chord[k] * (1 + 1e-12) + slack
        toward = poses[:, :3, :3].transpose(0, 2, 1) @ np.cross(*plane.axes)
        assert np.arccos(np.clip(toward @ toward[10], -1, 1)).max() <= knots.turn[k] + 1e-7
