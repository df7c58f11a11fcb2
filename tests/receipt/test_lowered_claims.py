"""A claim that its proof cannot show is lowered, as far as it may be, where cutting would have no end."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.proving import failure_in
from clearance.receipt.search import evidence_for
from clearance.receipt.writing import claims_of
from tests.receipt.receipts import Said, turning_arm

MILLIMETRE = round(1e-3 / UNIT)


@pytest.fixture(scope="module")
def overstated():
    """A case's numbers, its claims, and its claims with 1 mm more in the interval of the least."""
    run = cl.check(turning_arm(n_steps=7))
    data = case_data(run.record.case)
    claims = claims_of(run.record, data)
    more = claims.copy()
    more[0, np.argmin(claims[0])] += MILLIMETRE
    return data, claims, more


def test_the_claim_that_is_too_high_is_lowered_alone_and_proven(overstated):
    data, claims, more = overstated
    halves, told, least = halves_of(data.shapes), more.copy(), claims - MILLIMETRE // 100
    found = evidence_for(data.stretches, data.shapes, halves, told, lowest=least)
    assert ((told < more) == (more > claims)).all()
    assert (told >= least).all()
    assert failure_in(data.stretches, data.shapes, halves, told, Said(found)) is None
    assert failure_in(data.stretches, data.shapes, halves, more, Said(found)) is not None


@pytest.mark.slow
def test_no_claim_is_lowered_further_than_it_may_be(overstated):
    data, _, more = overstated
    with pytest.raises(BadInput):
        evidence_for(
            data.stretches, data.shapes, halves_of(data.shapes), more.copy(), 2_000,
            lowest=more - MILLIMETRE // 2,
        )  # fmt: skip
