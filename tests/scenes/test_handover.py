"""The hands of `dual_arm_handover` really have the bar that they carry."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from tests.golden.exact_places import Places

CASE = Path(__file__).parents[2] / "scenes" / "dual_arm_handover" / "case.yaml"
HANDS = [("left", "3.0"), ("left", "7.6"), ("right", "7.6"), ("right", "12.0")]


@pytest.fixture(scope="module")
def case() -> cl.Case:
    return cl.load_case(CASE)


def pose(places: Places, name: str, time: str) -> np.ndarray:
    return np.vstack([np.array(places.of(name, Fraction(float(time))), dtype=float), [0, 0, 0, 1]])


@pytest.mark.parametrize(("side", "time"), HANDS)
def test_both_fingers_are_at_the_bar(case: cl.Case, side: str, time: str) -> None:
    places = Places(case)
    arm = next(placed.robot for placed in case.robots if placed.robot.name == side)
    bar = next(one.body.shape for one in case.obstacles if one.name == "workpiece")
    for body in arm.bodies:
        if body.name.endswith("finger"):
            poses = {
                "pose_a": pose(places, f"{side}/{body.name}", time),
                "pose_b": pose(places, "workpiece", time),
            }
            assert cl.distance(body.shape, bar, **poses).distance < 3e-4


def test_the_bar_lies_on_the_tray(case: cl.Case) -> None:
    places = Places(case)
    tray = next(one.body.shape for one in case.obstacles if one.name == "tray")
    bar = next(one.body.shape for one in case.obstacles if one.name == "workpiece")
    for time in ("12.0", "15.2"):
        poses = {"pose_a": pose(places, "tray", time), "pose_b": pose(places, "workpiece", time)}
        assert 0.0 < cl.distance(tray, bar, **poses).distance < 1e-3
