"""What breaks a run as workflow commands of GitHub Actions: a line each, on the row of the trajectory.

Escaped as GitHub documents it, so that no name in a file can end a command or begin another. Not for: the step's
summary (`markdown`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from clearance.findings.finding import Finding
from clearance.findings.finding_text import finding_line
from clearance.findings.verdict import ACCEPTED, POSE, SAMPLES, Verdict
from clearance.record.record import Record
from clearance.report.trajectory_row import row_of

MOST = 10
"""Annotations of a step that GitHub shows."""


def annotation_lines(
    record: Record, verdict: Verdict, findings: tuple[Finding, ...], root: Path
) -> Iterator[str]:
    """At most `MOST` lines, the worst first: what no pair does, findings that fail, then what limits a verdict
    that passes: warnings, waivers, and that only the samples were looked at.

    Args:
        root: the folder that paths are told from, that of the repository.
    """
    title = {"title": f"clearance: {record.case.name}"}
    lines = [
        *(command("error", title, text) for text in _of_verdict(verdict)),
        *_of_findings(record, findings, root),
        *(command("warning", title, text) for text in _beside(verdict)),
    ]
    yield from lines[:MOST]


def _of_verdict(verdict: Verdict) -> list[str]:
    told = [f"suspect {one.kind}: {one.text}" for one in verdict.suspects] + [*verdict.stale]
    if verdict.disputed_by is not None:
        told.append(f"{verdict.disputed_by} disagrees")
    return told


def _beside(verdict: Verdict) -> list[str]:
    """What bears on a verdict and fails nothing."""
    told = [*verdict.warnings, *(f"waived: {line}" for line in verdict.waived)]
    if verdict.tolerances == ACCEPTED:
        told += [f"not proven, which is accepted: {line}" for line in verdict.with_tolerances]
    for basis, of in ((SAMPLES, "the motion between the samples"), (POSE, "any motion")):
        if verdict.basis == basis:
            told.append(f"{verdict.text()}: nothing is said about {of}")
    return told


def _of_findings(record: Record, findings: tuple[Finding, ...], root: Path) -> Iterator[str]:
    for finding in findings[: 10 * MOST]:
        if finding.fails:
            row = row_of(record, finding)
            place = {} if row is None else {"file": _shown(row.path, root)}
            if row is not None and row.line is not None:
                place["line"] = str(row.line)
            title = {"title": f"clearance: {record.case.name}"}
            yield command("error", place | title, finding_line(finding))


def _shown(path: str, root: Path) -> str:
    """A path as seen from the repository; as it is where it is outside."""
    seen = os.path.relpath(path, root)
    return os.path.abspath(path) if seen.startswith(os.pardir) else Path(seen).as_posix()


def command(name: str, properties: dict[str, str], message: str) -> str:
    """A workflow command: `::error file=way.csv,line=7::message`."""
    told = ",".join(f"{key}={_in_property(value)}" for key, value in properties.items())
    return f"::{name} {told}::{_in_message(message)}"


def _in_message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _in_property(text: str) -> str:
    return _in_message(text).replace(":", "%3A").replace(",", "%2C")
