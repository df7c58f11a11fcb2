"""Scene `welding_cell`: an arm welds two parts on a turntable, around a pipe and along an edge past a clamp.

The program asks for lines, arcs and corner zones of the torch's tip; the table turns while the arm waits. Metres,
radians, seconds.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml

from scripts.makers.paths import JointTable, Table
from scripts.makers.program import ease

HOME = {
    "joint_1": 0.3, "joint_2": -0.8, "joint_3": 0.1, "joint_4": -0.3, "joint_5": 1.5, "joint_6": 0.9,
}  # fmt: skip
RADIUS, FOOT = 0.0415, 0.0015
"""Of the seam around the pipe, and how far the tip is above the sheet."""
EDGE = -0.1415
TILT = np.pi / 4
ENDS = np.radians([105.0, 255.0])

WAIT, TURN = 4.0, 3.0
"""[s] The arm at home, and in it the table's turn."""

TURNS_AT, END = 21.4, 46.0
"""[s] When it begins, and the last sample of the table."""

STEP = 0.1
"""[s] Between samples."""


def tables() -> dict[str, Table]:
    """The table's turn, half a turn while the arm waits at home."""
    times = np.arange(0.0, END + 1e-9, STEP)
    turn = np.pi * ease((times - TURNS_AT) / TURN)
    return {"turntable.csv": JointTable(("turn",), turn[:, None], STEP)}


def programs() -> dict[str, str]:
    """What the arm does, as the text of a file."""
    head = {
        "tool": {"link": "gripper", "xyz": [0.291, 0.0, 0.0]},
        "frames": {"seam": {"on": "world", "xyz": [0.56, 0.0, 0.541]}},
        "start": HOME,
        "step": 0.005,
    }
    lines = [f"{name}: {_flow(value)}" for name, value in head.items()]
    moves = [f"  - {_flow(move)[1:-1]}" for move in (*part(1), {"wait": WAIT}, *part(2))]
    return {"weld.yaml": "\n".join([*lines, "moves:", *moves, ""])}


def _flow(value: dict[str, Any] | float) -> str:
    """A value on one line of YAML."""
    return yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=10_000).split(
        "\n"
    )[0]


def part(n: int) -> list[dict[str, Any]]:
    """Around the pipe, along the edge before the clamp, over it, along the rest, and home."""
    first, last = ENDS
    return [
        ptp(around(first, 0.06), first - np.pi, f"above_{n}"),
        lin(around(first), f"pipe_{n}_begin", speed=0.1),
        arc(around(np.pi), around(last), f"pipe_{n}_end"),
        lin(around(last, 0.06), speed=0.1),
        lin((EDGE - 0.06, -0.06, 0.0715), f"over_edge_{n}", yaw=0.0),
        lin((EDGE - 0.02, -0.06, 0.0115), speed=0.1, zone=0.008),
        lin((EDGE, -0.06, -0.0085), f"edge_{n}_begin", speed=0.05),
        lin((EDGE, -0.035, -0.0085), f"edge_{n}_clamp", speed=0.01),
        lin((EDGE - 0.045, -0.035, 0.0365), speed=0.1, zone=0.008),
        lin((EDGE - 0.045, 0.035, 0.0365), f"past_clamp_{n}", speed=0.1, zone=0.008),
        lin((EDGE, 0.035, -0.0085), f"edge_{n}_again", speed=0.1),
        lin((EDGE, 0.06, -0.0085), f"edge_{n}_end", speed=0.01),
        lin((EDGE - 0.08, 0.06, 0.0715), speed=0.1),
        {"ptp": {"joints": HOME, "speed": 0.4}},
    ]


Place = tuple[float, float, float]


def around(angle: float, away: float = 0.0) -> Place:
    """A place at the foot of the pipe, or away from it and as much above."""
    size = RADIUS + away
    return size * np.cos(angle), size * np.sin(angle), FOOT + away


def target(place: Place, name: str = "", yaw: float | None = None) -> dict[str, Any]:
    """A target in the frame of the seam, the torch tilted by 45 degrees towards an angle."""
    found: dict[str, Any] = {"frame": "seam", "xyz": [round(float(one), 6) for one in place]}
    if name:
        found["name"] = name
    if yaw is not None:
        found["rpy"] = [0.0, round(TILT, 6), round(float(yaw), 6)]
    return found


def ptp(place: Place, yaw: float, name: str) -> dict[str, Any]:
    """A joint move to a pose."""
    return {"ptp": {"to": target(place, name, yaw), "speed": 0.4}}


def lin(
    place: Place,
    name: str = "",
    *,
    yaw: float | None = None,
    speed: float = 0.25,
    zone: float = 0.0,
) -> dict[str, Any]:
    """A straight line, with a corner zone at its end."""
    move: dict[str, Any] = {"to": target(place, name, yaw), "speed": speed}
    return {"lin": move | ({"zone": zone} if zone else {})}


def arc(via: Place, to: Place, name: str) -> dict[str, Any]:
    """An arc on which the torch keeps its angle to the seam."""
    through = {"frame": "seam", "xyz": [round(float(one), 6) for one in via]}
    return {
        "circ": {"via": through, "to": target(to, name), "orientation": "tangent", "speed": 0.02}
    }
