"""The file of a receipt, whole or refused; what it claims, how much evidence there will be, what gets none."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadSyntax, ClearanceError
from clearance.receipt import search, writing
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.proving import SIZES, BadEvidence, failure_in
from clearance.receipt.receipt_file import (
    FILE_NAME,
    MAGIC,
    REPORT,
    EvidenceReader,
    Receipt,
    receipt_bytes,
    receipt_of,
)
from clearance.receipt.search import EvidenceSearch, TooManyProofs
from clearance.receipt.writing import claims_of
from clearance.simulate.measure import refine
from tests.receipt.receipts import Said, evidence_for, turning_arm
from tests.receipt.test_forged import loose


def small():
    head = {
        "kind": "full", "case": "case.yaml", "name": "small", "data": "0" * 64, "nominal": False,
        "tolerance": "", "waivers": [], "maker": {"clearance": "0"}, "asked": {}, "compared": False,
        "rules": ["default"],
        "inputs": [{"path": "case.yaml", "sha256": "1" * 64}], 
        "report": dict.fromkeys(REPORT, "2" * 64),
    }  # fmt: skip
    codes = {most: np.array([[most, -most]]) for _, most in SIZES}
    return Receipt(head, np.array([[5, -(2**62), 7]]), np.array([4, 1, 2, 3]), codes)


def test_what_is_written_is_read():
    receipt, read = small(), receipt_of(receipt_bytes(small()))
    assert read.head == receipt.head
    assert (read.claims == receipt.claims).all() and (read.deeds == receipt.deeds).all()
    assert all((read.codes[most] == receipt.codes[most]).all() for _, most in SIZES)
    assert receipt_bytes(small()) == receipt_bytes(read)


def test_a_receipt_cut_off_anywhere_is_refused():
    content = receipt_bytes(small())
    for length in range(len(content)):
        with pytest.raises(BadSyntax):
            receipt_of(content[:length])


def test_every_changed_byte_is_found():
    content = receipt_bytes(small())
    for i in range(len(content)):
        changed = bytearray(content)
        changed[i] ^= 1
        with pytest.raises(BadSyntax):
            receipt_of(bytes(changed))


@pytest.mark.parametrize(
    "head",
    [
        b"[]", b"{}", b"[" * 100_000, b'{"shapes": 3}', b'{"shapes": {"claims": [1, 99999999999]}}',
        b'{"shapes": {"claims": [1, 0], "deeds": [8388608], "codes_127": [0, 2], "codes_32767": [0, 2], '
        b'"codes_2147483647": [0, 2]}}',
    ],
)  # fmt: skip
def test_heads_that_say_what_cannot_be_are_refused(head):
    rest = head + b"\n" + b"x"
    content = MAGIC + hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest
    with pytest.raises(ClearanceError, match="damaged"):
        receipt_of(content)


def test_evidence_that_ends_too_soon_is_none():
    evidence = EvidenceReader(small())
    assert list(evidence.deeds(3)) == [4, 1, 2] and not evidence.at_end
    with pytest.raises(BadEvidence):
        evidence.deeds(2)


def test_another_version_is_told():
    content = receipt_bytes(small()).replace(b"receipt 3\n", b"receipt 1\n")
    with pytest.raises(
        BadSyntax, match="another version of clearance wrote it: 'clearance receipt 1'"
    ):
        receipt_of(content)


def test_what_is_no_hash_is_refused():
    receipt = small()
    for sha in ("1" * 63, "1" * 63 + "\n", "A" * 64, 5):
        receipt.head["inputs"][0]["sha256"] = sha
        with pytest.raises(BadSyntax, match="damaged"):
            receipt_of(receipt_bytes(receipt))


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


MILLIMETRE = round(1e-3 / UNIT)


def evenly_proven(case: cl.Case) -> cl.Run:
    """The run of a case, each interval proven to the same gap, the least one too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(refine, "LEAST_QUERIES", -1)
        return cl.check(case)


@pytest.fixture(scope="module")
def overstated():
    """A case's numbers, its claims, and its claims with 1 mm more in the interval of the least."""
    run = evenly_proven(turning_arm(n_steps=7))
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


@pytest.fixture
def narrow(monkeypatch):
    """Fronts of a few items are wide."""
    monkeypatch.setattr(search, "WIDE", 16)
    monkeypatch.setattr(search, "FOLLOWED", 8)


@pytest.fixture(scope="module")
def run():
    return evenly_proven(turning_arm(n_steps=7, far=0.853))


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
    claims = question(cl.check(turning_arm()))
    most = evidence_for(*claims).n_items + 1
    monkeypatch.setattr(writing, "MOST_ITEMS", most)
    monkeypatch.setattr(writing, "MOST_WITH_ERRORS", 1)
    with pytest.raises(BadInput, match=r"a full receipt takes about .* proofs or more"):
        cl.write_receipt(run, tmp_path)
    assert not (tmp_path / FILE_NAME).exists()


def test_large_numbers_are_told_in_one_digit():
    assert "about 9,000,000 proofs" in str(search.too_many(9_412_345.6, 8_000_000))
