"""What the report beside a receipt tells: whether it is that of the receipt, and whether it tells of more.

Not for: proving (`verification`).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import BadSyntax, MissingFile, shown
from clearance.receipt.case_data import CaseData, with_tolerances
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.receipt_file import REPORT, REPORT_FILES, Receipt
from clearance.report.withdrawn import OLDER_SUMMARY

SUMMARY = "summary.json"

SHARE = 0.25
"""[-] Of what tolerances take in an interval by a claim, by which it may be below what was proven
(`writing.MOST_GIVEN_UP`)."""

ROUNDED = 3
"""Units by which a claim may be below what was certified (`writing.claims_of`)."""

MICROMETRES = 2.1e-6
"""[m] The same with tolerances, beside the share."""

PASSING = {"clear": "warn", "near": "fail"}
"""Verdicts that say that limits are kept, and which."""

VERDICTS = (*PASSING, "violated", "contact", "suspect", "stale waiver", "not proven")


class Told(NamedTuple):
    """What a summary tells.

    Attributes:
        verdict: one of `VERDICTS`. n_waivers: what it rests on beside the bounds.
        lower_bound: [m] of all. rules: [m] of each, where it has one.
        limits: [m] of each rule, by the name of the level. left: [m] by tolerances of each rule; None without any.
    """

    verdict: str
    n_waivers: int
    lower_bound: float
    rules: dict[str, float]
    limits: dict[str, dict[str, float]]
    left: dict[str, float] | None


def require_report(place: Path, receipt: Receipt) -> None:
    """Nothing, if the report beside the receipt is the one that it was written with.

    Raises:
        BadSyntax: the first file that is not. MissingFile: one that no report is without.
    """
    known = receipt.head["report"]
    found = {name: digest_of(place / name) for name in REPORT_FILES}
    for name in REPORT:
        if found[name] is None:
            raise _missing(place, place / name)
    for name, digest in found.items():
        if digest not in (None, known.get(name)):
            problem = "is not as it was" if name in known else "was not there"
            raise BadSyntax(
                f"it {problem} when the receipt was written",
                where=str(place / name),
                valid="the report of the same run",
            )


def digest_of(path: Path) -> str | None:
    """sha256 of a file; None where there is none.

    Raises:
        MissingFile: it cannot be read.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise MissingFile(
            f"cannot be read: {error.strerror or error}", where=str(path), valid="the report"
        ) from None


def _missing(place: Path, path: Path) -> MissingFile:
    if (place / OLDER_SUMMARY).is_file():
        return MissingFile(
            "a later run into this folder has not come to its end: its report is an older one",
            where=str(path),
            valid="a run that came to its end",
        )
    return MissingFile("there is none", where=str(path), valid="the report, saved with the receipt")


def told_by(place: Path) -> Told:
    """What the summary of a report tells.

    Raises:
        BadSyntax: a summary that is none.
    """
    try:
        summary = json.loads((place / SUMMARY).read_bytes())
        rules = {one["name"]: one for one in summary["rules"]}
        if len(rules) < len(summary["rules"]):
            raise ValueError("a rule twice")
        told = Told(
            summary["verdict"],
            int(_number(summary["n_waivers"])),
            _number(summary["certified"]["lower_bound"]),
            {
                name: _number(one["lower_bound"])
                for name, one in rules.items()
                if one["lower_bound"] is not None
            },
            {
                name: {level: _number(one[level]) for level in PASSING.values()}
                for name, one in rules.items()
            },
            _left(summary),
        )
        if told.verdict not in VERDICTS:
            raise ValueError(told.verdict)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise BadSyntax(
            "there is no certified bound, verdict or rule in it, or one that is none",
            where=str(place / SUMMARY),
            valid="the report",
        ) from None
    return told


def _left(summary: dict[str, Any]) -> dict[str, float] | None:
    """What tolerances leave of each rule."""
    if "tolerances" not in summary:
        return None
    rules = summary["tolerances"]["rules"]
    found = {one["rule"]: _number(one["proven"]) for one in rules}
    if len(found) < len(rules) or not all(isinstance(rule, str) for rule in found):
        raise ValueError("a rule twice, or none")
    return found


def _number(told: Any) -> float:
    """A finite number.

    Raises:
        ValueError: it is none.
    """
    if not np.isfinite(found := float(told)):
        raise ValueError(told)
    return found


def overstated(told: Told, data: CaseData, receipt: Receipt) -> str:
    """What the report tells of beyond what the receipt claims, first of all; empty if nothing."""
    return next(_all_overstated(told, data, receipt), "")


def _all_overstated(told: Told, data: CaseData, receipt: Receipt) -> Iterator[str]:
    n_nominal = len(data.rules) // 2 if data.has_errors else len(data.rules)
    nominal = receipt.claims[:n_nominal]
    if told.lower_bound > _least(nominal) + ROUNDED * UNIT:
        yield _beyond(told.lower_bound, _least(nominal))
    for rule, bound in told.rules.items():
        known = rule in data.rules[:n_nominal]
        least = _least(nominal[data.rules.index(rule)]) if known else -np.inf
        if bound > least + ROUNDED * UNIT:
            yield _beyond(bound, least, shown(rule))
    if told.verdict in PASSING and not told.n_waivers:
        yield from _not_passing(told, data, nominal)
    if data.has_errors:
        yield from _beyond_tolerances(told, data, receipt)


def _not_passing(told: Told, data: CaseData, nominal: np.ndarray) -> Iterator[str]:
    """The rules that a verdict calls kept and that are not proven to be."""
    level = PASSING[told.verdict]
    for rule, claims in zip(data.rules, nominal, strict=False):
        if not (claims != NOT_CLAIMED).any():
            continue
        limit = told.limits[rule][level] if rule in told.limits else np.inf
        if _least(claims) + ROUNDED * UNIT < limit:
            yield (
                f"{SUMMARY} calls it {told.verdict}, the receipt proves {_least(claims) * 1e3:.6f} mm ({rule}), "
                f"below the {level} limit"
            )


def _beyond_tolerances(told: Told, data: CaseData, receipt: Receipt) -> Iterator[str]:
    """The same of what tolerances leave: a claim may be below what was proven by a share of what they take."""
    nominal, left = np.split(receipt.claims, 2)
    if told.left is None:
        yield f"{SUMMARY} tells of no tolerances, the receipt does"
        return
    for rule, proven in told.left.items():
        row = data.rules.index(rule) if rule in data.rules[: len(nominal)] else None
        if row is None:
            yield f"{SUMMARY} tells of rule {shown(rule)}, the receipt does not"
        elif proven > 0.0 and proven > _most_told(nominal[row], left[row]) + MICROMETRES:
            yield _beyond(proven, _least(left[row]), with_tolerances(rule))


def _most_told(nominal: np.ndarray, left: np.ndarray) -> float:
    """[m] what may be told with tolerances by claims without and with them."""
    claimed = np.flatnonzero((left != NOT_CLAIMED) & (nominal != NOT_CLAIMED))
    taken = np.maximum(nominal[claimed] - left[claimed], 0)
    return float((left[claimed] + SHARE * taken).min()) * UNIT if len(claimed) else 0.0


def _beyond(told: float, least: float, rule: str = "") -> str:
    of_rule = f" ({rule})" if rule else ""
    return f"{SUMMARY} tells of {told * 1e3:.6f} mm{of_rule}, the receipt of {least * 1e3:.6f} mm"


def _least(claims: np.ndarray) -> float:
    """[m] the least that is claimed."""
    claimed = claims[claims != NOT_CLAIMED]
    return float(claimed.min()) * UNIT if len(claimed) else 0.0
