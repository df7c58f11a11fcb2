"""`findings.json`: the findings of a run, and what is needed to compare them with another run's.

Not for: what a finding is (`finding`), nor comparing (`comparison`). The keys are in `scripts/docs/results.md`.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from clearance.errors import BadReport, BadSyntax
from clearance.findings.doubts import Doubt, doubts_of
from clearance.findings.finding import Finding
from clearance.findings.judgement import Judgement
from clearance.findings.measurement_conditions import MeasurementConditions, conditions_of
from clearance.findings.of_record import why_incomplete
from clearance.formats.files.input_files import read_bytes
from clearance.formats.schema.strict_model import place
from clearance.record.session import Session
from clearance.world.made_moves import MadeMoves

FILE_NAME = "findings.json"

FORMAT = 2
"""Which keys there are: `scripts/docs/results.md`."""

SCHEMA = f"urn:clearance:findings:{FORMAT}"
"""The name of the JSON Schema, which `clearance schema --results findings` prints."""

MOST_LISTED = 10_000
"""Most findings in a file, the worst; how many more there are is said."""

MOST_UNMEASURED = 2_000_000
"""Pairs of a file that is read."""

MOST_BYTES = 64 * 2**20
"""Of a file that is read."""


@dataclass(frozen=True)
class FindingList:
    """The findings of a run.

    Attributes:
        incomplete: why a pair below its warn limit may have no finding; empty where each has one.
        not_listed: how many findings are left out, none worse than those that are there.
        doubts: what a reader must know beside the findings, those that fail the run first.
        findings: the worst first.
        duration: [s] of the motion. n_moves: of all programs, those that take time.
    """

    case: str
    incomplete: str
    not_listed: int
    measured: MeasurementConditions
    doubts: tuple[Doubt, ...]
    findings: tuple[Finding, ...]
    format: int = FORMAT
    duration: float = 0.0
    n_moves: int = 0


def finding_list_of(
    session: Session, findings: tuple[Finding, ...], judgement: Judgement
) -> FindingList:
    """The list of a run with these findings."""
    record = session.record
    times = record.motions[0].times
    return FindingList(
        case=record.case.name,
        incomplete=why_incomplete(session),
        not_listed=max(0, len(findings) - MOST_LISTED),
        measured=conditions_of(record),
        doubts=doubts_of(record, judgement),
        findings=findings[:MOST_LISTED],
        duration=float(times[-1] - times[0]),
        n_moves=sum(len(one.names) for one in MadeMoves.of(record.case).robots),
    )


def findings_text(found: FindingList) -> str:
    """What `findings.json` holds: sorted keys, floats that read back the same, no NaN; of tolerances, moves
    and depths nothing where there are none."""
    content = {"$schema": SCHEMA, **asdict(found)}
    for name in ("doubts", "findings"):
        rows = zip(content[name], getattr(found, name), strict=True)
        content[name] = [row | {"code": one.code} for row, one in rows]
    if not found.measured.tolerances:
        del content["measured"]["tolerances"], content["measured"]["errors"]
    for finding in content["findings"]:
        for key in ("accepted", "move", "moves", "penetration", "penetration_at_least"):
            if finding[key] in (None, "", False):
                del finding[key]
    return json.dumps(content, indent=1, sort_keys=True, allow_nan=False) + "\n"


@lru_cache(maxsize=64)
def conditions_text(measured: MeasurementConditions) -> str:
    """Measurement conditions as JSON, as many runs of one cell share them."""
    return json.dumps(asdict(measured), sort_keys=True, allow_nan=False)


@lru_cache(maxsize=64)
def conditions_in(text: str) -> MeasurementConditions:
    """The conditions that `conditions_text` wrote."""
    from pydantic import TypeAdapter

    return TypeAdapter(MeasurementConditions).validate_json(text, strict=True)


def read_findings(path: str | Path) -> FindingList:
    """The findings in a file, or in the file of that name in a report folder.

    Raises:
        MissingFile: it is not there. BadSyntax: no JSON. BadInput: not such a file, of another format, or too
            long.
    """
    path = Path(path)
    if path.is_dir():
        path = path / FILE_NAME
    data = read_bytes(path, str(path))
    if len(data) > MOST_BYTES:
        raise BadReport(f"{len(data)} bytes", where=str(path), valid=f"at most {MOST_BYTES}")
    _require_format(data, str(path))
    return _checked(data, str(path))


def _require_format(data: bytes, shown: str) -> None:
    try:
        raw = json.loads(data, parse_constant=_refused, parse_float=_finite)
    except (ValueError, RecursionError) as error:
        raise BadSyntax(f"not JSON: {error}", where=shown, valid="findings.json of a run") from None
    number = raw.get("format") if isinstance(raw, dict) else None
    if number != FORMAT:
        valid = f"findings.json of format {FORMAT}, which the same check writes anew"
        raise BadReport(f"format {number!r:.40}", where=shown, valid=valid)


def _finite(text: str) -> float:
    if not math.isfinite(float(text)):
        raise ValueError(f"{text:.40} is beyond doubles")
    return float(text)


def _refused(name: str) -> float:
    raise ValueError(f"{name} is no number")


def _checked(data: bytes, shown: str) -> FindingList:
    from pydantic import TypeAdapter, ValidationError

    try:
        found = TypeAdapter(FindingList).validate_json(data, strict=True)  # text is no number
    except ValidationError as error:
        first = error.errors()[0]
        raise BadReport(
            first["msg"],
            where=f"{shown}: {place(tuple(first['loc']))}",
            valid="findings.json as a run writes it",
        ) from None
    n_pairs = sum(len(block.a) * len(block.b) for block in found.measured.unmeasured)
    if n_pairs > MOST_UNMEASURED:
        raise BadReport(
            f"{n_pairs:,} pairs that are not measured",
            where=f"{shown}: measured.unmeasured",
            valid=f"at most {MOST_UNMEASURED:,}",
        )
    return found
