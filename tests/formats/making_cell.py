"""A small cell of two arms, a door, a fixture that rides, and a part that is carried, with changes."""

from __future__ import annotations

from pathlib import Path

from clearance.case.case_file import load_case
from clearance.world.case import Case
from tests.formats.making import write_case

CELL = """name: cell
robots:
  - {name: left, urdf: arm.urdf, trajectory: path.csv}
  - {name: right, urdf: arm.urdf, base: {xyz: [6, 0, 0]}, joints: {shoulder: 0.2}}
scene:
  obstacles:
    - {name: door, box: {size: [0.1, 0.1, 1]}, moves: door.csv}
    - {name: fixture, box: {size: [0.1, 0.1, 0.1]}, on: left/base, pose: {xyz: [0, 5, 0]}}
    - {name: workpiece, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [2, 2, 0]}}
    - {name: post, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [2, 0, 2]}}
carry:
  - {part: workpiece, by: left/tip, from: 0.25, until: 0.75, touch: ["left/*"]}
limits:
  fail: 0.005
  warn: 0.02
  rules:
    - {name: at the fixture, between: ["left/*", fixture], fail: 0.001, from: 0.5, until: 1}
    - {between: [workpiece, "*"], while_carried: workpiece, warn: 0.03}
allow:
  - [left/base, post]
  - {between: [door, post], until: 0.5}
"""

DOOR = """time,x,y,z,qx,qy,qz,qw
0,4,0,0,0,0,0,1
0.4,4,0.5,0,0,0,0.6,0.8
1,4,1,0,0,0,1,0
"""


def write_cell(folder: Path, *changes: str, door: str | bytes = DOOR, **files: bytes | str) -> Path:
    """The cell in `folder`, with texts (old, new, old, new, ...) replaced."""
    text = CELL
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text, old
        text = text.replace(old, new)
    return write_case(folder, text, door__csv=door, **files)


def load_cell(folder: Path, *changes: str, **files: bytes | str) -> Case:
    """The cell, loaded."""
    return load_case(write_cell(folder, *changes, **files))
