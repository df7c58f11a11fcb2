"""The file of a receipt: the same bytes, whole or refused."""

import hashlib

import numpy as np
import pytest

from clearance.errors import BadSyntax, ClearanceError
from clearance.receipt.proof.proving import SIZES, BadEvidence
from clearance.receipt.receipt_file import (
    MAGIC,
    REPORT,
    EvidenceReader,
    Receipt,
    receipt_bytes,
    receipt_of,
)


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
