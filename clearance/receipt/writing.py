"""Writes the receipt of a run beside its report. Not for: reading it again (`verification`)."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clearance.errors import BadInput, NoReceipt
from clearance.files import write_file
from clearance.progress import Progress
from clearance.receipt.asked import asked_of, refuse_uncovered
from clearance.receipt.case_data import CaseData, case_data, with_tolerances
from clearance.receipt.claims import with_samples_only
from clearance.receipt.fronts import EvidenceList
from clearance.receipt.proof.halving import Halves, halves_of
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import FILE_NAME, Receipt, receipt_bytes
from clearance.receipt.remade_report import has_comparison, hashes_of, maker
from clearance.receipt.search import MOST_ITEMS, EvidenceSearch, TooManyProofs

GIVEN_UP = (0.0, 0.12)
"""[-] Of what tolerances take, by which claims are below what they leave, but for the least of a rule; the first
that can be shown."""

MOST_GIVEN_UP = 0.2
"""[-] The same of single intervals at most, where evidence would be without end."""

MOST_WITH_ERRORS = 1_500_000
"""Proofs of what tolerances leave; where more are needed, something is given up."""

MANY = 500_000
"""Proofs without tolerances from which on the most is given up at once."""

ERRORS_TAKE = 2
"""Times as long as one without takes a proof with tolerances, about."""

MICROMETRES = round(2e-6 / UNIT)

if TYPE_CHECKING:
    from clearance.record.record import Record
    from clearance.run import Run


def write_receipt(
    run: Run,
    folder: str | PathLike[str],
    case_file: str | PathLike[str] = "",
    kind: str = "full",
    tolerance_file: str | PathLike[str] = "",
    progress: Progress | None = None,
    waiver_files: Sequence[str | PathLike[str]] = (),
) -> Path:
    """Writes `receipt.bin` into the folder of a run's report; returns its path.

    Args:
        run: certified, and saved in `folder`.
        case_file: where the case was read from; without one, `verify` has to be given the case.
        kind: "full" for a proof of all intervals, "sampled" for one in 16 and the least of each rule.
        tolerance_file: of the tolerances that were given in place of the case's.
        progress: called while evidence is looked for.
        waiver_files: of the waivers that were given in addition to the case's.

    Raises:
        BadInput: a run that no receipt can be written of, or the report of another one. MissingFile: no report in
            `folder`. Unwritable: it cannot be written.
    """
    if kind not in ("full", "sampled"):
        raise NoReceipt(f"the kind is {kind!r:.60}", valid="full or sampled")
    record, place = run.record, Path(folder)
    if run.question is None:
        raise NoReceipt("no receipt of a record that answers no question", valid="a run of check()")
    refuse_uncovered(run.question)
    report, compared = hashes_of(place), has_comparison(run, place)
    proven = _proven(record, kind, progress)
    data = proven.data
    head = {
        "kind": kind,
        "case": _way(place, case_file),
        "tolerance": _way(place, tolerance_file),
        "waivers": [_way(place, path) for path in waiver_files],
        "name": data.name,
        "maker": maker(),
        "asked": asked_of(run.question),
        "data": data.digest,
        "inputs": [{"path": s.path, "sha256": s.sha256} for s in record.case.sources],
        "report": report,
        "compared": compared,
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
    """The evidence, of what tolerances leave too where that can be found. How much it will be is foreseen of both
    before all of it is looked for.

    Raises:
        TooManyProofs: a full receipt would be too large. BadInput: none is found of the bound without tolerances.
    """
    with_errors = case_data(record.case)
    data = case_data(replace(record.case, tolerance=None))
    halves = halves_of(data.shapes)
    claims = _asked_claims(claims_of(record, data), data, kind)
    if progress is not None:
        progress(0, 1000)  # until it is known how much it is
    search = EvidenceSearch(data.stretches, data.shapes, halves, claims)
    search.foresee(MOST_ITEMS)
    attempts: Iterator[_Attempt] = iter(())
    if with_errors.has_errors:
        attempts = _attempts(record, kind, with_errors, claims, halves, search.n_foreseen)
    attempt = _first(attempts)
    middle = 1000 if attempt is None else round(1000 * _share(search, attempt.search))
    found = search.finish(MOST_ITEMS, part_of(progress, 0, middle))
    while attempt is not None:
        try:
            most = min(attempt.most_items, MOST_ITEMS - found.n_items)
            more = attempt.search.finish(most, part_of(progress, middle, 1000))
            return _Claims(with_errors, attempt.claims, found.and_then(more))
        except BadInput as error:
            attempt = _first(attempts, error)
    return _Claims(data, claims, found)


def _share(search: EvidenceSearch, with_errors: EvidenceSearch) -> float:
    """[-] Of the time that both have ahead, the first's; a proof with errors takes `ERRORS_TAKE` times as long."""
    ahead = [max(1, one.n_foreseen - one.n_found) for one in (search, with_errors)]
    return ahead[0] / (ahead[0] + ERRORS_TAKE * ahead[1])


