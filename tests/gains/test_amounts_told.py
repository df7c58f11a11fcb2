"""The amounts of a change in words: who makes the change as it is told has enough."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clearance.gains.change_parts import ChangePart
from clearance.gains.sentences import signed_text

FACTORS = {"m": 1e3, "rad": math.degrees(1.0), "s": 1.0, "share": 100.0}
"""What an amount is multiplied by to be told."""

ROUNDING = 1e-11
"""[-] What counts as rounding of an amount."""


@given(st.floats(1e-9, 10.0), st.sampled_from([-1.0, 1.0]), st.sampled_from([*FACTORS]))
@example(0.1200434, 1.0, "m")
@example(1.4700434, -1.0, "m")
@example(1e-8, 1.0, "m")
@example(0.05000000000000001, 1.0, "m")
def test_an_amount_as_it_is_told_is_enough_and_hardly_more(size, sign, unit):
    told, needed = signed_text(ChangePart("x", sign * size, unit)).split()[0], size * FACTORS[unit]
    assert math.copysign(1.0, float(told)) == sign
    assert needed * (1.0 - ROUNDING) <= abs(float(told)) < needed + 1e-3


@pytest.mark.parametrize(
    ("size", "told"),
    [(0.02, "+20.000 mm"), (-0.005, "-5.000 mm"), (1e-8, "+0.0001 mm"), (1e-13, "0 mm")],
)
def test_what_is_round_stays_round_and_rounding_is_nothing(size, told):
    assert signed_text(ChangePart("x", size, "m")) == told
