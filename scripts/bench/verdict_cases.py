"""Small cases that end in every kind of verdict: a box that slides past gates, and what else a case may say.

Each is a case file and the options of `clearance check`. Not for: speed, and how a verdict comes about.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh

GANTRY = Path(__file__).resolve().parents[2] / "robots" / "gantry_box" / "gantry_box.urdf"

HALF = 0.06
"""[m] Of the box, beside its way."""


class VerdictCase(NamedTuple):
    """What is asked for.

    Attributes:
        gaps: [m] of the gates, each 0.1 m wide beside the box's way along x.
        lines: of the case file, beside robot, gates and trajectory. obstacles: further ones, a line each.
        way: (n,) the samples of x [m], 2 s in all. options: of the command.
    """

    gaps: Sequence[float] = (0.1,)
    lines: Sequence[str] = ()
    options: Sequence[str] = ()
    obstacles: Sequence[str] = ()
    way: Sequence[float] = tuple(np.linspace(-1.0, 1.0, 21).tolist())


WAIVED = "waivers: [waivers.yaml]"
"""The first gate may come as near as 2 mm, to the end of 2026."""

WAIVERS = "- {between: [box, gate_0], at_least: 0.002, until: 2026-12-31, reason: it gives way, by: N. N.}\n"
IN_TIME, TOO_LATE = ("--today", "2026-12-31"), ("--today", "2027-01-01")
ERRORS = "tolerance: {joints: {all: 0.001}, base: {xyz: 0.002}}"
MOVES = "{name: door, box: {size: [0.1, 0.1, 0.1]}, moves: door.csv}"
HOLED = "{name: holed, mesh: {file: holed.stl}}"
SCAN = "{name: scan, points: {file: scan.csv, radius: 0.005}, pose: {xyz: [0, 0.2, 0]}}"
PAST_THE_END = tuple(np.linspace(-1.0, 1.6, 21).tolist())

TWO = """robots:
  - {name: a, urdf: GANTRY, trajectory: way.csv}
  - {name: b, urdf: GANTRY, base: {xyz: [0.5, 0.123, 0]}, trajectory: way.csv}
scene: {obstacles: []}
limits: {fail: 0.005, warn: 0.02}
clock: CLOCK
"""
"""Two boxes, one 0.3 m behind the other, which can be 3 mm beside it only at other times."""

CASES: dict[str, VerdictCase | str] = {
    "clear": VerdictCase(),
    "near": VerdictCase((0.01, 0.1)),
    "violated": VerdictCase((0.003, 0.1)),
    "violated between samples": VerdictCase((0.003,), way=(-1.0, 1.0)),
    "samples only": VerdictCase((0.003,), way=(-1.0, 1.0), options=("--samples-only",)),
    "at the limit": VerdictCase((0.0625 - HALF,), options=("--fail-mm", "2.5")),
    "touching": VerdictCase((0.0,)),
    "contact": VerdictCase((-0.01,)),
    "contact, every step": VerdictCase((-0.01,), options=("--contact", "every")),
    "contact, no depth": VerdictCase((-0.01,), options=("--contact", "none")),
    "allowed": VerdictCase((-0.01, 0.1), lines=("allow: [[box, gate_0]]",)),
    "nothing to measure": VerdictCase((0.1,), lines=('allow: [[box, "gate_*"]]',)),
    "waived": VerdictCase((0.003,), lines=(WAIVED,), options=IN_TIME),
    "waiver expired": VerdictCase((0.003,), lines=(WAIVED,), options=TOO_LATE),
    "waiver unused": VerdictCase((0.1,), lines=(WAIVED,), options=IN_TIME),
    "nearer than waived": VerdictCase((0.001,), lines=(WAIVED,), options=IN_TIME),
    "tolerances proven": VerdictCase((0.05,), lines=(ERRORS,)),
    "tolerances not proven": VerdictCase((0.007,), lines=(ERRORS,)),
    "tolerances not proven, accepted": VerdictCase(
        (0.007,), lines=(ERRORS,), options=("--unproven-ok",)
    ),
    "clocks tied": TWO.replace("CLOCK", "common"),
    "clocks not tied": TWO.replace("CLOCK", "unsynchronised"),
    "clocks within a slack": TWO.replace("CLOCK", "{slack: 0.1}"),
    "obstacle that moves": VerdictCase(obstacles=(MOVES,)),
    "scan": VerdictCase(obstacles=(SCAN,)),
    "inside a holed mesh": VerdictCase(obstacles=(HOLED,)),
    "inside a holed mesh, accepted": VerdictCase(obstacles=(HOLED,), lines=("accept: [inside]",)),
    "beyond joint limits": VerdictCase(way=PAST_THE_END),
    "suspect units": VerdictCase(way=tuple(np.linspace(-1000.0, 1000.0, 21).tolist())),
    "unknown key": VerdictCase(lines=("alow: []",)),
    "no such mesh": VerdictCase(obstacles=("{name: lost, mesh: {file: lost.stl}}",)),
    "not a number": VerdictCase(way=(-1.0, float("nan"), 1.0)),
    "least moment": VerdictCase((0.01, 0.1), options=("--need", "minimum")),
    "every pair": VerdictCase((0.01, 0.1), options=("--need", "pairs")),
}


def write_verdict_case(folder: Path, name: str) -> list[str]:
    """Writes the files of a case and gives the arguments of `clearance check`."""
    asked = CASES[name]
    folder.mkdir(parents=True)
    asked, text = (VerdictCase(), asked) if isinstance(asked, str) else (asked, _text_of(asked))
    (folder / "case.yaml").write_text(text.replace("GANTRY", str(GANTRY)), encoding="utf-8")
    _write_way(folder / "way.csv", asked.way)
    poses = "time,x,y,z,qx,qy,qz,qw\n0,0,0.3,0,0,0,0,1\n2,0,0.12,0,0,0,0,1\n"
    (folder / "door.csv").write_text(poses, encoding="utf-8")
    points = "\n".join(["x,y,z", *(f"{x:.3f},0,0" for x in np.linspace(-0.2, 0.2, 9))])
    (folder / "scan.csv").write_text(points + "\n", encoding="utf-8")
    (folder / "waivers.yaml").write_text(WAIVERS, encoding="utf-8")
    shell = trimesh.creation.icosphere(subdivisions=3, radius=3.0)
    trimesh.Trimesh(shell.vertices, shell.faces[60:]).export(folder / "holed.stl")
    return [str(folder / "case.yaml"), *asked.options]


def _text_of(asked: VerdictCase) -> str:
    places = np.linspace(-0.5, 0.5, len(asked.gaps) + 2)[1:-1]
    gates = [
        f"{{name: gate_{i}, box: {{size: [0.1, 0.1, 0.1]}}, pose: {{xyz: [{x!r}, {HALF + 0.05 + gap!r}, 0]}}}}"
        for i, (x, gap) in enumerate(zip(places.tolist(), asked.gaps, strict=True))
    ]
    lines = ["robot: {urdf: GANTRY}", "scene:", "  obstacles:"]
    lines += [f"    - {row}" for row in (*gates, *asked.obstacles)]
    lines += ["trajectory: way.csv", "limits: {fail: 0.005, warn: 0.02}", *asked.lines]
    return "\n".join(lines) + "\n"


def _write_way(path: Path, way: Sequence[float]) -> None:
    times = np.linspace(0.0, 2.0, len(way))
    rows = [f"{t:.6f},{x!r}" for t, x in zip(times, way, strict=True)]
    path.write_text("\n".join(["time,slide_x", *rows]) + "\n", encoding="utf-8")
