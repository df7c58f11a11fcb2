"""MJCF as a scene: what stands becomes obstacles, and what could move is told."""

import re

import numpy as np
import pytest

from clearance.errors import BadInput
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import SceneRequest, read_scene
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from tests.formats.making_mjcf import BALL, mjcf, write_mjcf
from tests.formats.refusal import refusal


def scene(folder, text: str, **files):
    """The obstacles of a model by name, and what is told of it."""
    asked = SceneRequest(write_mjcf(folder, text, **files), InputFiles(folder))
    content = read_scene(asked)
    given = validated(Scene, content.scene, "toy.xml")
    obstacles, _ = make_obstacles(given.obstacles, folder, MeshStore(asked.files))
    return {obstacle.name: obstacle for obstacle in obstacles}, content


WORLD = mjcf(
    '<geom name="floor" type="plane" size="0 0 1"/>'
    '<body name="table" pos="1 0 0" euler="0 0 90"><geom name="top" type="box" size="0.5 0.25 0.1" pos="0 0 0.7"/>'
    '<geom size="0.1" contype="0" conaffinity="0"/><geom type="ellipsoid" size="0.1 0.2 0.3"/>'
    '<body name="on" pos="0.1 0 0"><geom type="mesh" mesh="a"/><geom type="mesh" mesh="turned"/></body></body>'
    f'<body name="cube" pos="3 0 0"><freejoint/>{BALL}</body>',
    '<asset><mesh file="a.stl" scale="0.1 0.1 0.1"/>'
    '<mesh name="turned" file="a.stl" scale="0.1 0.2 0.3" refquat="0.5 0.5 0.5 0.5" refpos="1 0 0"/></asset>',
)


def corners(obstacle) -> np.ndarray:
    pose = obstacle.world_from_body
    return obstacle.body.shape.vertices @ pose[:3, :3].T + pose[:3, 3]


def test_each_geom_that_collides_is_an_obstacle_where_it_stands(tmp_path):
    found, content = scene(tmp_path, WORLD)
    assert [*found] == ["floor", "table/top", "table/geom2", "on/geom0", "on/geom1", "cube/geom0"]
    top = corners(found["table/top"])
    np.testing.assert_allclose(top.min(axis=0), [0.75, -0.5, 0.6], rtol=0, atol=1e-12)
    np.testing.assert_allclose(top.max(axis=0), [1.25, 0.5, 0.8], rtol=0, atol=1e-12)
    assert (
        corners(found["floor"])[:, 2].max() == 0.0 and corners(found["floor"])[:, 2].min() == -20.0
    )
    np.testing.assert_allclose(
        corners(found["on/geom0"]).max(axis=0), [1, 0.2, 0.09], rtol=0, atol=1e-6
    )
    assert content.notes == (
        "toy.xml: 1 geoms that collide with nothing (contype, conaffinity) are left out",
        "toy.xml: planes are boxes 40 m wide and 20 m deep below them: 'floor'",
    )
    (notice,) = content.notices
    assert (
        notice.text.startswith("bodies on joints stand where the file has them")
        and "'cube'" in notice.text
    )


def test_a_mesh_that_the_model_turns_is_turned_and_then_scaled(tmp_path):
    found, _ = scene(tmp_path, WORLD)
    tetrahedron = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.3, 0.9]]) - [1, 0, 0]
    turned = tetrahedron[:, [1, 2, 0]] * [
        0.1,
        0.2,
        0.3,
    ]  # (x, y, z) goes back from where z, x, y went
    ours = found["on/geom1"].body.shape.vertices
    np.testing.assert_allclose(
        sorted(map(tuple, ours.round(9).tolist())),
        sorted(map(tuple, turned.round(9).tolist())),
        atol=1e-8,
    )


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (mjcf('<geom size="0.1" contype="0" conaffinity="0"/>'), "none of its geoms collides"),
        (mjcf("<geom size='1'/>", '<compilr angle="radian"/>'), "<compilr> is no section.*did you mean"),
        (mjcf("<geom size='1'/>", '<option><flag filterparnt="enable"/></option>'), "did you mean filterparent="),
        (mjcf("<geom size='1'/>", '<keyframe><key qpso="1"/></keyframe>'), "MuJoCo refuses it.*'qpso'"),
        (mjcf('<geom type="hfield" hfield="h"/>', '<asset><hfield file="h.png" size="1 1 1 1"/></asset>'),
         "a hfield is not read: its surface is a grid of heights"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_scene_is_refused(tmp_path, text, says):
    assert re.search(says, refusal(scene, tmp_path, text, of=BadInput))


def test_a_mocap_body_that_collides_is_warned_of_as_bodies_on_joints_are(tmp_path):
    target = '<body name="target" mocap="true"><geom size="1" contype="0" conaffinity="0"/></body>'
    cart = f'<body name="cart" mocap="true"><body name="top">{BALL}</body></body>'
    _, content = scene(tmp_path, mjcf(target + cart))
    (notice,) = content.notices
    assert (
        notice.text
        == "mocap bodies stand where the file has them, with all that is on them: 'cart'"
    )
