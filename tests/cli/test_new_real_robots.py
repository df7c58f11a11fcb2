"""`clearance new --check` on a real robot as it lies ends in a report without an edit."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.cli import run
from clearance.formats.motion.trajectory_writer import written
from clearance.formats.robot.request import load_robot
from clearance.world.trajectory import Trajectory

ROBOT = "pybullet_data:kuka_iiwa/model.urdf"
SCENE = """<?xml version="1.0"?>
<sdf version="1.9"><world name="cell"><model name="table"><pose>1.2 0 0.35 0 0 0</pose>
<link name="top"><collision name="c"><geometry><box><size>0.4 1.2 0.7</size></box></geometry></collision></link>
</model></world></sdf>
"""


@pytest.mark.slow  # a whole robot, its meshes, and a report
def test_a_robot_as_it_lies_ends_in_a_report(tmp_path, capsys):
    names = tuple(joint.name for joint in load_robot(ROBOT).moving_joints)
    positions = np.random.default_rng(7).uniform(-0.6, 0.6, (5, len(names)))
    motion = Trajectory(np.arange(5.0), names, positions)
    (tmp_path / "path.yaml").write_bytes(written(motion, "path.yaml").content)
    (tmp_path / "cell.sdf").write_text(SCENE)
    words = ["--robot", ROBOT, "--trajectory", str(tmp_path / "path.yaml")]
    words += ["--scene", str(tmp_path / "cell.sdf"), "--check"]
    assert run(["new", str(tmp_path / "case"), *words]) in (0, 1)
    told = capsys.readouterr().out
    assert "assumed   link" in told and ("CLEAR" in told or "CONTACT" in told)
    assert (tmp_path / "case" / "report" / "report.html").is_file()
