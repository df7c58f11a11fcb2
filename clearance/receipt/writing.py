"""Writes the receipt of a run beside its report. Not for: reading it again (`verification`)."""

from __future__ import annotations

import hashlib
import os
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clearance.errors import BadInput, MissingFile
from clearance.progress import Progress
from clearance.receipt.case_data import CaseData, case_data, require_covered, with_tolerances
from clearance.receipt.claims import with_samples_only
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import (
    FILE_NAME,
    REPORT,
    Receipt,
    receipt_bytes,
)
from clearance.receipt.search import EvidenceList, evidence_for
from clearance.report.folder import write_file

GIVEN_UP = (0.03, 0.12)
"""[-] Of what tolerances take, by which claims are below what they leave; the first that can be shown."""

MOST_GIVEN_UP = 0.2
"""[-] The same of single intervals at most, where evidence would be without end."""

MOST_WITH_ERRORS = 1_500_000
"""Proofs of what tolerances leave; where more are needed, more is given up."""

MANY = 500_000
"""Proofs without tolerances from which on the most is given up at once."""

MICROMETRES = round(2e-6 / UNIT)

if TYPE_CHECKING:
    from clearance.run import Run
    from clearance.simulate.record import Record
    from clearance.world.case import Case


def write_receipt(
    run: Run,
    folder: str | PathLike[str],
    case_file: str | PathLike[str] = "",
    kind: str = "full",
    tolerance_file: str | PathLike[str] = "",
    progress: Progress | None = None,
) -> Path:
    """Writes `receipt.bin` into the folder of a run's report; returns its path.

    Args:
        run: certified, and saved in `folder`.
        case_file: where the case was read from; without one, `verify` has to be given the case.
        kind: "full" for a proof of all intervals, "sampled" for one in 16 and the least of each rule.
        tolerance_file: of the tolerances that were given in place of the case's.
        progress: told while evidence is looked for.

    Raises:
        BadInput: a run that no receipt can be written of. MissingFile: no report in `folder`. Unwritable: it
            cannot be written.
    """
    if kind not in ("full", "sampled"):
        raise BadInput(f"the kind is {kind!r:.60}", valid="full or sampled")
    record, place = run.record, Path(folder)
    require_certified(record)
    report = _hashes(place)
    proven = _proven(record, kind, progress)
    data = proven.data
    head = {
        "kind": kind,
        "case": _way(place, case_file),
        "tolerance": _way(place, tolerance_file),
        "name": data.name,
        "data": data.digest,
        "inputs": [{"path": s.path, "sha256": s.sha256} for s in record.case.sources],
        "report": report,
        "rules": list(data.rules),
        "nominal": record.case.tolerance is not None and not data.has_errors,
    }
    receipt = Receipt(head, proven.claims, proven.evidence.all_deeds, proven.evidence.all_codes)
    write_file(place / FILE_NAME, receipt_bytes(receipt))
    return place / FILE_NAME


class _Claims(NamedTuple):
    """What is claimed of which numbers, and what proves it."""

    data: CaseData
    claims: np.ndarray
    evidence: EvidenceList


def _proven(record: Record, kind: str, progress: Progress | None) -> _Claims:
    """The evidence, of what tolerances leave too where that can be found.

    Raises:
        BadInput: none is found of the bound without them.
    """
    with_errors = case_data(record.case)
    data = case_data(replace(record.case, tolerance=None))
    halves = halves_of(data.shapes)
    claims = _kept(claims_of(record, data), data, kind)
    found = evidence_for(data.stretches, data.shapes, halves, claims, progress=progress)
    if not with_errors.has_errors:
        return _Claims(data, claims, found)
    n_rules, n_stretches = len(data.rules), len(data.stretches)
    exact = claims_of(record, with_errors)
    lowest = _lowered(exact, n_rules, MOST_GIVEN_UP)
    for share in GIVEN_UP if found.n_items < MANY else GIVEN_UP[-1:]:
        lowered = _kept(_lowered(exact, n_rules, share), with_errors, kind)
        both = np.concatenate([claims, lowered[n_rules:]])
        try:
            more = evidence_for(
                with_errors.stretches[n_stretches:], data.shapes, halves, both, MOST_WITH_ERRORS, progress,
                lowest,
            )  # fmt: skip
        except BadInput:
            continue
        return _Claims(with_errors, both, found.and_then(more))
    return _Claims(data, claims, found)


def _kept(claims: np.ndarray, data: CaseData, kind: str) -> np.ndarray:
    return with_samples_only(claims, data) if kind == "sampled" else claims


def _lowered(claims: np.ndarray, n_rules: int, share: float) -> np.ndarray:
    """The claims with tolerances, less a share of what these take and two micrometres: the proof has bounds of its
    own, and what would take the most evidence is not worth it.
    """
    nominal, left = claims[:n_rules], claims[n_rules:]
    taken = np.where(nominal == NOT_CLAIMED, 0, np.maximum(nominal - left, 0))
    less = left - np.ceil(share * taken).astype(np.int64) - MICROMETRES
    return np.concatenate([nominal, np.where(left == NOT_CLAIMED, left, less)])


def require_certified(record: Record) -> None:
    """Nothing, if a run's bounds can be proven again.

    Raises:
        BadInput: why they cannot.
    """
    if record.certificate is None:
        raise BadInput("no receipt of a run that is not certified", valid="certify=True")
    refuse_uncovered(record.case, record.motion_kind, record.method)


def refuse_uncovered(case: Case, motion: str, method: str) -> None:
    """Refuses what no receipt can be written of.

    Raises:
        BadInput: why not.
    """
    if motion != "kinematic":
        raise BadInput(
            f"no receipt for {motion} motion: it follows from no input", valid="kinematic motion"
        )
    if method != "exact":
        raise BadInput(f"no receipt for the method {method}", valid="exact")
    require_covered(case)


def claims_of(record: Record, data: CaseData) -> np.ndarray:
    """(rules, intervals) what the run has certified, rounded down by one to two `UNIT`s."""
    claims = np.full((len(data.rules), data.n_intervals), NOT_CLAIMED)
    for rule in record.rules:
        assert rule.certificate is not None
        claims[data.rules.index(rule.name)] = _claimed(rule.certificate.lower_bound, data)
    for left in record.budget or ():
        name = with_tolerances(left.rule)
        if name in data.rules and left.between is not None:
            claims[data.rules.index(name)] = _claimed(left.between, data)
    return claims


def _claimed(lower: np.ndarray, data: CaseData) -> np.ndarray:
    lower = lower[: data.n_intervals]
    known = np.isfinite(lower)
    row = np.floor(np.where(known, lower, 0.0) / UNIT).astype(np.int64) - 1
    return np.where(known, row, NOT_CLAIMED)


def _hashes(folder: Path) -> dict[str, str]:
    found = {}
    for name in REPORT:
        try:
            found[name] = hashlib.sha256((folder / name).read_bytes()).hexdigest()
        except OSError as error:
            raise MissingFile(
                f"cannot be read: {error.strerror or error}",
                where=str(folder / name),
                valid="run.save(folder) first",
            ) from None
    return found


def _way(folder: Path, case_file: str | PathLike[str]) -> str:
    """The way from a folder to a file, the same on every machine where both lie alike; empty for no file."""
    if not str(case_file):
        return ""
    try:
        way = os.path.relpath(os.path.realpath(case_file), os.path.realpath(folder))
    except ValueError:  # on another drive
        return Path(os.path.realpath(case_file)).as_posix()
    return Path(way).as_posix()
