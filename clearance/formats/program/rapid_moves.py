"""Moves of RAPID: what their targets are called, how their zones turn, and which arguments are read.

Not for: making them (`rapid`).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np

from clearance.errors import BadProgram
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerWait,
    PoseTarget,
)
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Call, Expression, Name, Part, calls_in
from clearance.formats.program.rapid_words import MoveRule


def require_plain(call: Call, rule: MoveRule) -> None:
    """Nothing, if a move has all its arguments, and none that changes its way.

    Raises:
        BadProgram: it has not.
    """
    for name in ("corr", "track", "weave", "sync"):
        if name in call.named:
            raise BadProgram(f"\\{name} changes the way", valid="take the argument out")
    if len(call.args) <= rule.tool:
        fault = f"{call.name} has {len(call.args)} of its arguments"
        raise BadProgram(fault, valid="target, speed, zone and tool")


def name_of(one: Expression, run: Execution) -> str:
    """The name of a target: that of the datum that it is made of, within the functions that move it."""
    if isinstance(one, Part):
        return name_of(one.of, run)
    if not isinstance(one, Call):
        return str(one.name).rpartition(".")[2] if isinstance(one, Name) else ""
    name = name_of(one.args[0], run) if one.args else ""
    if not name or one.name not in ("Offs", "RelTool"):
        return name
    shown = [_number(part, run) for part in one.args[1:]]
    turned = [f"\\{key.title()}:={_number(part, run)}" for key, part in one.named.items()]
    return f"{one.name}({', '.join([name, *shown, *turned])})"


def _number(one: Expression, run: Execution) -> str:
    """A number in words; what a function says, which may change something, is left out."""
    value = "…" if any(True for _ in calls_in(one)) else run.evaluated(one)
    return f"{value:g}" if isinstance(value, int | float) else "…"


def on_cycles(moves: list[ControllerMove | ControllerWait]) -> list[str]:
    """A line on the way back that a controller in cycles makes, if the program ends elsewhere than it begins."""
    ends = [one.to for one in moves if isinstance(one, ControllerMove)]
    if not ends or (isinstance(ends[0], AxisTarget) and ends[0] == ends[-1]):
        return []
    return [
        "the procedure runs once: in cycles the way from its end to its beginning is not measured"
    ]


def with_zones(
    moves: list[ControllerMove | ControllerWait], zones: dict[int, tuple[float, float]]
) -> list[ControllerMove | ControllerWait]:
    """Moves with the radius of their zone: that of the tool's point; where the tool turns before or after the
    larger one of its orientation. A wait turns nothing.
    """
    found = list(moves)
    for i, (point, turn) in zones.items():
        before = (move for move in reversed(moves[:i]) if isinstance(move, ControllerMove))
        one, around = moves[i], [*islice(before, 1), *moves[i : i + 2]]
        turns = [
            move.to.pose[:3, :3]
            if isinstance(move, ControllerMove) and isinstance(move.to, PoseTarget)
            else None
            for move in around
        ]
        first = turns[0]
        same = first is not None and all(
            one is not None and np.abs(one - first).max() < 1e-9 for one in turns
        )
        assert isinstance(one, ControllerMove)
        found[i] = replace(one, zone=point if same and len(turns) == 3 else max(point, turn))
    return found
