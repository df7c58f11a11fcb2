"""Clearances in words: what lessens one is told where it is large, or where it decides."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from clearance.record.wording import padded_mm


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
