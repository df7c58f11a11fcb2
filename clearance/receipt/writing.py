"""Writes the receipt of a run beside its report. Not for: reading it again (`verification`)."""

from __future__ import annotations

import hashlib
import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadInput, MissingFile
from clearance.receipt.case_data import CaseData, case_data, require_covered
from clearance.receipt.claims import with_samples_only
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import (
    FILE_NAME,
    REPORT,
    Receipt,
    receipt_bytes,
)
from clearance.receipt.search import evidence_for
from clearance.report.folder import write_file

if TYPE_CHECKING:
    from clearance.run import Run
    from clearance.simulate.record import Record
    from clearance.world.case import Case


def write_receipt(
    run: Run, folder: str | PathLike[str], case_file: str | PathLike[str] = "", kind: str = "full"
) -> Path:
    """Writes `receipt.bin` into the folder of a run's report; returns its path.

    Args:
        run: certified, and saved in `folder`.
        case_file: where the case was read from; without one, `verify` has to be given the case.
        kind: "full" for a proof of all intervals, "sampled" for one in 16 and the least of each rule.

    Raises:
        BadInput: a run that no receipt can be written of. MissingFile: no report in `folder`. Unwritable: it
            cannot be written.
    """
    if kind not in ("full", "sampled"):
        raise BadInput(f"the kind is {kind!r:.60}", valid="full or sampled")
    record, place = run.record, Path(folder)
    require_certified(record)
    report = _hashes(place)
    data = case_data(record.case)
    claims = claims_of(record, data)
    if kind == "sampled":
        claims = with_samples_only(claims, data)
    found = evidence_for(data.stretches, data.shapes, halves_of(data.shapes), claims)
    head = {
        "kind": kind,
        "case": _way(place, case_file),
        "name": data.name,
        "data": data.digest,
        "inputs": [{"path": s.path, "sha256": s.sha256} for s in record.case.sources],
        "report": report,
        "rules": list(data.rules),
        "nominal": record.case.tolerance is not None,
    }
    receipt = Receipt(head, claims, found.all_deeds, found.all_codes)
    write_file(place / FILE_NAME, receipt_bytes(receipt))
    return place / FILE_NAME


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
        lower = rule.certificate.lower_bound[: data.n_intervals]
        known = np.isfinite(lower)
        row = np.floor(np.where(known, lower, 0.0) / UNIT).astype(np.int64) - 1
        claims[data.rules.index(rule.name)] = np.where(known, row, NOT_CLAIMED)
    return claims


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
