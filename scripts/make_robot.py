"""Makes robots/heron6: a six-axis hot-cell manipulator with a two-finger gripper, meshes and URDF.

    python scripts/make_robot.py [--out REPOSITORY]

Run again, it writes the same bytes. The shapes are in makers/heron6_parts.py.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from makers.heron6_joints import JOINTS
from makers.heron6_parts import PARTS
from makers.solids import write_stl
from makers.urdf import urdf_text


def make(root: Path) -> None:
    """Writes robots/heron6 under `root`."""
    folder = root / "robots" / "heron6"
    for part in PARTS:
        write_stl(folder / "meshes" / f"{part.name}.stl", part.solid)
    (folder / "heron6.urdf").write_text(urdf_text("heron6", PARTS, JOINTS), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1])
    make(parser.parse_args().out)
