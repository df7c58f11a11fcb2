"""A box that slides past gates, each at a place along its way and with a gap to it: cases to find things in.

The box of `gantry_box` moves from x = -1 to 1 m in 2 s; a gate is a cube of 0.1 m beside its way. A gap is exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

import clearance as cl
from clearance.world.case import Case

ROBOT = Path(__file__).parents[2] / "robots" / "gantry_box" / "gantry_box.urdf"
RESTING = "slide_y: 0, slide_z: 0, yaw: 0, pitch: 0, roll: 0"
HALF = 0.06  # [m] of the box, beside its way

Gates = Mapping[str, tuple[float, float]]
"""By name where along the way it is [m], and its gap to the box [m]."""


def write_gates(
    folder: Path, gates: Gates, *extra: str, name: str = "gates", n_steps: int = 41,
    limits: str = "{fail: 0.005, warn: 0.02}",
) -> Path:  # fmt: skip
    """The case file of a box among gates; `extra` lines go into it."""
    folder.mkdir(parents=True, exist_ok=True)
    obstacles = [
        f"    - {{name: {gate}, box: {{size: [0.1, 0.1, 0.1]}}, "
        f"pose: {{xyz: [{x}, {HALF + gap + 0.05!r}, 0]}}}}"
        for gate, (x, gap) in gates.items()
    ]
    robot = f"robot: {{urdf: {ROBOT}, joints: {{{RESTING}}}}}"
    lines = [f"name: {name}", robot, "scene:", "  obstacles:", *obstacles]
    lines += ["trajectory: way.csv", f"limits: {limits}", *extra]
    path = folder / "case.yaml"
    path.write_text("\n".join(lines) + "\n")
    write_way(folder / "way.csv", np.linspace(-1.0, 1.0, n_steps))
    return path


def write_way(path: Path, x: Sequence[float] | np.ndarray) -> None:
    """The trajectory along x [m], over 2 s."""
    times = np.linspace(0.0, 2.0, len(x))
    rows = [f"{t:.6f},{place:.9f}" for t, place in zip(times, x, strict=True)]
    path.write_text("\n".join(["time,slide_x", *rows]) + "\n")


def load_gates(folder: Path, gates: Gates, *extra: str, **changes: object) -> Case:
    """The case of a box among gates."""
    return cl.load_case(write_gates(folder, gates, *extra, **changes))
