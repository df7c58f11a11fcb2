"""Verifies a report with a receipt: proves its bound again, and compares all else with a fresh run of the case.

The case's files alone say which pairs, limits and rules are judged; nothing is taken from the report.
Not for: the proof (`verification`), nor the comparison of files (`remade_report`).
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from clearance.case.packed import require_entry, unpacked
from clearance.errors import BadSyntax, MissingFile, NoReceipt, Unavailable, at, shown
from clearance.extras import require
from clearance.files import LAST
from clearance.findings.verdict import KEPT
from clearance.receipt.asked import changed_options, question_of
from clearance.receipt.case_data import CaseData, case_data
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import DAMAGED, FILE_NAME, Receipt, read_receipt
from clearance.receipt.remade_report import (
    ABSENT,
    PAGE,
    differences,
    hashes_of,
    listed,
    other_maker,
    require_report,
    strangers,
)
from clearance.receipt.verification import (
    ROUNDED,
    Verification,
    limits_of,
    n_without_errors,
    proven,
)
from clearance.receipt.writing import claims_of
from clearance.record.status import Status
from clearance.run import CheckOptions, Run, answer
from clearance.world.case import Case, Source

PASSING = {Status.CLEAR: "warn", Status.NEAR: "fail"}
"""The verdicts that say a limit is kept, each with the name of that limit."""

Paths = Sequence[str | PathLike[str]]


def verify(
    folder: str | PathLike[str],
    case: Case | str | PathLike[str] | None = None,
    tolerance: str | PathLike[str] | None = None,
    waivers: Paths = (),
) -> Verification:
    """Whether the receipt proves the certified bound of the report, and the report matches a fresh run.

    The proof shares no code with the measurement. The case is run again, and every file of the report is compared
    with the new one, where the libraries that write a report are installed; the headline says if not.

    Args:
        folder: a report with `receipt.bin`, or the zip that it was packed into.
        case: the case or its file, if it has moved since the receipt was written.
        tolerance, waivers: files that the run had beside its case, if they have moved.

    Raises:
        BadInput: there is no receipt, it is damaged, or an input or a file of the report has changed.
    """
    with unpacked(Path(folder)) as packed:
        place = Path(folder) if packed is None else require_entry(packed, "report")
        found = _verified(place, case, tolerance, waivers)
        is_inside = packed is not None and case is None
        return replace(found, source=str(folder)) if is_inside else found


def _verified(
    place: Path,
    case: Case | str | PathLike[str] | None,
    tolerance: str | PathLike[str] | None,
    waivers: Paths,
) -> Verification:
    receipt = read_receipt(place / FILE_NAME)
    require_report(place, receipt)
    own, given = cases_of(place, receipt, case, tolerance, waivers)
    require_inputs(given, receipt)
    with at(str(place / FILE_NAME)):
        question = question_of(given, receipt.head["asked"])
    data = case_data(replace(given, tolerance=None) if receipt.head["nominal"] else given)
    _require_data(data, receipt)
    found = proven(question.case, data, receipt)
    if found.failure:
        return found
    files = tuple(name for name in (receipt.head["tolerance"], *receipt.head["waivers"]) if name)
    run = answer(question)
    asked = changed_options(own, question, files)
    source = "" if isinstance(case, Case) else str(case or receipt.head["case"])
    verdict = run.verdict
    further = (*verdict.scope, *(f"warning: {line}" for line in verdict.warnings))
    found = replace(found, asked=asked, verdict=verdict.headline(), further=further, source=source)
    return _compared_with_report(found, run, data, receipt, place)


def inputs_of(folder: Path) -> tuple[Path | None, tuple[Source, ...]]:
    """The case file of a report with a receipt, and all that its run was made from; none of a report without one.

    Raises:
        BadInput: the receipt is damaged, or an input or a file of the report has changed.
    """
    if not (folder / FILE_NAME).exists():
        return None, ()
    receipt = read_receipt(folder / FILE_NAME)
    require_report(folder, receipt)
    _, given = cases_of(folder, receipt, None, None, ())
    require_inputs(given, receipt)
    return folder / receipt.head["case"], given.sources


def _compared_with_report(
    found: Verification, run: Run, data: CaseData, receipt: Receipt, place: Path
) -> Verification:
    """The verification, with all that differs between the report and a fresh run."""
    try:
        require("report", "a fresh report")
        different = differences(run, place)
        made_by = other_maker(receipt) if different else ""
        why = f"made by {made_by}: not compared" if made_by else ""
    except Unavailable as error:
        different = dict.fromkeys(hashes_of(place), "")
        why = f"not compared: {error}"
    absent = [name for name, what in different.items() if what == ABSENT]
    reasons = {ABSENT: absent, "not part of the report": strangers(place)}
    different = {name: what for name, what in different.items() if name not in absent}
    unproven = next(_not_borne(run, data, receipt), "")
    if why:
        reasons = {why: sorted(different)} | reasons
        failure = _other_answer(run, place) or unproven
        return replace(found, failure=failure, not_verified=_by_reason(reasons))
    if receipt.head["compared"] and different.pop(PAGE, ""):
        reasons = {"it shows a comparison with another run": [PAGE]} | reasons
    for name, what in different.items():
        return replace(found, failure=f"{name} differs from a fresh run: {what}")
    beyond = _beyond(run, data, receipt)
    for rule in data.rules[: n_without_errors(data)]:
        if rule in beyond:
            unproven = (
                f"the report certifies up to {beyond[rule] * 1e3:.6f} mm more ({shown(rule)})"
            )
    return replace(found, failure=unproven, beyond=beyond, not_verified=_by_reason(reasons))


def _by_reason(reasons: dict[str, list[str]]) -> str:
    """The files that are not verified, grouped by reason."""
    return ", ".join(f"{listed(names)} ({why})" for why, names in reasons.items() if names)


def _not_borne(run: Run, data: CaseData, receipt: Receipt) -> Iterator[str]:
    """The limits that the verdict calls kept, with tolerances or without, and that the receipt does not prove.

    A verdict with waivers says that it rests on them.
    """
    verdict, n_nominal = run.verdict, n_without_errors(data)
    if verdict.measured not in PASSING or verdict.n_waivers:
        return
    levels = [PASSING[Status(verdict.measured)]] * n_nominal
    levels += ["fail" if verdict.tolerances == KEPT else ""] * (len(data.rules) - n_nominal)
    limits = limits_of(run.record.case, data)
    for rule, level, claims in zip(data.rules, levels, receipt.claims, strict=True):
        claimed = claims[claims != NOT_CLAIMED]
        limit = getattr(limits[rule], level) if level else 0.0
        if level and len(claimed) and (claimed.min() + ROUNDED) * UNIT < limit:
            yield (
                f"a fresh run is {verdict.headline()}, but the receipt proves only "
                f"{claimed.min() * UNIT * 1e3:.6f} mm ({shown(rule)}), below the {level} limit "
                f"of {limit * 1e3:g} mm"
            )


def _beyond(run: Run, data: CaseData, receipt: Receipt) -> dict[str, float]:
    """[m] by how much more is certified in some interval than is claimed there, of each rule, if it is."""
    certified = claims_of(run.record, data)
    compared = (certified > 0) & (receipt.claims != NOT_CLAIMED)
    more = np.where(compared, certified - receipt.claims, 0).max(axis=1)
    return {
        rule: n * UNIT for rule, n in zip(data.rules, more.tolist(), strict=True) if n > ROUNDED
    }


AGREES = 1e-6
"""[m] How far clearances of a summary may be off those of a fresh run with other versions of libraries."""


def _other_answer(run: Run, place: Path) -> str:
    """That the summary in a folder has another verdict or other clearances; empty if it has not."""
    try:
        reported = json.loads((place / LAST).read_bytes())
        verdict, found = reported["verdict"], dict(_clearances(reported))
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        verdict, found = "nothing", {}
    if verdict != run.status:
        return f"{LAST} says {shown(repr(verdict))[:60]}, a fresh run says {run.status}"
    for name, fresh in _clearances(run.summary):
        if not abs(found.get(name, math.nan) - fresh) <= AGREES:
            given = found.get(name, "nothing")
            return f"{LAST} says {shown(repr(given))[:60]} for {name}, a fresh run says {fresh}"
    return ""


def _clearances(content: object, name: str = "") -> Iterator[tuple[str, float]]:
    """Each clearance and proven bound [m] of a summary, by where it stands."""
    rows = content.items() if isinstance(content, dict) else ()
    for key, value in enumerate(content) if isinstance(content, list) else rows:
        place = f"{name}.{key}".lstrip(".")
        if key in ("clearance", "lower_bound") and isinstance(value, int | float):
            yield place, float(value)
        else:
            yield from _clearances(value, place)


def cases_of(
    place: Path,
    receipt: Receipt,
    case: Case | str | PathLike[str] | None,
    tolerance: str | PathLike[str] | None,
    waivers: Paths,
) -> tuple[Case, Case]:
    """The case as it is in its own file, and with the files that were given besides."""
    from clearance.case.case_file import load_case

    head = receipt.head
    if isinstance(case, Case):
        own = case
    elif case is None and not head["case"]:
        raise NoReceipt("the receipt belongs to a case without a file", valid="give the case")
    else:
        own = load_case(_path(place, head["case"], case, "--case CASE.yaml"))
    moved: list[str | PathLike[str] | None] = [*waivers] or [None] * len(head["waivers"])
    if len(moved) != len(head["waivers"]):
        text = f"{len(moved)} files of waivers, and the run had {len(head['waivers'])}"
        raise NoReceipt(text, valid="--waivers FILE for each")
    pairs = zip(head["waivers"], moved, strict=True)
    files = tuple(_path(place, way, one, "--waivers FILE") for way, one in pairs)
    path = None
    if tolerance is not None or head["tolerance"]:
        path = _path(place, head["tolerance"], tolerance, "--tolerance FILE")
    return own, CheckOptions(waivers=files, tolerance=path).apply(own)


def _path(place: Path, way: str, given: str | PathLike[str] | None, valid: str) -> Path:
    """The file that is given, or the one that a receipt names.

    Raises:
        MissingFile: there is none.
    """
    path = place / way if given is None else Path(given)
    if not os.path.isfile(path):
        name = shown(way if given is None else str(path))
        raise MissingFile(f"there is no {name}", where=str(place / FILE_NAME), valid=valid)
    return path


def require_inputs(case: Case, receipt: Receipt) -> None:
    """Nothing, if the files that the case is read from are those of the run, as they were.

    Raises:
        BadSyntax: the first that is not.
    """
    known = {one["path"]: one["sha256"] for one in receipt.head["inputs"]}
    read = {source.path: source.sha256 for source in case.sources}
    for path in [*read, *known]:
        if known.get(path) != read.get(path):
            problem = "has changed"
            if path not in known or path not in read:
                problem = f"was {'no' if path in read else 'an'} input of the run"
            raise BadSyntax(
                f"it {problem}",
                where=shown(path),
                valid="the input files as they were for the receipt are needed",
            )


def _require_data(data: CaseData, receipt: Receipt) -> None:
    """Nothing, if the numbers of the case are those of the receipt.

    Raises:
        BadSyntax: they are not.
    """
    with at(FILE_NAME):
        if data.digest != receipt.head["data"] or list(data.rules) != receipt.head["rules"]:
            other = other_maker(receipt)
            raise BadSyntax(
                f"its numbers are not those of case {data.name!r}{other and '; made by '}{other}",
                valid="the case and the tolerances for which the receipt was written",
            )
        if receipt.claims.shape != (len(data.rules), data.n_intervals):
            raise BadSyntax(DAMAGED, valid="claims of every rule and interval")
