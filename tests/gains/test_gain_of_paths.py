"""Paths that a table of samples cannot say: quintics become the cubics that are written, holes are refused."""

from dataclasses import replace

import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.folder import save_gain
from clearance.world.notice import NOT_MEASURED
from clearance.world.trajectory import Hole
from tests.simulate.measure.test_quintic_motion import there_and_back


def test_a_path_with_accelerations_is_written_as_the_cubics_that_were_measured(tmp_path):
    """The cart keeps 0.2 m where 0.21 are needed."""
    there_and_back(tmp_path)
    found = cl.gain(tmp_path / "case.yaml", "waypoints")
    assert found.kept
    again = cl.check(save_gain(found, tmp_path / "out") / "case.yaml")
    assert again.verdict.passed and again.record.timeline.path_error == 0.0


@pytest.mark.parametrize(("kind", "how"), [("waypoints", {}), ("base", {"tool_path": "kept"})])
def test_a_recording_with_holes_is_not_changed(tmp_path, kind, how):
    case = there_and_back(tmp_path)
    (placed,) = case.robots
    holes = (Hole(("rail",), 0.2, 0.3, 0.01, NOT_MEASURED),)
    moved = replace(placed, trajectory=replace(placed.given_trajectory, holes=holes))
    with pytest.raises(BadInput, match="the recording of robot 'cart' has holes"):
        cl.gain(replace(case, robots=(moved,)), kind, **how)
