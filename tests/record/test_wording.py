"""Clearances in words: what is shown is never more than what was measured."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as some

from clearance.record.wording import at_least_mm, joint_value, mm, padded_mm


@pytest.mark.parametrize(
    ("metres", "shown"),
    [
        (0.0, "0"),
        (4e-7, "< 0.001"),
        (0.000151999, "0.151"),
        (0.0049999, "4.999"),
        (0.005, "5.000"),
        (0.0283, "28.30"),
        (0.035136, "35.13"),
        (0.20192, "201.9"),
        (1.23456, "1234"),
        (12.3456, "12345"),
    ],
)
def test_millimetres_by_hand(metres, shown):
    assert mm(metres) == shown


@pytest.mark.parametrize(
    ("metres", "shown"),
    [(0.0, "at least 0 mm"), (4e-7, "more than 0 mm"), (0.0049999, "at least 4.999 mm")],
)
def test_a_lower_bound_reads_as_no_upper_one(metres, shown):
    assert at_least_mm(metres) == shown


@given(some.floats(min_value=1e-6, max_value=1e4))
def test_millimetres_are_rounded_down_by_less_than_a_digit(metres):
    shown = Fraction(mm(metres))
    exact = Fraction(repr(metres)) * 1000
    assert shown <= exact
    assert exact - shown < max(Fraction(1, 1000), exact / 1000)


def test_joint_values_carry_their_unit():
    assert joint_value("revolute", 1.5707963267948966) == "90.00°"
    assert joint_value("prismatic", 0.0125) == "12.50 mm"


@pytest.mark.parametrize(
    ("metres", "levels", "told"),
    [
        (0.0126354, (), "12.63"),
        (0.0126354, (0.012635, 0.02), "12.635"),
        (0.0126349, (0.012635,), "12.63"),
        (-0.001234, (0.005,), "-1.234"),
    ],
)
def test_what_keeps_a_level_is_not_shown_below_it(metres, levels, told):
    assert mm(metres, levels) == told


@pytest.mark.parametrize(
    ("clearance", "padding", "told"),
    [
        (0.005 - 6.3e-8, 6.3e-8, "4.999 mm (5.000 mm less 6.3e-05 mm of padding)"),
        (0.02 - 5e-13, 0.0, "19.99 mm"),
        (0.005 - 6.4e-8, 6.3e-8, "4.999 mm"),  # below the limit without it too
        (0.005, 6.3e-8, "5.000 mm"),
        (0.002, 0.004, "2.000 mm (6.000 mm less 4.000 mm of padding)"),
    ],
)
def test_padding_that_decides_on_a_limit_is_told_however_small_it_is(clearance, padding, told):
    moment = SimpleNamespace(clearance=clearance, padding=padding, touches=False)
    assert padded_mm(moment, (0.005, 0.02)) == told
