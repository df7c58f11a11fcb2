"""`clearance new --check` on real robots as they lie ends in a report without an edit."""

from __future__ import annotations

import sysconfig
from pathlib import Path

import numpy as np
import pytest

from clearance.cli import run
from clearance.errors import NothingToMeasure
from clearance.formats.motion.trajectory_writer import written
from clearance.formats.robot.request import load_robot
from clearance.world.joint_positions import turns
from clearance.world.trajectory import Trajectory

BROUGHT = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
ROBOTS = {
    "kuka iiwa": "pybullet_data:kuka_iiwa/model.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "human": "human_description/robots/human.urdf",
}
"""By package, or by their place in `example-robot-data`."""

SCENE = """<?xml version="1.0"?>
<sdf version="1.9"><world name="cell"><model name="table"><pose>1.2 0 0.35 0 0 0</pose>
<link name="top"><collision name="c"><geometry><box><size>0.4 1.2 0.7</size></box></geometry></collision></link>
</model></world></sdf>
"""


def motion_of(urdf: str) -> Trajectory:
    """Five positions about the middle of the limits of all joints that turn, a second apart."""
    try:
        robot = load_robot(urdf)
    except NothingToMeasure:
        robot = load_robot(urdf, geometry="visual")
    joints = [joint for joint in robot.moving_joints if turns(joint)]  # grippers and lifts rest
    bounds = np.array([(max(one.lower, -np.pi), min(one.upper, np.pi)) for one in joints])
    middle, half = bounds.mean(axis=1), 0.5 * np.ptp(bounds, axis=1)
    rows = middle + 0.3 * half * np.random.default_rng(7).uniform(-1.0, 1.0, (5, len(joints)))
    return Trajectory(np.arange(5.0), tuple(joint.name for joint in joints), rows)


@pytest.mark.slow  # whole robots, their meshes, and a report each
@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_as_it_lies_ends_in_a_report(tmp_path, capsys, name):
    urdf = ROBOTS[name]
    if ":" not in urdf:
        if not BROUGHT.is_dir():
            pytest.skip("example-robot-data is not installed")
        urdf = str(BROUGHT / urdf)
    (tmp_path / "path.yaml").write_bytes(written(motion_of(urdf), "path.yaml").content)
    (tmp_path / "cell.sdf").write_text(SCENE)
    words = ["--robot", urdf, "--trajectory", str(tmp_path / "path.yaml")]
    words += ["--scene", str(tmp_path / "cell.sdf"), "--check"]
    assert run(["new", str(tmp_path / "case"), *words]) in (0, 1)
    told = capsys.readouterr().out
    assert "assumed   link" in told and ("CLEAR" in told or "CONTACT" in told)
    assert (tmp_path / "case" / "report" / "report.html").is_file()
