"""What is bounded for linear joint motion refuses a trajectory with velocities, in one line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.swept_pieces import swept_pieces

CASE = Path(__file__).parents[2] / "scenes" / "box_pipe" / "case.yaml"


def moving_on_cubics():
    motion = kinematic_motion(cl.load_case(CASE).robots[0])
    return replace(motion, velocities=np.zeros_like(motion.positions))


def test_a_shared_workspace_is_refused():
    with pytest.raises(BadInput, match="not on cubics"):
        swept_pieces(moving_on_cubics(), 0.01)
