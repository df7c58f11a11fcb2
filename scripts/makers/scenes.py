"""Makes the trajectories, programs, pose tables and meshes of scenes/; case files beside them are written by hand.

    python -m scripts.makers.scenes [--out REPOSITORY] [SCENE ...]

Run again, it writes the same bytes. Needs robots/heron6 (`robot`) and pybullet_data.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from scripts.makers.paths import write_table
from scripts.makers.scene_meshes import MESHES
from scripts.makers.scene_paths import PROGRAMS, TABLES
from scripts.makers.solids import write_stl


def make(root: Path, name: str) -> None:
    """Writes the files of one scene under `root`/scenes."""
    folder = root / "scenes" / name
    folder.mkdir(parents=True, exist_ok=True)
    for mesh_name, shape in MESHES.get(name, {}).items():
        write_stl(folder / "meshes" / f"{mesh_name}.stl", shape())
    for file_name, table in TABLES.get(name, dict)().items():
        write_table(folder / file_name, table)
    for file_name, text in PROGRAMS.get(name, dict)().items():
        (folder / file_name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(TABLES | PROGRAMS))
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2])
    arguments = parser.parse_args()
    for scene in arguments.scenes or TABLES | PROGRAMS:
        make(arguments.out, scene)
