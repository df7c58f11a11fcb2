"""`clearance new --check` on real robots as they lie ends in a report without an edit."""

import pytest

from clearance.cli import run
from scripts.bench.new_cases import BROUGHT, ROBOTS, words_of

BY_NAME = {robot.name: robot for robot in ROBOTS}


@pytest.mark.slow  # whole robots, their meshes, and a report each
@pytest.mark.parametrize("name", ["kuka iiwa", "franka", "panda", "human"])
def test_a_robot_as_it_lies_ends_in_a_report(tmp_path, capsys, name):
    robot = BY_NAME[name]
    if ":" not in robot.urdf and not BROUGHT.is_dir():
        pytest.skip("example-robot-data is not installed")
    words, _ = words_of(robot, tmp_path)
    assert run(["new", str(tmp_path / "case"), *words, "--check"]) in (0, 1)
    told = capsys.readouterr().out
    assert "assumed   link" in told and ("CLEAR" in told or "CONTACT" in told)
    assert (tmp_path / "case" / "report" / "report.html").is_file()
