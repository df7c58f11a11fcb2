"""One clearance stands against its limits as a row of many does."""

from __future__ import annotations

import itertools

import numpy as np

from clearance.record.status import STATUSES, status_codes, status_of
from clearance.world.case import Limits


def test_a_number_has_the_status_of_a_row() -> None:
    clearances = [-0.01, -0.0, 0.0, 1e-300, 0.004, 0.005, 0.01, 0.02, 0.03, np.inf, np.nan]
    limits = [Limits(), Limits(0.005), Limits(0.005, 0.02)]
    for own, touches in itertools.product(limits, (None, False, True)):
        touching = None if touches is None else np.full(len(clearances), touches)
        codes = status_codes(np.array(clearances), own, touching)
        rows = [str(STATUSES[code]) for code in codes]
        assert [status_of(value, own, touches) for value in clearances] == rows


def test_what_is_at_a_limit_keeps_it_and_at_0_it_is_broken() -> None:
    clearances = np.array([0.0, 0.0049, 0.005, 0.0199, 0.02])
    apart = np.zeros(5, dtype=bool)
    told = ["violated", "violated", "near", "near", "clear"]
    assert [STATUSES[code] for code in status_codes(clearances, Limits(0.005, 0.02), apart)] == told
    (code,) = status_codes(np.zeros(1), Limits(), np.zeros(1, dtype=bool))
    assert STATUSES[code] == "violated" and status_of(0.0, Limits()) == "contact"
