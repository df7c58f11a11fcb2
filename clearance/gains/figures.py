"""`gain.json`: the figures of a gain. Not for: its folder (`folder`), nor its sentences."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import asdict
from typing import Any, Literal

from pydantic import Field, TypeAdapter

from clearance.gains.change_parts import (
    ChangePart,
    change_parts,
    joint_parts,
    proven_after,
    proven_bound,
    size_in_unit,
)
from clearance.gains.obstruction import Obstruction
from clearance.gains.result import Gain
from clearance.gains.sentences import lines_of
from clearance.gains.tool_path_error import ToolPathError
from clearance.gains.turn import Turn
from clearance.record.moment import Moment
from clearance.report.results_rows import Keys, Span
from clearance.report.results_schema import closed_schema
from clearance.run import Run

FORMAT = 2
"""Of `gain.json`: `scripts/docs/results.md` has the keys."""

SCHEMA = f"urn:clearance:gain:{FORMAT}"
"""The name of the JSON Schema, which `clearance schema --results gain` prints."""


class ToolRow(Keys):
    """How far a tool is moved [m] and turned [rad] at a moment [s], and how far it may be."""

    link: str
    time: float
    far: float
    turn: float
    most_far: float
    most_turn: float


class MomentRow(Keys):
    """The most critical moment of a run [m, s]."""

    link: str
    obstacle: str
    time: float
    step: int
    between: bool
    clearance: float
    rule: str
    touches: bool


class RunRow(Keys):
    """The case before or after the change; `fail` and `proven` [m]."""

    verdict: str
    verdict_text: str
    passed: bool
    reasons: list[str]
    fail: float
    worst: MomentRow
    proven: float | None


class Figures(Keys):
    """`gain.json`, in metres, seconds and radians; null: none."""

    named: Literal[SCHEMA] = Field(alias="$schema")  # type: ignore[valid-type]
    format: Literal[FORMAT]  # type: ignore[valid-type]
    name: str
    kind: Literal["waypoints", "obstacle", "base", "timing"]
    who: str
    kept: bool
    clearances_kept: bool
    margin: float
    keep: list[Span]
    keep_ends: bool
    tool: list[ToolRow]
    tool_path: ToolPathError | None
    joints: list[ChangePart]
    within: list[Span] | None
    turn: Turn | None
    slow_down: bool
    size: float
    unit: Literal["rad", "m", "s", "share"]
    lower_bound: float | None
    parts: list[ChangePart]
    before: RunRow
    after: RunRow
    blocked: Obstruction | None
    binding: list[str]
    warnings: list[str]
    n_measured: int
    notes: list[str]


def figures_schema() -> dict[str, Any]:
    """The JSON Schema of `gain.json`."""
    return closed_schema(SCHEMA, TypeAdapter(Figures).json_schema())


def figures_of(gain: Gain, notes: Collection[str] = ()) -> dict[str, Any]:
    """All figures, in metres, radians and seconds."""
    request, blocked = gain.request, gain.blocked
    size, least, unit = size_in_unit(gain)
    return {
        "$schema": SCHEMA,
        "format": FORMAT,
        "name": gain.case.name,
        "kind": request.kind,
        "who": gain.who,
        "kept": gain.kept,
        "clearances_kept": gain.clearances_kept,
        "margin": request.margin,
        "keep": [list(window) for window in request.keep],
        "keep_ends": request.keep_ends,
        "tool": [
            {
                "link": one.link,
                "time": one.keep.time,
                "far": one.far,
                "turn": one.turn,
                "most_far": one.keep.far,
                "most_turn": one.keep.turn,
            }
            for one in gain.tool_moves
        ],
        "tool_path": None if gain.tool_path is None else vars(gain.tool_path),
        "joints": [] if gain.tool_path is None else [asdict(part) for part in joint_parts(gain)],
        "within": None if request.within is None else [list(ends) for ends in request.within],
        "turn": None if request.turn is None else vars(request.turn),
        "slow_down": request.slow_down,
        "size": size,
        "unit": unit,
        "lower_bound": least if least > 0.0 else None,
        "parts": [asdict(part) for part in change_parts(gain)],
        "before": _of_run(gain.before, proven_bound(gain.before)),
        "after": _of_run(gain.after, proven_after(gain)),
        "blocked": None if blocked is None else asdict(blocked) | {"text": str(blocked)},
        "binding": list(gain.binding),
        "warnings": [line for label, line in lines_of(gain) if label == "warning"],
        "n_measured": gain.n_measured,
        "notes": list(notes),
    }


def _of_run(run: Run, proven: float | None) -> dict[str, Any]:
    return {
        "verdict": run.status,
        "verdict_text": run.verdict.headline(),
        "passed": run.passed,
        "reasons": list(run.verdict.reasons),
        "fail": run.record.rule(run.verdict.worst.rule).limits.fail,
        "worst": _moment(run.verdict.worst),
        "proven": proven,
    }


def _moment(moment: Moment) -> dict[str, Any]:
    names = ("link", "obstacle", "time", "step", "between", "clearance", "rule", "touches")
    return {name: getattr(moment, name) for name in names}
