"""`gain.json`: the figures of a gain. Not for: its folder (`folder`), nor its sentences."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from clearance.gains.answer import Gain
from clearance.gains.change_parts import change_parts, joint_parts, proven_after, proven_bound
from clearance.record.moment import Moment
from clearance.run import Run

FORMAT = 1
"""Of `gain.json`: `scripts/docs/results.md` has the keys."""


def figures_of(gain: Gain, notes: Collection[str] = ()) -> dict[str, Any]:
    """All figures, in metres, radians and seconds."""
    request, blocked = gain.request, gain.blocked
    return {
        "format": FORMAT,
        "name": gain.case.name,
        "kind": request.kind,
        "who": gain.who,
        "kept": gain.kept,
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
        "joints": [] if gain.tool_path is None else [part._asdict() for part in joint_parts(gain)],
        "within": None if request.within is None else [list(ends) for ends in request.within],
        "turn": None if request.turn is None else vars(request.turn),
        "slow_down": request.slow_down,
        "size": gain.size,
        "unit": gain.unit,
        "lower_bound": gain.lower_bound if gain.lower_bound > 0.0 else None,
        "parts": [part._asdict() for part in change_parts(gain)],
        "before": _of_run(gain.before, proven_bound(gain.before)),
        "after": _of_run(gain.after, proven_after(gain)),
        "blocked": None if blocked is None else vars(blocked) | {"text": str(blocked)},
        "binding": list(gain.binding),
        "n_measured": gain.n_measured,
        "notes": list(notes),
    }


def _of_run(run: Run, proven: float | None) -> dict[str, Any]:
    return {
        "verdict": run.status,
        "verdict_text": run.verdict.headline(),
        "passed": run.passed,
        "fail": run.record.rule(run.verdict.worst.rule).limits.fail,
        "worst": _moment(run.verdict.worst),
        "proven": proven,
    }


def _moment(moment: Moment) -> dict[str, Any]:
    names = ("link", "obstacle", "time", "step", "between", "clearance", "rule", "touches")
    return {name: getattr(moment, name) for name in names}
