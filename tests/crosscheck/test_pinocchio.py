"""A second opinion on self-clearance: Pinocchio reads the same URDF and SRDF, and names the same pairs, once what
random samples never saw to meet is taken as it takes it.
"""

from __future__ import annotations

import sysconfig
from pathlib import Path

import pytest

from clearance.formats.robot.request import load_robot
from clearance.formats.robot.srdf import load_srdf
from clearance.world.collision_matrix import NEVER
from clearance.world.self_pairs import self_pairs

ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"

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


def their_pairs(urdf: str, srdf: str) -> set[frozenset[str]]:
    """The links of all pairs that the SRDF leaves."""
    pin = pytest.importorskip("pinocchio", reason="pin is not installed (pip install .[bench])")
    model = pin.buildModelFromUrdf(urdf)
    folders = [str(ROBOTS.parents[1])]
    geometry = pin.buildGeomFromUrdf(model, urdf, pin.GeometryType.COLLISION, package_dirs=folders)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, srdf)
    links = [model.frames[shape.parentFrame].name for shape in geometry.geometryObjects]
    return {frozenset((links[one.first], links[one.second])) for one in geometry.collisionPairs}


@pytest.mark.parametrize("name", FILES)
def test_the_same_pairs_are_active(name):
    urdf, srdf = (ROBOTS / path for path in FILES[name])
    robot = load_robot(urdf, package_dirs=[ROBOTS.parents[1]])
    matrix = load_srdf(srdf, robot)
    trusting = self_pairs(robot, matrix, trust_never=True)
    active = {frozenset((p.link_a, p.link_b)) for p in trusting if p.excused is None}
    assert active == their_pairs(str(urdf), str(srdf))
    measured = {frozenset((p.link_a, p.link_b)) for p in self_pairs(robot, matrix) if not p.excused}
    never = {frozenset(row[:2]) for row in matrix.disabled if row[2] == NEVER}
    assert measured - active == {pair for pair in measured if pair in never}
    assert measured > active
