"""What breaks a run as workflow commands of GitHub Actions: a line each, on the row of the trajectory.

Escaped as GitHub documents it, so that no name in a file can end a command or begin another. Not for: the step's
summary (`markdown`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from clearance.errors import is_unpacked
from clearance.findings.finding import Finding
from clearance.findings.finding_text import coded_line
from clearance.findings.verdict import POSE, SAMPLES, Verdict
from clearance.formats.motion.requests import line_of_sample
from clearance.record.record import Record
from clearance.report.model import ReportModel
from clearance.report.moment import own_time, sample_at
from clearance.world.placed_robot import PlacedRobot

MOST = 10
"""Annotations of a step that GitHub shows."""


def annotation_lines(model: ReportModel, root: Path) -> Iterator[str]:
    """At most `MOST` lines, the worst first: what no pair does, findings that fail, then what limits a verdict
    that passes: warnings, waivers, and that only the samples were looked at.

    Args:
        root: the folder that paths are told from, that of the repository.
    """
    title = {"title": f"clearance: {model.record.case.name}"}
    lines = [
        *(command("error", title, text) for text in _of_verdict(model.verdict)),
        *_of_findings(model.record, model.findings, root),
        *(command("warning", title, text) for text in _other_lines(model)),
    ]
    yield from lines[:MOST]


def refusal_line(case_file: Path, text: str, root: Path) -> str:
    """The line on a case that cannot be read or is refused."""
    place = {"file": _shown(str(case_file), root), "title": f"clearance: {case_file.name}"}
    return command("error", place, text)


def _of_verdict(verdict: Verdict) -> list[str]:
    lines = [f"suspect {one.kind}: {one.line}" for one in verdict.suspects]
    lines += [*verdict.unproven_motion, *verdict.waiver_faults, *verdict.warned]
    if verdict.disputed_by is not None:
        lines.append(f"{verdict.disputed_by} disagrees")
    return lines


def _other_lines(model: ReportModel) -> list[str]:
    """What bears on a verdict and fails nothing."""
    verdict = model.verdict
    lines = [line for line in verdict.warnings if line not in verdict.warned]
    lines += [*(f"waived: {line}" for line in verdict.waived)]
    accepted = (finding for finding in model.of_tolerances if finding.accepted)
    lines += [f"accepted: {coded_line(finding)}" for finding in accepted]
    for basis, unchecked in (
        (SAMPLES, "the motion between the samples is not checked"),
        (POSE, "no motion is checked"),
    ):
        if verdict.basis == basis:
            lines.append(f"{verdict.headline()}: {unchecked}")
    return lines


def _of_findings(record: Record, findings: tuple[Finding, ...], root: Path) -> Iterator[str]:
    for finding in findings[: 10 * MOST]:
        if finding.fails:
            row = row_of(record, finding)
            place = {} if row is None else {"file": _shown(row.path, root)}
            if row is not None and row.line is not None:
                place["line"] = str(row.line)
            title = {"title": f"clearance: {record.case.name}"}
            yield command("error", place | title, coded_line(finding))


def _shown(path: str, root: Path) -> str:
    """A path as seen from the repository; as it is where it is outside."""
    seen = os.path.relpath(path, root)
    return os.path.abspath(path) if seen.startswith(os.pardir) else Path(seen).as_posix()


def command(name: str, properties: dict[str, str], message: str) -> str:
    """A workflow command: `::error file=way.csv,line=7::message`."""
    keys = ",".join(f"{key}={_in_property(value)}" for key, value in properties.items())
    return f"::{name} {keys}::{_in_message(message)}"


def _in_message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _in_property(text: str) -> str:
    return _in_message(text).replace(":", "%3A").replace(",", "%2C")


@dataclass(frozen=True)
class TrajectoryRow:
    """A row of a trajectory file, or a line of a program.

    Attributes:
        line: from 1; None where the file has no rows or lines, or lies in a zip, which is then the path.
    """

    path: str
    line: int | None


def row_of(record: Record, finding: Finding) -> TrajectoryRow | None:
    """The row at or before the moment of a finding, or the move of a program then, in the file of its robot, or of
    the first one that has one; None where no trajectory is from a file."""
    own = [placed for placed in record.case.robots if placed.trajectory_path]
    if not own or finding.time is None:
        return None
    placed = next((one for one in own if _is_of(record, one, finding)), own[0])
    path, files = placed.trajectory_path, {one.path: one.read_from for one in record.case.sources}
    if is_unpacked(path):
        return TrajectoryRow(files[record.case.sources[0].path], None)
    if not placed.given_trajectory.moves:
        return TrajectoryRow(path, line_of_sample(path, sample_at(placed, finding.time)))
    place = _OF_MOVE.fullmatch(_move_at(placed, finding.time))
    if place is None:
        return TrajectoryRow(path, None)
    return TrajectoryRow(files.get(place["file"], path), int(place["line"]))


_OF_MOVE = re.compile(r"(?:(?P<file>.+) )?line (?P<line>\d+)")


def _move_at(placed: PlacedRobot, time: float) -> str:
    """Where the move of a program at a time of the run [s] stands: the first that ends then or later."""
    own = own_time(placed, time)
    moves = placed.given_trajectory.moves
    return next((one.where for one in moves if own <= one.end > one.start), moves[-1].where)


def _is_of(record: Record, placed: PlacedRobot, finding: Finding) -> bool:
    before = record.case.prefix_of(placed)
    links = {before + link for link in placed.robot.link_names}
    return bool(links & {finding.body_a, finding.body_b})
