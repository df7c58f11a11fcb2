"""What a case comes to, as one row: the verdict, the most critical moment, a curve, and what was read.

Not for: measuring (`measuring`), and rows on disk (`store`).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, get_args, get_type_hints

import numpy as np
import pyarrow as pa

from clearance.findings.doubts import doubts_of
from clearance.findings.finding import AppliedWaiver, Finding, Point
from clearance.findings.findings_file import conditions_text
from clearance.findings.measurement_conditions import conditions_of
from clearance.findings.of_budget import least_expected
from clearance.findings.of_record import why_incomplete
from clearance.record.record import Record
from clearance.report.curves import rounded_down
from clearance.run import Run
from clearance.world.case import Source

ERROR = "error"
"""The status of a case that cannot be read or answered."""

CURVE = 64
"""Numbers of a curve at most."""

_TEXTS = pa.list_(pa.string())

_COLUMNS = {
    str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_(),
    Point: pa.list_(pa.float64()), AppliedWaiver: pa.string(),
}  # fmt: skip
"""What keeps a field of a finding, by its type."""


def _column(kind: Any) -> pa.DataType:
    own = [one for one in get_args(kind) if one in _COLUMNS]
    return _COLUMNS[kind if kind in _COLUMNS else own[0]]


FINDING = pa.schema(
    [(name, _column(kind)) for name, kind in get_type_hints(Finding).items() if name != "joints"]
)
"""What is kept of a `findings.finding.Finding`; of what waives it, the reason and by whom."""

DOUBT = pa.struct([("kind", pa.string()), ("about", pa.string()), ("text", pa.string())])
"""A `findings.doubts.Doubt`."""

MOST_FINDINGS = 200
"""Of one case, the worst."""

VERDICT = pa.schema(
    [
        ("status", pa.string()),
        ("exit_code", pa.int8()),
        ("text", pa.string()),
        ("shade", pa.string()),
        ("measured", pa.string()),
        ("basis", pa.string()),
        ("need", pa.string()),
        ("clearance", pa.float64()),
        ("penetration", pa.float64()),
        ("lower_bound", pa.float64()),
        ("proven", pa.float64()),
        ("expected", pa.float64()),
        ("time", pa.float64()),
        ("step", pa.int64()),
        ("body_a", pa.string()),
        ("body_b", pa.string()),
        ("rule", pa.string()),
        ("fail", pa.float64()),
        ("warn", pa.float64()),
        ("n_steps", pa.int64()),
        ("start", pa.float64()),
        ("end", pa.float64()),
        ("reasons", _TEXTS),
        ("warnings", _TEXTS),
        ("scope", _TEXTS),
        ("reservations", _TEXTS),
        ("waived", _TEXTS),
        ("waivers", _TEXTS),
        ("curve", pa.list_(pa.float32())),
        ("n_findings", pa.int64()),
        ("incomplete", pa.string()),
        ("conditions", pa.string()),
        ("doubts", pa.list_(DOUBT)),
        ("findings", pa.list_(pa.struct(FINDING))),
    ]
)
"""Columns that follow from the case; the guide explains them."""

TABLE = pa.schema([("case", pa.string()), ("key", pa.string()), *VERDICT])
"""Columns of a case: its name, its key, and what follows from it."""


def row_of(run: Run) -> dict[str, Any]:
    """The columns of `VERDICT` for a run."""
    record, verdict = run.record, run.verdict
    worst, times = verdict.worst, record.motions[0].times
    certificate = record.certificate
    limits, findings = record.rule(worst.rule).limits, run.findings
    return {
        "status": verdict.status,
        "exit_code": verdict.exit_code,
        "text": verdict.headline(),
        "shade": verdict.shade,
        "measured": verdict.measured,
        "basis": verdict.basis,
        "need": record.need,
        "clearance": worst.clearance,
        "penetration": None if worst.depth is None else worst.depth.penetration,
        "lower_bound": None if certificate is None else float(certificate.lower_bound.min()),
        "proven": _proven(record),
        "expected": _expected(record),
        "time": worst.time,
        "step": worst.step,
        "body_a": worst.link,
        "body_b": worst.obstacle,
        "rule": worst.rule,
        "fail": limits.fail,
        "warn": limits.warn,
        "n_steps": len(times),
        "start": float(times[0]),
        "end": float(times[-1]),
        "reasons": list(verdict.reasons),
        "warnings": list(verdict.warnings),
        "scope": list(verdict.scope),
        "reservations": list(verdict.reservations),
        "waived": list(verdict.waived),
        "waivers": _needed(run),
        "curve": curve_of(record).tolist(),
        "n_findings": len(findings),
        "incomplete": _incomplete(run, len(findings)),
        "conditions": conditions_text(conditions_of(record)),
        "doubts": [
            {"kind": one.kind, "about": one.about, "text": one.text}
            for one in doubts_of(record, run.judgement)
        ],
        "findings": [_finding_row(finding) for finding in findings[:MOST_FINDINGS]],
    }


def _proven(record: Record) -> float | None:
    """[m] The least clearance that is proven of the motion, with the tolerances that the case has."""
    if record.certificate is None:
        return None
    if record.case.tolerance is None:
        return float(record.certificate.lower_bound.min())
    return min((one.least for one in record.budget or ()), default=None)


def _expected(record: Record) -> float | None:
    """[m] The least that tolerances are expected to leave, of all rules; None without any."""
    found = map(least_expected, record.budget or ())
    return min((one for one in found if one is not None), default=None)


def _needed(run: Run) -> list[str]:
    """Of waivers that many cases share, those that this one needs."""
    if not any(waiver.shared for waiver in run.record.case.waivers):
        return []
    uses = run.judgement.uses
    return [str(use.waiver) for use in uses if use.waiver.shared and use.used]


def _incomplete(run: Run, n_findings: int) -> str:
    """Why something that is not clear may have no finding in the row; empty where each has one."""
    n_left = max(0, n_findings - MOST_FINDINGS)
    unlisted = f"{n_left:,} of {n_findings:,} findings are not listed" if n_left else ""
    return why_incomplete(run.session) or unlisted


def _finding_row(finding: Finding) -> dict[str, Any]:
    values = {name: getattr(finding, name) for name in FINDING.names}
    waived = finding.waived
    return values | {"waived": None if waived is None else f"{waived.reason} ({waived.by})"}


def curve_of(record: Record) -> np.ndarray:
    """(k,) float32 [m] the least clearance in each of equal stretches of steps, at most `CURVE`; where only a
    bound is known, the bound. Rounded down.
    """
    only = record.rules[0].measurement if len(record.rules) == 1 else None
    clearance = record.clearances if only is None else only.clearance
    bound = np.min([rule.measurement.lower_bound for rule in record.rules], axis=0)
    reached = np.where(np.isnan(clearance), bound, clearance)
    n_parts = min(len(reached), CURVE)
    starts = np.arange(n_parts) * len(reached) // n_parts
    return rounded_down(np.minimum.reduceat(reached, starts))


def error_row(text: str, exit_code: int) -> dict[str, Any]:
    """The same for a case that has no answer."""
    row = {field.name: None for field in VERDICT}
    return row | {"status": ERROR, "exit_code": exit_code, "text": text, "reasons": [text]}


def inputs_text(sources: Sequence[Source]) -> str:
    """The files that a case was made from as JSON: path as shown, where it is, sha256."""
    return json.dumps([[one.path, one.read_from, one.sha256] for one in sources])
