"""Joints and shapes of whole robots as yourdfpy reads them."""

from pathlib import Path

import numpy as np
import pytest
import yourdfpy

from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.robot.urdf.elements import numbers, pose_of
from clearance.formats.robot.urdf.joints import joints_of
from tests.formats.making_urdf import parse_document

pytestmark = pytest.mark.peer

ROOT = Path(__file__).parents[3]
OURS = sorted((ROOT / "robots").rglob("*.urdf"))
BROUGHT = ["pybullet_data:kuka_iiwa/model.urdf", "pybullet_data:franka_panda/panda.urdf",
           "pybullet_data:pr2_gripper.urdf", "pybullet_data:r2d2.urdf"]  # fmt: skip


def paths():
    return [*OURS, *(resolved(name, ROOT) for name in BROUGHT)]


@pytest.mark.parametrize("path", paths(), ids=lambda path: path.stem)
def test_joints_are_the_same(path):
    joints, _ = joints_of(parse_document(InputFiles(ROOT).read(path)))
    model = yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot
    assert [joint.name for joint in joints] == [joint.name for joint in model.joints]
    for ours, theirs in zip(joints, model.joints, strict=True):
        assert (ours.kind.value, ours.parent, ours.child) == (
            theirs.type,
            theirs.parent,
            theirs.child,
        )
        origin = np.eye(4) if theirs.origin is None else theirs.origin
        np.testing.assert_allclose(ours.parent_from_joint, origin, rtol=0, atol=4e-16)
        if theirs.type != "fixed":
            axis = np.asarray(theirs.axis, dtype=float)
            np.testing.assert_allclose(ours.axis, axis / np.linalg.norm(axis), rtol=0, atol=4e-16)
        if theirs.type in ("revolute", "prismatic") and theirs.limit.lower is not None:
            assert (ours.lower, ours.upper) == (theirs.limit.lower, theirs.limit.upper)
        assert (ours.mimic is None) == (theirs.mimic is None)
        if ours.mimic is not None:
            for number in ("joint", "multiplier", "offset"):
                assert getattr(ours.mimic, number) == getattr(theirs.mimic, number)


@pytest.mark.parametrize("path", paths(), ids=lambda path: path.stem)
@pytest.mark.parametrize("geometry", ["collision", "visual"])
def test_shapes_are_the_same(path, geometry):
    root = parse_document(InputFiles(ROOT).read(path))
    model = yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot
    for ours, theirs in zip(root.iterfind("link"), model.links, strict=True):
        elements, others = ours.findall(geometry), getattr(theirs, f"{geometry}s")
        for element, other in zip(elements, others, strict=True):
            origin = np.eye(4) if other.origin is None else other.origin
            np.testing.assert_allclose(pose_of(element), origin, rtol=0, atol=4e-16)
            shape = element.find("geometry")[0]
            given = getattr(other.geometry, shape.tag)
            for attribute in ("size", "radius", "length", "scale"):
                if shape.get(attribute) is not None:
                    np.testing.assert_array_equal(
                        numbers(shape, attribute), np.atleast_1d(getattr(given, attribute))
                    )
            if shape.tag == "mesh":
                assert shape.get("filename") == given.filename
