"""The scenes and robots of the repository: what their scripts make, small, their meshes closed."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

ROOT = Path(__file__).parents[2]
MESHES = [*ROOT.glob("robots/*/meshes/*.stl"), *ROOT.glob("scenes/*/meshes/*.stl")]
PROGRAMS = [*ROOT.glob("scenes/*/weld.yaml"), *ROOT.glob("scenes/*/*.mod")]
ARM = ROOT / "robots" / "heron6" / "heron6.urdf"


def name_of(path: Path) -> str:
    return f"{path.parent.name}-{path.stem}"


@pytest.fixture(scope="module")
def remade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("remade")
    for maker in ("robot", "scenes"):
        command = [sys.executable, "-m", f"scripts.makers.{maker}", "--out", out]
        subprocess.run(command, check=True, timeout=120, cwd=ROOT)
    return out


@pytest.mark.parametrize("mesh", sorted(MESHES), ids=name_of)
def test_meshes_are_small_closed_and_outward(mesh: Path) -> None:
    assert mesh.stat().st_size < 200_000
    solid = trimesh.load(mesh)
    assert solid.is_watertight and solid.is_winding_consistent and solid.volume > 0
    assert solid.area_faces.min() > 0


@pytest.mark.cold
@pytest.mark.parametrize("path", sorted([*MESHES, *PROGRAMS, ARM]), ids=name_of)
def test_files_are_remade_byte_for_byte(path: Path, remade: Path) -> None:
    assert (remade / path.relative_to(ROOT)).read_bytes() == path.read_bytes()


def table_of(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(encoding="utf-8") as lines:
        header, *rows = csv.reader(lines)
    return header, np.array(rows, dtype=float)


@pytest.mark.cold
def test_tables_are_remade_to_their_last_digit(remade: Path) -> None:
    """One unit of the sixth decimal is left for another machine's rounding."""
    tables = sorted(remade.glob("scenes/*/*.csv"))
    assert len(tables) > 10
    for again in tables:
        header, rows = table_of(ROOT / again.relative_to(remade))
        header_again, rows_again = table_of(again)
        assert header == header_again and np.abs(rows - rows_again).max() < 1.5e-6, again
