"""The receipt as a file: what is claimed, of which inputs, and the evidence. Same receipt, same bytes.

A first line that names the format, a line with the sha256 of all that follows, a line of JSON, and the numbers,
compressed (xz). Not for: what they prove (`receipt.proof`).
"""

from __future__ import annotations

import hashlib
import json
import lzma
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clearance.errors import BadSyntax, MissingFile, at, shown
from clearance.receipt.proof.proving import SIZES, BadEvidence

FILE_NAME = "receipt.bin"
REPORT = ("findings.json", "report.html", "steps.csv", "summary.json")
"""Files that every report has; a receipt is of the bytes of all files of its report."""

FORMAT = b"clearance receipt "
MAGIC = FORMAT + b"3\n"

MOST_ITEMS = 2**23
"""Of a receipt; more would take minutes to go through."""

LARGEST = 2**28
"""[bytes] No receipt is longer."""

HEXADECIMAL = frozenset("0123456789abcdef")

TYPES = {most: kind for (_, most), kind in zip(SIZES, ("<i1", "<i2", "<i4"), strict=True)}
DAMAGED = "the receipt is damaged or cut off"
REMEDY = "the file as `clearance check --receipt` wrote it"


@dataclass(frozen=True, eq=False)
class Receipt:
    """A receipt.

    Attributes:
        head: as in the file: kind ("full" or "sampled"), case and tolerance (files; empty for none), waivers
            (files beside the case), name, maker (`remade_report.maker`), asked (`asked.asked_of`), data (sha256 of
            the case's numbers), inputs (path and sha256), report (sha256 by file), compared (its page shows a
            comparison with another run), rules (names), nominal (tolerances of the run are not taken off).
        claims: (rules, intervals) in nanometres, as `proof.motion_data.UNIT` says.
        deeds: (k,) what is done with each item. codes: directions of each size, (n, 2).
    """

    head: dict[str, Any]
    claims: np.ndarray
    deeds: np.ndarray
    codes: dict[int, np.ndarray]


def receipt_bytes(receipt: Receipt) -> bytes:
    """The file's content."""
    arrays = {
        "claims": receipt.claims.astype("<i8"),
        "deeds": receipt.deeds.astype("<u1"),
        **{f"codes_{most}": receipt.codes[most].astype(kind) for most, kind in TYPES.items()},
    }
    shapes = {name: list(array.shape) for name, array in arrays.items()}
    head = json.dumps(receipt.head | {"shapes": shapes}, sort_keys=True, ensure_ascii=False)
    body = lzma.compress(b"".join(array.tobytes() for array in arrays.values()))
    rest = head.encode() + b"\n" + body
    return MAGIC + hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


