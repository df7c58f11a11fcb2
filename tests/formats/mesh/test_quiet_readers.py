"""Numbers that overflow, or are no numbers, in files: refused or left out without a warning on the terminal."""

import struct
import warnings

import mujoco  # noqa: F401 - its import starts a process, so it comes before any test
import numpy as np
import pytest

from clearance.errors import BadDimension, BadInput, BadPose
from clearance.formats.cloud.formats import cloud_from_bytes
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from clearance.geometry.pose import pose_from_quaternion
from tests.formats.damaged.meshes import collada
from tests.formats.making_clouds import pcd
from tests.formats.making_mjcf import load_mjcf, mjcf
from tests.formats.refusal import refusal


@pytest.fixture(autouse=True)
def warnings_fail():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def test_a_quaternion_whose_length_overflows():
    with pytest.raises(BadPose, match="has length inf"):
        pose_from_quaternion([0.0, 0.0, 0.0], [1e200, 1e200, 0.0, 0.0])


def test_an_axis_of_a_collada_file_whose_length_overflows():
    with pytest.raises(BadDimension, match="the axis is"):
        mesh_from_bytes(collada().replace(b"<rotate>0 0 1 90", b"<rotate>0 0 1e308 90"), "m.dae")


def test_a_signalling_nan_in_a_scan_is_a_point_left_out():
    data = pcd(np.arange(9.0).reshape(3, 3), "binary")
    signalling = struct.pack("<I", 0x7F800001)
    cloud = cloud_from_bytes(data[:-4] + signalling, "s.pcd", 0.1)
    assert cloud.shape.n_points == 2 and "1 point is not finite" in cloud.notes[0]


def test_an_axis_of_a_mujoco_joint_whose_length_overflows(tmp_path):
    body = '<body><joint name="j" type="slide" axis="1 1e308 0"/><geom size="0.1"/></body>'
    assert "axis" in refusal(load_mjcf, tmp_path, mjcf(body), of=BadInput)