class _Attempt(NamedTuple):
    """Claims with tolerances, less some of what these take, the search for what proves them, and its limit."""

    claims: np.ndarray
    search: EvidenceSearch
    most_items: int


def _attempts(
    record: Record, kind: str, data: CaseData, claims: np.ndarray, halves: Halves, n_nominal: int
) -> Iterator[_Attempt]:
    """Attempts to claim what tolerances leave, with more given up each.

    Args:
        data: with errors. claims, n_nominal: without, and about how many proofs of these there are.
    """
    n_rules, n_stretches = len(data.rules) // 2, len(data.stretches) // 2
    exact = claims_of(record, data)
    lowest = _lowered(exact, n_rules, MOST_GIVEN_UP)
    for share in GIVEN_UP if n_nominal < MANY else GIVEN_UP[-1:]:
        lowered = _no_lower_than_least(_lowered(exact, n_rules, share), exact)
        lowered = _asked_claims(lowered, data, kind)
        both = np.concatenate([claims, lowered[n_rules:]])
        search = EvidenceSearch(data.stretches[n_stretches:], data.shapes, halves, both, lowest)
        last = share == GIVEN_UP[-1]
        yield _Attempt(both, search, MOST_ITEMS - n_nominal if last else MOST_WITH_ERRORS)


def _first(attempts: Iterator[_Attempt], error: BadInput | None = None) -> _Attempt | None:
    """The first of some attempts that is not foreseen to fail; None if what is claimed cannot be proven.

    Args:
        error: of an attempt before.

    Raises:
        TooManyProofs: the last was too large.
    """
    for attempt in attempts:
        try:
            attempt.search.foresee(attempt.most_items)
            return attempt
        except BadInput as failed:
            error = failed
    if isinstance(error, TooManyProofs):
        raise error
    return None


def part_of(progress: Progress | None, low: int, high: int) -> Progress | None:
    """Progress of a part of the work, from and to thousandths of all."""
    if progress is None:
        return None
    return lambda done, total: progress(low + (high - low) * done // total, 1000)


def _asked_claims(claims: np.ndarray, data: CaseData, kind: str) -> np.ndarray:
    return with_samples_only(claims, data) if kind == "sampled" else claims


def _lowered(claims: np.ndarray, n_rules: int, share: float) -> np.ndarray:
    """The claims with tolerances, less a share of what these take and, with it, two micrometres.

    The proof has bounds of its own, and what would take the most evidence is not worth it.
    """
    nominal, remaining = claims[:n_rules], claims[n_rules:]
    lost = np.where(nominal == NOT_CLAIMED, 0, np.maximum(nominal - remaining, 0))
    lowered = remaining - np.ceil(share * lost).astype(np.int64) - (MICROMETRES if share else 0)
    return np.concatenate([nominal, np.where(remaining == NOT_CLAIMED, remaining, lowered)])


def _no_lower_than_least(lowered: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Claims that are given up no further than the least of their rule, on which a verdict rests."""
    claimed = exact != NOT_CLAIMED
    least = np.where(claimed, exact, np.iinfo(np.int64).max).min(axis=1, keepdims=True)
    return np.where(claimed, np.maximum(lowered, least), lowered)


def claims_of(record: Record, data: CaseData) -> np.ndarray:
    """(rules, intervals) what the run has certified, rounded down by one to two `UNIT`s."""
    claims = np.full((len(data.rules), data.n_intervals), NOT_CLAIMED)
    for rule in record.rules:
        assert rule.certificate is not None
        claims[data.rules.index(rule.name)] = _claimed(rule.certificate.lower_bound, data)
    for remaining in record.budget or ():
        name = with_tolerances(remaining.rule)
        if name in data.rules and remaining.between is not None:
            claims[data.rules.index(name)] = _claimed(remaining.between, data)
    return claims


def _claimed(lower: np.ndarray, data: CaseData) -> np.ndarray:
    lower = lower[: data.n_intervals]
    known = np.isfinite(lower)
    row = np.floor(np.where(known, lower, 0.0) / UNIT).astype(np.int64) - 1
    return np.where(known, row, NOT_CLAIMED)


def _way(folder: Path, case_file: str | PathLike[str]) -> str:
    """The way from a folder to a file, the same on every machine where both lie alike; empty for no file."""
    if not str(case_file):
        return ""
    try:
        way = os.path.relpath(os.path.realpath(case_file), os.path.realpath(folder))
    except ValueError:  # on another drive
        return Path(os.path.realpath(case_file)).as_posix()
    return Path(way).as_posix()
