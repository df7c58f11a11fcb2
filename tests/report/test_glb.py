"""The GLB of the worst moment, read back by our own reader and by trimesh: names, places, y up, the line."""

import io
import json
import struct

import numpy as np
import pytest

from clearance.report.glb import glb_of
from clearance.report.still import still_of
from tests.report.made import replay_of
from tests.report.records import record

RUN = record()
REPLAY = replay_of(RUN)
DATA = glb_of(RUN, REPLAY)


def document() -> dict:
    (length,) = struct.unpack("<I", DATA[12:16])
    return json.loads(DATA[20 : 20 + length])


def test_it_is_the_same_each_time_and_as_long_as_it_says():
    assert glb_of(RUN, replay_of(RUN)) == DATA
    magic, version, length = struct.unpack("<4sII", DATA[:12])
    assert (magic, version, length) == (b"glTF", 2, len(DATA)) and length % 4 == 0


def test_nodes_are_the_bodies_and_the_line():
    nodes = document()["nodes"]
    names = [nodes[i]["name"] for i in nodes[0]["children"]]
    assert names[:-1] == [body.name for body in REPLAY.bodies] and names[-1] == "witness line"
    extras = next(node for node in nodes if node["name"] == "witness line")["extras"]
    assert extras["clearance"] == RUN.worst.clearance
    assert extras["points"] == [list(RUN.worst.point_link), list(RUN.worst.point_obstacle)]
    assert extras["status"] == "contact" and extras["bodies"] == [
        RUN.worst.link,
        RUN.worst.obstacle,
    ]


def test_trimesh_finds_names_places_and_colours():
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(io.BytesIO(DATA), file_type="glb")
    still = still_of(REPLAY)
    y_up = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    for body in still.bodies:
        pose, name = scene.graph[body.name]
        assert np.abs(pose - y_up @ body.pose).max() < 1e-6
        assert len(scene.geometry[name].faces) == len(still.shapes[body.i_shape][1])
        assert scene.geometry[name].visual.material.baseColorFactor[3] == round(255 * body.opacity)
    for side, end in zip(("first", "second"), still.line, strict=True):
        pose, _ = scene.graph[f"witness line: {side} point"]
        assert np.abs(pose[:3, 3] - y_up[:3, :3] @ end).max() < 1e-6


def test_a_shape_that_two_bodies_have_is_written_once():
    held = document()
    assert len(held["accessors"]) == len(held["bufferViews"]) <= 2 * len(REPLAY.shapes) + 4
    assert held["buffers"][0]["byteLength"] == sum(
        view["byteLength"] for view in held["bufferViews"]
    )
