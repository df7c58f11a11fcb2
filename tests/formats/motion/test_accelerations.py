"""Accelerations of a JointTrajectory: followed, refused without velocities, and written as they were read."""

import numpy as np
import pytest

from clearance.errors import MissingKey
from clearance.formats.motion.trajectory_file import parse_trajectory
from clearance.formats.motion.trajectory_writer import written
from clearance.world.cubic import positions_along
from tests.formats.making_messages import POINTS, dumped, with_points


def test_accelerations_without_velocities_are_refused():
    points = [
        {key: value for key, value in point.items() if key != "velocities"}
        | {"accelerations": [0, 1]}
        for point in POINTS
    ]
    with pytest.raises(MissingKey, match="points: accelerations without velocities; velocities in"):
        parse_trajectory(dumped(with_points(*points)).encode(), "path.json")


def test_accelerations_of_zero_are_followed_and_not_left_out():
    """From 0 to 1 in 1 s, at rest and unaccelerated at both ends: 10 s^3 - 15 s^4 + 6 s^5."""
    rest = {"velocities": [0, 0], "accelerations": [0, 0]}
    points = [{"positions": [i, 0], "time_from_start": i, **rest} for i in range(2)]
    found = parse_trajectory(dumped(with_points(*points)).encode(), "path.json")
    s = np.array([0.1, 0.25, 0.5, 0.9])
    right = 10 * s**3 - 15 * s**4 + 6 * s**5
    assert positions_along(found, s)[:, 0] == pytest.approx(right, abs=1e-8)
    assert 0.0 < found.path_error <= 1.01e-8


@pytest.mark.parametrize("name", ["out.yaml", "out.json"])
def test_points_with_accelerations_are_written_as_they_were_read(name):
    points = [{**point, "accelerations": [0.1, -1e-3 / 3]} for point in POINTS]
    asked = parse_trajectory(dumped(with_points(*points)).encode(), "path.json")
    back = parse_trajectory(written(asked, name).content, name)
    for key in ("times", "positions", "velocities", "accelerations"):
        assert (getattr(back.points, key) == getattr(asked.points, key)).all()
    assert (back.positions == asked.positions).all() and back.path_error == asked.path_error
    table = parse_trajectory(written(asked, "out.csv").content, "out.csv")
    assert (table.positions == asked.positions).all() and table.points is None
