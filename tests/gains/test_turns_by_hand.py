"""Shifts with a turn, and within a box, whose least is known by hand."""

import numpy as np
import pytest

import clearance as cl
from clearance.gains.turn import ARM, Pivot, Turn
from tests.gains.gantries import along_x, gantry, slot, standing


def beside_a_bar(angle):
    """A block goes along x at y = 0; the face of a long bar is 0.05 before it, less at one end by its angle."""
    bar = standing("bar", cl.box((2.0, 0.2, 0.2)), (0.0, 0.2, 0.0))
    c, s = np.cos(angle), np.sin(angle)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    pose = bar.world_from_body.copy()
    pose[:3, :3] = turned
    pose[:3, 3] = (-0.1 * s, 0.1 + 0.1 * c, 0.0)  # the middle of its face stays
    path = along_x(gantry(), start=-0.9, end=0.9)
    return cl.Case("bar", (path,), (cl.Obstacle(bar.body, pose),), cl.Limits(fail=0.045))


@pytest.mark.parametrize("angle", [0.02, -0.03])
def test_a_bar_is_turned_to_where_it_was_straight(angle):
    case = beside_a_bar(angle)
    turn = Turn("z", about=(0.0, 0.1, 0.0))
    found = cl.gain(case, "obstacle", within=(0.0, 0.0, 0.0), turn=turn)
    assert found.kept and found.change[:3] == pytest.approx(np.zeros(3), abs=1e-12)
    left = found.change[3] + angle  # a corner of the block at 0.95 is 0.045 before the face
    gap = 0.05 * np.cos(left) - 0.95 * np.sin(abs(left))
    assert np.sign(left) == np.sign(angle) and gap == pytest.approx(0.045, abs=2e-6)
    assert found.size == pytest.approx(ARM * abs(found.change[3]))
    assert 0.0 < found.lower_bound <= found.size


def test_a_turn_and_a_shift_share_what_is_missing():
    case = beside_a_bar(0.02)
    shifted, turned = (cl.gain(case, "obstacle", turn=turn) for turn in (None, "z"))
    assert turned.kept and turned.size < 0.75 * shifted.size and np.all(turned.change[[1, 3]])


def test_what_is_kept_already_is_not_turned():
    found = cl.gain(slot(fail=0.01), "obstacle", obstacle="left", turn="z")
    assert found.kept and found.size == 0.0 and not found.change.any()


def test_the_gradient_of_a_turn_is_that_of_points():
    rng = np.random.default_rng(3)
    pose = np.eye(4)
    pose[:3, 3] = rng.normal(size=3)
    pivot = Pivot(Turn("y", (0.3, -0.2, 0.5)), pose)
    x, step = np.array([0.1, 0.2, -0.1, 0.3]), np.array([0.0, 0.0, 0.0, 1e-6])
    point = np.append(rng.normal(size=3), 1.0)
    here, there = (pivot.moved(x + side * step) @ point for side in (-1, 1))
    now = pivot.moved(x)
    by_unit = pivot.by_unit((now @ point)[None, :3], now)[0]
    assert by_unit == pytest.approx((there - here)[:3] / 2e-6, abs=1e-8)


def test_a_base_is_turned():
    case = beside_a_bar(0.02)
    found = cl.gain(case, "base", within=(0.0, 0.001, 0.0), turn="z")
    assert found.kept and found.change[3] > 0.0 and found.after.passed
    assert found.size < cl.gain(case, "base").size


def test_a_box_is_kept_and_what_is_beyond_it_is_said():
    found = cl.gain(slot(), "base", within=(0.001, 0.019, 0.001))
    assert (
        not found.kept and found.n_measured == 1 and "within what is allowed" in str(found.blocked)
    )
    assert cl.gain(slot(), "base", within=(0.0, (-0.021, 0.0), 0.0)).kept