def read_receipt(path: Path) -> Receipt:
    """The receipt in a file.

    Raises:
        MissingFile: it is not there. BadSyntax: no receipt, or a damaged one.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise BadSyntax(f"more than {LARGEST} bytes", where=str(path), valid=REMEDY)
        content = path.read_bytes()
    except OSError as error:
        raise MissingFile(
            f"cannot be read: {error.strerror or error}",
            where=str(path),
            valid="`clearance check CASE --out DIR --receipt` writes one",
        ) from None
    with at(str(path)):
        return receipt_of(content)


def receipt_of(content: bytes) -> Receipt:
    """The receipt of a file's content.

    Raises:
        BadSyntax: it is none, or is damaged.
    """
    if not content.startswith(MAGIC):
        if content.startswith(FORMAT):
            first_line = content[:40].partition(b"\n")[0].decode("ascii", "replace")
            raise BadSyntax(
                f"another version of clearance wrote it: {shown(first_line)!r:.60}",
                valid="that version, or the receipt of a run of this one",
            )
        raise BadSyntax("this is no receipt of this format", valid=REMEDY)
    checksum, newline, rest = content[len(MAGIC) :].partition(b"\n")
    if not newline or hashlib.sha256(rest).hexdigest().encode() != checksum:
        raise BadSyntax(DAMAGED, valid=REMEDY)
    line, _, body = rest.partition(b"\n")
    try:
        head = json.loads(line)
        shapes = head.pop("shapes")
        arrays = _arrays(shapes, body)
        _require_head(head, arrays["claims"])
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, lzma.LZMAError):
        raise BadSyntax(DAMAGED, valid=REMEDY) from None
    codes = {most: arrays[f"codes_{most}"] for most in TYPES}
    return Receipt(head, arrays["claims"], arrays["deeds"], codes)


def _arrays(shapes: dict[str, list[int]], body: bytes) -> dict[str, np.ndarray]:
    kinds = {"claims": ("<i8", 2), "deeds": ("<u1", 1)}
    kinds |= {f"codes_{most}": (kind, 2) for most, kind in TYPES.items()}
    sizes = {}
    for name, (kind, width) in kinds.items():
        shape = shapes[name]
        if len(shape) != width or not all(type(n) is int and 0 <= n <= MOST_ITEMS for n in shape):
            raise ValueError(name)
        sizes[name] = np.dtype(kind).itemsize * int(np.prod(shape, dtype=object))
    total = sum(sizes.values())
    if total > LARGEST:
        raise ValueError("too large")
    unpacked = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=LARGEST)
    data = unpacked.decompress(body, total + 1)
    if len(data) != total or not unpacked.eof or unpacked.unused_data:
        raise ValueError("not as long as it says")
    found, start = {}, 0
    for name, (kind, _) in kinds.items():
        part = np.frombuffer(data[start : start + sizes[name]], kind).reshape(shapes[name])
        found[name], start = part.astype(np.int64), start + sizes[name]
    return found


def _require_head(head: dict[str, Any], claims: np.ndarray) -> None:
    texts = [head[key] for key in ("kind", "case", "tolerance", "name", "data")]
    texts += [*head["waivers"], *head["rules"]]
    texts += [one[key] for one in head["inputs"] for key in ("path", "sha256")]
    texts += [text for key in ("report", "maker") for pair in head[key].items() for text in pair]
    digests = [head["data"], *(one["sha256"] for one in head["inputs"]), *head["report"].values()]
    if not all(len(digest) == 64 and set(digest) <= HEXADECIMAL for digest in digests):
        raise ValueError("sha256")
    if not all(isinstance(head[key], bool) for key in ("nominal", "compared")):
        raise ValueError("nominal, compared")
    if not isinstance(head["asked"], dict):
        raise ValueError("asked")
    if not all(isinstance(text, str) for text in texts) or head["kind"] not in ("full", "sampled"):
        raise ValueError("head")
    if not {*REPORT} <= {*head["report"]}:
        raise ValueError("report")
    if claims.shape[0] != len(head["rules"]):
        raise ValueError("rules")


class EvidenceReader:
    """A receipt's evidence, as it is asked for."""

    def __init__(self, receipt: Receipt) -> None:
        self._receipt = receipt
        self._next = dict.fromkeys((0, *receipt.codes), 0)

    def deeds(self, n: int) -> np.ndarray:
        """(n,) what is done with the next items.

        Raises:
            BadEvidence: there are not so many.
        """
        return self._rows(self._receipt.deeds, 0, n)

    def codes(self, n: int, most: int) -> np.ndarray:
        """(n, 2) the next directions of a size.

        Raises:
            BadEvidence: there are not so many.
        """
        return self._rows(self._receipt.codes[most], most, n)

    @property
    def at_end(self) -> bool:
        """True if nothing is left."""
        parts = {0: self._receipt.deeds, **self._receipt.codes}
        return all(self._next[key] == len(part) for key, part in parts.items())

    def _rows(self, part: np.ndarray, key: int, n: int) -> np.ndarray:
        start = self._next[key]
        self._next[key] = start + n
        if start + n > len(part):
            raise BadEvidence("the evidence ends too soon")
        return part[start : start + n]
