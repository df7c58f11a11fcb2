"""Sweeps sampled far finer than the package does, with positions between the steps by scipy."""

import numpy as np
import pytest

import clearance as cl
from clearance.world.kinematics import link_poses
from clearance.world.motion import kinematic_motion
from clearance.world.robot import JointKind
from tests.profiles.moving import joint, moved, shifted, tetrahedron

shapely = pytest.importorskip("shapely")


def assert_within_chord_and_turn(knots, shape, plane, poses_at, slack):
    """Points of a body stay as near their chords, and the view turns as little, as the knots say.

    Args:
        poses_at: gives the body's poses at instants.
        slack: [m] rounding.
    """
    share = np.linspace(0.0, 1.0, 21)
    for k in range(len(knots.chord)):
        poses = poses_at(knots.instant[k] + share * (knots.instant[k + 1] - knots.instant[k]))
        turned = poses[:, :3, :3].transpose(0, 2, 1)
        path = plane.coordinates(shape.vertices @ turned + poses[:, None, :3, 3])
        chord = path[0] + share[:, None, None] * (path[-1] - path[0])
        off = np.linalg.norm(path - chord, axis=2).max()
        assert off <= knots.chord[k] * (1 + 1e-12) + slack
        toward = turned @ np.cross(*plane.axes)
        assert np.arccos(np.clip(toward @ toward[10], -1, 1)).max() <= knots.turn[k] + 1e-7


def interpolated(motion, instants):
    """(k, joints) positions at instants in steps: lines, or the cubics that have the velocities at both ends."""
    from scipy.interpolate import CubicHermiteSpline

    steps = np.arange(motion.n_steps, dtype=float)
    if motion.velocities is None:
        return np.stack(
            [np.interp(instants, steps, column) for column in motion.positions.T], axis=1
        )
    times = np.interp(instants, steps, motion.times)
    return CubicHermiteSpline(motion.times, motion.positions, motion.velocities)(times)


def strays(profile, truth):
    """[m] greatest distance of the profile's outline from a region of shapely."""
    points = np.concatenate([contour.flattened(1e-6) for contour in profile.contours])
    return float(shapely.distance(truth, shapely.points(points)).max())


def finely_swept(case, plane, parts):
    """Unions of all projected triangles at every step and `parts` - 1 instants in between: of what is
    there at these instants, and of the hulls from each to the next."""
    motion = kinematic_motion(case.robots[0])
    instants = np.linspace(0, motion.n_steps - 1, (motion.n_steps - 1) * parts + 1)
    poses = link_poses(case.robots[0], interpolated(motion, instants))
    names = case.robots[0].robot.link_names
    at, between = [], []
    for body in case.robots[0].robot.bodies:
        corners = body.shape.vertices[body.shape.triangles()]
        turned = poses[:, None, None, names.index(body.name)]
        world = np.einsum("ktcij,tcj->ktci", turned[..., :3, :3], corners) + turned[..., :3, 3]
        seen = plane.coordinates(world)
        at.append(shapely.polygons(seen).ravel())
        six = np.concatenate([seen[:-1], seen[1:]], axis=2)
        between.append(shapely.convex_hull(shapely.multipoints(six)).ravel())
    return shapely.unary_union(np.concatenate(at)), shapely.unary_union(np.concatenate(between))


def sweeps(seed, bent=False):
    """A random chain of two moving links; `bent`: with velocities that have little to do with the positions."""
    rng = np.random.default_rng(seed)
    kinds = [JointKind.REVOLUTE, rng.choice([JointKind.REVOLUTE, JointKind.PRISMATIC])]
    axes = rng.normal(size=(2, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    joints = [joint(i, JointKind(kinds[i]), axes[i], rng.uniform(-0.3, 0.3, 3)) for i in range(2)]
    shapes = {
        1: shifted(cl.box(rng.uniform(0.02, 0.8, 3)), rng.uniform(-0.3, 0.3, 3)),
        2: tetrahedron(rng, 0.3),
    }
    positions = np.cumsum(rng.uniform(-0.5, 0.5, (3, 2)), axis=0)
    return rng, moved(joints, shapes, positions, rng.uniform(-1.0, 1.0, (3, 2)) if bent else None)
