"""The JSON Schema of what a run writes, `summary.json` and `findings.json`, for programs that read them.

Rows that are written from a dataclass have that dataclass as their model. Not for: the keys of case files
(`formats.schema.json_schema`), nor reading results.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from typing import Any, Literal

from pydantic import Field, TypeAdapter

from clearance.findings import findings_file
from clearance.findings.doubts import Doubt
from clearance.record.levels import Event, Interval
from clearance.record.record import CrossCheck, PairMinimum, ProfileAnswer
from clearance.report import summary
from clearance.report.results_rows import (
    Actor,
    BodyGap,
    BodyRow,
    Carried,
    Certified,
    ClockRow,
    Contact,
    CriticalMoment,
    Input,
    Keys,
    Limits,
    Made,
    Moment,
    Recordings,
    RobotRow,
    Rule,
    SelfClearanceRow,
    Sensitivity,
    Span,
    Status,
    Suspect,
    Tolerances,
    TrackingError,
)
from clearance.world.case import Omission, SignOff

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class Summary(Keys):
    """`summary.json`, in metres, seconds and radians; null: none."""

    named: Literal[summary.SCHEMA] = Field(alias="$schema")  # type: ignore[valid-type]
    format: Literal[summary.FORMAT]  # type: ignore[valid-type]
    name: str
    verdict: str
    verdict_text: str
    measured: Status
    passed: bool
    exit_code: int
    basis: Literal["motion", "samples", "pose"]
    reasons: list[str]
    unproven: str | None
    broken: list[str]
    warnings: list[str]
    suspects: list[Suspect]
    doubts: list[Doubt]
    disputed_by: str | None
    not_checked: list[str]
    nearer: str | None
    clocks: str
    waived: list[str]
    n_waivers: int
    waiver_faults: list[str]
    at_level: str
    worst: CriticalMoment
    worst_sample: CriticalMoment
    nearest: Moment
    nearest_moving: str | None
    sensitivity: Sensitivity
    limits: Limits
    rules: list[Rule]
    status_counts: dict[Status, int]
    intervals: dict[Literal["contact", "below_fail", "below_warn"], list[Interval]]
    events: list[Event]
    not_listed: dict[str, int]
    method: Literal["exact", "paper"]
    paper_tolerance: float | None
    motion: Literal["kinematic", "simulated", "recorded"]
    need: Literal["steps", "pairs", "limit", "minimum"]
    n_steps: int
    start: float
    end: float
    certified: Certified | None
    cross_check: CrossCheck | None
    tracking_error: TrackingError | None
    tessellation_bound: float
    notes: list[str]
    contact: Contact | None
    profiles: list[ProfileAnswer]
    sides: tuple[str, str]
    pairs: list[PairMinimum]
    unmeasured: list[Omission]
    self_clearance: list[SelfClearanceRow]
    moves: tuple[Made, ...] = ()
    actors: list[Actor]
    carries: list[Carried]
    clock: ClockRow
    not_measured: list[Span]
    paddings: dict[str, float]
    robots: list[RobotRow]
    obstacles: list[BodyRow]
    tally: dict[str, int]
    sign_off: SignOff | None
    inputs: list[Input]
    versions: dict[str, str]
    body_gaps: tuple[BodyGap, ...] = ()
    recordings: Recordings | None = None
    tolerances: Tolerances | None = None


_TEXT, _RAD_OR_M = {"type": "string"}, {"enum": ["rad", "m"]}

_WRITTEN_TOO: dict[str, dict[str, Any]] = {
    "CrossCheck": {"agrees": {"type": "boolean"}},
    "PairMinimum": {"status": {"enum": ["clear", "near", "violated", "contact"]}},
    "JointError": {"unit": _RAD_OR_M},
    "Rate": {
        "both_ways": {"type": "boolean"},
        "kind": {"enum": ["joint", "base", "obstacle"]},
        "unit": _RAD_OR_M,
    },
    "ChangePart": {"unit": {"enum": ["rad", "m", "s", "share"]}},
    "ErrorSource": {"name": _TEXT, "given": _TEXT, "at_most": _TEXT},
    "Finding": {"code": _TEXT},
    "Doubt": {"code": _TEXT},
    "PairFinding": {"reason": _TEXT},
    "Obstruction": {"text": _TEXT},
    "FindingList": {
        "$schema": {"const": findings_file.SCHEMA},
        "format": {"const": findings_file.FORMAT},
        "duration": {"type": "number"},
        "n_moves": {"type": "integer"},
    },
}
"""Keys that are written beside the fields of a dataclass, or that say more than their types."""


def summary_schema() -> dict[str, Any]:
    """The JSON Schema of `summary.json`."""
    return closed_schema(summary.SCHEMA, TypeAdapter(Summary).json_schema())


def findings_schema() -> dict[str, Any]:
    """The JSON Schema of `findings.json`."""
    return closed_schema(findings_file.SCHEMA, TypeAdapter(findings_file.FindingList).json_schema())


def closed_schema(name: str, made: dict[str, Any]) -> dict[str, Any]:
    """A schema under its name, in which no object has keys beside those that are written."""
    for part in (made, *made.get("$defs", {}).values()):
        if "properties" not in part:
            continue
        more = _WRITTEN_TOO.get(part["title"], {})
        keys = part["properties"] | more
        part["required"] = list(dict.fromkeys([*part.get("required", []), *more]))
        part["properties"] = keys | {key: _TEXT for key in _of_programs(keys)}
        part["additionalProperties"] = False
    return {"$schema": DIALECT, "$id": name, **made}


def _of_programs(keys: Container[str]) -> Iterator[str]:
    """What a row has beside its time, where a robot follows a program."""
    if "time" in keys:
        yield "move"
    if "start" in keys and "end" in keys and "moves" not in keys:
        yield "moves"
