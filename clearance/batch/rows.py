"""What a case comes to, as one row: the verdict, the most critical moment, a curve, and what was read.

Not for: measuring (`measuring`), and rows on disk (`store`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
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

_ROW: tuple[tuple[str, pa.DataType, Callable[[Run], Any]], ...] = (
    ("status", pa.string(), lambda run: run.verdict.status),
    ("exit_code", pa.int8(), lambda run: run.verdict.exit_code),
    ("text", pa.string(), lambda run: run.verdict.headline()),
    ("shade", pa.string(), lambda run: run.verdict.shade),
    ("measured", pa.string(), lambda run: run.verdict.measured),
    ("basis", pa.string(), lambda run: run.verdict.basis),
    ("need", pa.string(), lambda run: run.record.need),
    ("clearance", pa.float64(), lambda run: run.verdict.worst.clearance),
    (
        "penetration",
        pa.float64(),
        lambda run: getattr(run.verdict.worst.depth, "penetration", None),
    ),
    ("lower_bound", pa.float64(), lambda run: _certified(run.record)),
    ("proven", pa.float64(), lambda run: _proven(run.record)),
    ("expected", pa.float64(), lambda run: _expected(run.record)),
    ("time", pa.float64(), lambda run: run.verdict.worst.time),
    ("step", pa.int64(), lambda run: run.verdict.worst.step),
    ("body_a", pa.string(), lambda run: run.verdict.worst.link),
    ("body_b", pa.string(), lambda run: run.verdict.worst.obstacle),
    ("rule", pa.string(), lambda run: run.verdict.worst.rule),
    ("fail", pa.float64(), lambda run: run.record.rule(run.verdict.worst.rule).limits.fail),
    ("warn", pa.float64(), lambda run: run.record.rule(run.verdict.worst.rule).limits.warn),
    ("n_steps", pa.int64(), lambda run: len(run.record.motions[0].times)),
    ("start", pa.float64(), lambda run: float(run.record.motions[0].times[0])),
    ("end", pa.float64(), lambda run: float(run.record.motions[0].times[-1])),
    ("reasons", _TEXTS, lambda run: list(run.verdict.reasons)),
    ("warnings", _TEXTS, lambda run: list(run.verdict.warnings)),
    ("scope", _TEXTS, lambda run: list(run.verdict.scope)),
    ("reservations", _TEXTS, lambda run: list(run.verdict.reservations)),
    ("waived", _TEXTS, lambda run: list(run.verdict.waived)),
    ("waivers", _TEXTS, lambda run: _needed(run)),
    ("curve", pa.list_(pa.float32()), lambda run: curve_of(run.record).tolist()),
    ("n_findings", pa.int64(), lambda run: len(run.findings)),
    ("incomplete", pa.string(), lambda run: _incomplete(run, len(run.findings))),
    ("conditions", pa.string(), lambda run: conditions_text(conditions_of(run.record))),
    ("doubts", pa.list_(DOUBT), lambda run: _doubts(run)),
    ("findings", pa.list_(pa.struct(FINDING)), lambda run: _findings(run)),
)
"""Columns that follow from the case, and each of a run; the guide explains them."""

VERDICT = pa.schema([(name, kind) for name, kind, _ in _ROW])
"""Their names and types."""

TABLE = pa.schema([("case", pa.string()), ("key", pa.string()), *VERDICT])
"""Columns of a case: its name, its key, and what follows from it."""


def row_of(run: Run) -> dict[str, Any]:
    """The columns of `VERDICT` for a run."""
    return {name: of(run) for name, _, of in _ROW}


def _certified(record: Record) -> float | None:
    """[m] The least clearance that is proven of the motion, without tolerances."""
    certificate = record.certificate
    return None if certificate is None else float(certificate.lower_bound.min())


def _proven(record: Record) -> float | None:
    """[m] The least clearance that is proven of the motion, with the tolerances that the case has."""
    if record.certificate is None or record.case.tolerance is None:
        return _certified(record)
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


def _doubts(run: Run) -> list[dict[str, Any]]:
    return [
        {"kind": one.kind, "about": one.about, "text": one.text}
        for one in doubts_of(run.record, run.judgement)
    ]


def _findings(run: Run) -> list[dict[str, Any]]:
    return [_finding_row(finding) for finding in run.findings[:MOST_FINDINGS]]


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
