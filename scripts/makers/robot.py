"""Makes robots/heron6: a six-axis hot-cell manipulator with a two-finger gripper, meshes and URDF.

The same files go into clearance/demo, which every wheel brings.

    python -m scripts.makers.robot [--out REPOSITORY]

Run again, it writes the same bytes. The shapes are in `heron6_parts`.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from scripts.makers.heron6_joints import JOINTS
from scripts.makers.heron6_parts import PARTS
from scripts.makers.solids import write_stl
from scripts.makers.urdf import urdf_text


def make(root: Path) -> None:
    """Writes robots/heron6 and its copy in clearance/demo under `root`."""
    for above in ("robots", "clearance/demo"):
        folder = root / above / "heron6"
        for part in PARTS:
            write_stl(folder / "meshes" / f"{part.name}.stl", part.solid)
        (folder / "heron6.urdf").write_text(urdf_text("heron6", PARTS, JOINTS), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2])
    make(parser.parse_args().out)
