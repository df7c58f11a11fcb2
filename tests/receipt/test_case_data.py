"""What no receipt is written of is refused in one line."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.receipt.case_data import case_data
from tests.receipt.receipts import turning_arm


def test_half_a_turn_between_two_steps_is_refused():
    times = np.array([0.0, 0.5, 1.0])
    halves = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.1, np.sqrt(0.99)], [0.0, 0.0, 1.0, 0.0]])
    halves[2] = [0.0, 0.0, halves[1, 3], -halves[1, 2]]  # half a turn on from the second
    table = cl.PoseTable(times, np.full((3, 3), 3.0), halves)
    door = cl.Obstacle(cl.Body("door", cl.box((0.1, 0.1, 0.1))), moves=table)
    case = turning_arm()
    moving = cl.Case("door", case.robots, (*case.obstacles, door))
    with pytest.raises(BadInput, match=r"half a turn .* at 0.5 s"):
        case_data(moving)
