"""How much evidence there will be is foreseen, and what would be too much is refused before it is looked for."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.receipt import search, writing
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.receipt_file import FILE_NAME
from clearance.receipt.search import EvidenceSearch, TooManyProofs, evidence_for
from tests.receipt.receipts import turning_arm
from tests.receipt.test_forged import loose


@pytest.fixture
def narrow(monkeypatch):
    """Fronts of a few items are wide."""
    monkeypatch.setattr(search, "WIDE", 16)
    monkeypatch.setattr(search, "FOLLOWED", 8)


@pytest.fixture(scope="module")
def run():
    return cl.check(turning_arm(n_steps=7, far=0.853))


def question(run):
    data = case_data(run.record.case)
    claims = writing.claims_of(run.record, data)
    return data.stretches, data.shapes, halves_of(data.shapes), claims


def test_what_is_foreseen_is_about_what_is_found(run, narrow):
    one = EvidenceSearch(*question(run))
    foreseen = one.foresee(search.MOST_ITEMS)
    known = one.n_found
    found = one.finish(search.MOST_ITEMS)
    assert known < found.n_items
    assert found.n_items / 1.6 < foreseen < 1.6 * found.n_items


@pytest.mark.slow
def test_foreseeing_changes_nothing(run, narrow, monkeypatch):
    found = evidence_for(*question(run))
    monkeypatch.setattr(search, "WIDE", 2**14)
    other = evidence_for(*question(run))
    assert np.array_equal(found.all_deeds, other.all_deeds)
    assert all(
        np.array_equal(found.all_codes[most], other.all_codes[most]) for most in found.all_codes
    )


@pytest.mark.slow
def test_too_much_is_refused_before_it_is_looked_for(run, narrow):
    n = evidence_for(*question(run)).n_items
    one = EvidenceSearch(*question(run))
    with pytest.raises(TooManyProofs, match="--receipt sampled"):
        one.foresee(n // 4)
    assert one.n_found < n // 4


@pytest.mark.slow
def test_a_receipt_that_is_too_large_is_not_written_as_one_without_tolerances(
    tmp_path, narrow, monkeypatch
):
    run = cl.check(loose())
    run.save(tmp_path)
    n = cl.write_receipt(run, tmp_path).stat().st_size
    assert n and not (tmp_path / FILE_NAME).unlink()
    claims = question(cl.check(turning_arm()))
    most = evidence_for(*claims).n_items + 1
    monkeypatch.setattr(writing, "MOST_ITEMS", most)
    monkeypatch.setattr(writing, "MOST_WITH_ERRORS", 1)
    with pytest.raises(BadInput, match=r"a full receipt takes about .* proofs or more"):
        cl.write_receipt(run, tmp_path)
    assert not (tmp_path / FILE_NAME).exists()


def test_large_numbers_are_told_in_one_digit():
    assert "about 9,000,000 proofs" in str(search.too_many(9_412_345.6, 8_000_000))
