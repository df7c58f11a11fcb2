"""A second opinion on self-clearance: Pinocchio reads the same URDF and SRDF, Coal measures.

It names the same pairs, once what random samples never saw to meet is taken as it takes it, and it is as far apart
as we are wherever both bodies are meshes. Its boxes and cylinders are iterated, and our cylinders have facets; to
it meshes are hollow, so that what lies wholly inside another is some way from its surface.
"""

from __future__ import annotations

import sysconfig
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import clearance as cl
from clearance.crosscheck.triangles import is_inside, triangle_soup
from clearance.formats.robot.request import load_robot
from clearance.formats.robot.srdf import load_srdf
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.collision_matrix import NEVER
from clearance.world.forest import link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import BodyIndex, measured_pairs
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.self_pairs import self_pairs
from clearance.world.trajectory import Trajectory

ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
N_POSES = 6

FILES = {
    "panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf"),
    "pr2": ("pr2_description/urdf/pr2.urdf", "pr2_description/srdf/pr2.srdf"),
    "talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf"),
}
"""An arm, two arms on a base, a humanoid."""

pytestmark = [
    pytest.mark.peer,
    pytest.mark.skipif(not ROBOTS.is_dir(), reason="example-robot-data is not installed"),
]


class Opinion(NamedTuple):
    """What Pinocchio made of both files."""

    model: object
    geometry: object
    links: list[str]


@cache
def ours(name: str):
    """The robot and its allowed collision matrix."""
    urdf, srdf = FILES[name]
    robot = load_robot(ROBOTS / urdf, package_dirs=[ROBOTS.parents[1]])
    return robot, load_srdf(ROBOTS / srdf, robot)


@cache
def theirs(name: str) -> Opinion:
    """The model, all pairs that the SRDF leaves, and the link of each shape."""
    pin = pytest.importorskip("pinocchio", reason="pin is not installed (pip install .[bench])")
    urdf, srdf = (str(ROBOTS / path) for path in FILES[name])
    model = pin.buildModelFromUrdf(urdf)
    folders = [str(ROBOTS.parents[1])]
    geometry = pin.buildGeomFromUrdf(model, urdf, pin.GeometryType.COLLISION, package_dirs=folders)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, srdf)
    links = [model.frames[shape.parentFrame].name for shape in geometry.geometryObjects]
    return Opinion(model, geometry, links)


def their_pairs(opinion: Opinion) -> set[frozenset[str]]:
    return {
        frozenset((opinion.links[pair.first], opinion.links[pair.second]))
        for pair in opinion.geometry.collisionPairs
    }


@pytest.mark.parametrize("name", FILES)
def test_the_same_pairs_are_active(name):
    opinion = theirs(name)
    robot, matrix = ours(name)
    trusting = self_pairs(robot, matrix, trust_never=True)
    active = {frozenset((p.link_a, p.link_b)) for p in trusting if p.excused is None}
    assert active == their_pairs(opinion)
    measured = {frozenset((p.link_a, p.link_b)) for p in self_pairs(robot, matrix) if not p.excused}
    never = {frozenset(row[:2]) for row in matrix.disabled if row[2] == NEVER}
    assert measured - active == {pair for pair in measured if pair in never}
    assert measured > active


@pytest.mark.parametrize("name", FILES)
def test_meshes_are_as_far_apart(name):
    opinion = theirs(name)
    robot, matrix = ours(name)
    positions = random_positions(robot)
    times = np.arange(float(N_POSES))
    names = tuple(joint.name for joint in robot.moving_joints)
    asked = SelfClearance(matrix, trust_never=True)
    case = cl.Case(
        name, (PlacedRobot(robot, Trajectory(times, names, positions), self_clearance=asked),), ()
    )
    pairs, _ = measured_pairs(case)
    motions = [kinematic_motion(placed) for placed in case.robots]
    found = measure(PairsInMotion(case, motions, pairs), "pairs", Resources(jobs=1)).every
    poses = link_poses_at(case, motions, slice(None))
    compared = 0
    for step in range(N_POSES):
        answers = their_distances(opinion, robot, positions[step])
        for pair, distance in zip(pairs, found[step], strict=True):
            key = frozenset((pair.a.own_name_in(case), pair.b.own_name_in(case)))
            if key not in answers:
                continue
            if distance == 0.0 and answers[key] > 0.0:
                assert lies_inside(
                    *(placed_shape(case, body, poses[step]) for body in (pair.a, pair.b))
                )
                continue
            assert distance == pytest.approx(answers[key], abs=1e-9), sorted(key)
            compared += distance > 0.0
    assert compared > N_POSES * len(pairs) // 4


def placed_shape(case: cl.Case, body: BodyIndex, link_poses: np.ndarray) -> cl.Polyhedron:
    """A body where it is with the links at (links, 4, 4)."""
    return body.shape_in(case).transformed(body.poses_in(case, link_poses[None])[0])


def lies_inside(one: cl.Polyhedron, other: cl.Polyhedron) -> bool:
    """True if all corners of the one are inside the other, or the other way round."""
    return any(
        is_inside(triangle_soup(outer), inner.vertices).all()
        for inner, outer in ((one, other), (other, one))
    )


def random_positions(robot: cl.Robot) -> np.ndarray:
    """(n, k) anywhere within the limits [rad or m]."""
    random = np.random.default_rng(11)
    lower = [max(joint.lower, -np.pi) for joint in robot.moving_joints]
    upper = [min(joint.upper, np.pi) for joint in robot.moving_joints]
    return random.uniform(lower, upper, (N_POSES, len(lower)))


def their_distances(
    opinion: Opinion, robot: cl.Robot, positions: np.ndarray
) -> dict[frozenset[str], float]:
    """[m] The least of each pair of links all of whose shapes are meshes; 0 where they meet."""
    import pinocchio as pin

    data, geometry_data = opinion.model.createData(), pin.GeometryData(opinion.geometry)
    values = their_positions(opinion.model, robot, positions)
    pin.computeDistances(opinion.model, data, opinion.geometry, geometry_data, values)
    is_mesh = [
        type(shape.geometry).__name__.startswith("BVH")
        for shape in opinion.geometry.geometryObjects
    ]
    plain = {link for link, mesh in zip(opinion.links, is_mesh, strict=True) if not mesh}
    found: dict[frozenset[str], float] = {}
    for pair, reported in zip(
        opinion.geometry.collisionPairs, geometry_data.distanceResults, strict=True
    ):
        key = frozenset((opinion.links[pair.first], opinion.links[pair.second]))
        if plain.isdisjoint(key):
            found[key] = min(found.get(key, np.inf), max(0.0, reported.min_distance))
    return found


def their_positions(model: object, robot: cl.Robot, positions: np.ndarray) -> np.ndarray:
    """Of its joints, by name: one that turns without end has cosine and sine, and followers are free."""
    given = dict(zip((joint.name for joint in robot.moving_joints), positions, strict=True))
    for joint in robot.joints:
        if joint.mimic is not None:
            given[joint.name] = (
                joint.mimic.multiplier * given[joint.mimic.joint] + joint.mimic.offset
            )
    values = np.empty(model.nq)
    for name, joint in zip(list(model.names)[1:], list(model.joints)[1:], strict=True):
        turned = [np.cos(given[name]), np.sin(given[name])] if joint.nq == 2 else [given[name]]
        values[joint.idx_q : joint.idx_q + joint.nq] = turned
    return values
