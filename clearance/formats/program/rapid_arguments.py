"""Speeds and zones of RAPID's moves, with the arguments of a move that replace them.

Source: ABB, Technical reference manual, RAPID instructions: `MoveL`, `speeddata`, `zonedata`.
"""

from __future__ import annotations

import math
from typing import Any

from clearance.errors import BadProgram
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Call, number
from clearance.formats.program.rapid_data import record


def speed_of(value: list[float], call: Call, run: Execution) -> tuple[float, float, float | None]:
    """[m/s] and [rad/s] of the tool, and the time that the move asks for in their place [s]."""
    tcp, turn, *_ = record(value, 4, is_flagged=False)
    if "v" in call.named:
        tcp = number(run.evaluated(call.named["v"]), call.line, "V")
    time = None
    if "t" in call.named:
        time = number(run.evaluated(call.named["t"]), call.line, "T")
        if not time > 0.0:
            raise BadProgram(f"T is {time:g} s", valid="more than 0")
    return 1e-3 * tcp, math.radians(turn), time


def zone_of(value: list[Any], call: Call, run: Execution) -> tuple[float, float]:
    """[m] The radii of a zone for the tool's point and for its orientation; 0 where the tool stops."""
    stops, point, turn, *_ = record(value, 7, is_flagged=True)
    if stops:
        return 0.0, 0.0
    if "z" in call.named:
        point = number(run.evaluated(call.named["z"]), call.line, "Z")
    if point < 0.0 or turn < 0.0:
        raise BadProgram(f"a zone of {point:g} mm", valid="0 or more")
    return 1e-3 * point, 1e-3 * turn
