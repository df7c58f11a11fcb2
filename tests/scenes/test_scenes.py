"""The scenes and robots of the repository: consistent, smooth, and what their scripts make."""

from __future__ import annotations

import csv
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pybullet_data
import pytest
import trimesh
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
SCENES = sorted(path.parent for path in (ROOT / "scenes").glob("*/case.yaml"))
MESHES = sorted(ROOT.glob("robots/*/meshes/*.stl")) + sorted(ROOT.glob("scenes/*/meshes/*.stl"))


def case_of(scene: Path) -> dict:
    return YAML(typ="safe").load((scene / "case.yaml").read_text(encoding="utf-8"))


def joints_of(scene: Path) -> dict[str, ElementTree.Element]:
    given = case_of(scene)["robot"]["urdf"]
    stock = Path(pybullet_data.getDataPath())
    path = stock / given[14:] if given.startswith("pybullet_data:") else scene / given
    return {joint.get("name"): joint for joint in ElementTree.parse(path).getroot().iter("joint")}


def trajectory_of(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(encoding="utf-8") as lines:
        header, *rows = csv.reader(lines)
    return header, np.array(rows, dtype=float)


@pytest.fixture(scope="module")
def remade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("remade")
    for script in ("make_robot.py", "make_scenes.py"):
        subprocess.run(
            [sys.executable, ROOT / "scripts" / script, "--out", out], check=True, timeout=120
        )
    return out


def test_all_five_scenes_are_there() -> None:
    names = {scene.name for scene in SCENES}
    assert names >= {"box_box", "box_pipe", "iiwa_pipe_rack", "panda_shelf", "hot_cell"}
    assert all(case_of(scene)["name"] == scene.name for scene in SCENES)


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.name)
def test_trajectory_is_smooth_and_within_limits(scene: Path) -> None:
    header, rows = trajectory_of(scene / "trajectory.csv")
    joints = joints_of(scene)
    assert header[0] == "time" and len(rows) >= 200
    assert (np.diff(rows[:, 0]) > 0).all()
    speeds = np.diff(rows[:, 1:], axis=0) / np.diff(rows[:, 0])[:, None]
    for i, name in enumerate(header[1:]):
        limit = joints[name].find("limit")
        assert rows[:, 1 + i].min() >= float(limit.get("lower"))
        assert rows[:, 1 + i].max() <= float(limit.get("upper"))
        assert np.abs(speeds[:, i]).max() <= float(limit.get("velocity"))
    changes = np.abs(np.diff(speeds, axis=0)).max(axis=0)
    assert (changes <= 0.25 * np.abs(speeds).max(axis=0) + 1e-3).all()


@pytest.mark.parametrize("mesh", MESHES, ids=lambda path: path.stem)
def test_meshes_are_small_closed_and_outward(mesh: Path) -> None:
    assert mesh.stat().st_size < 200_000
    solid = trimesh.load(mesh)
    assert solid.is_watertight and solid.is_winding_consistent and solid.volume > 0
    assert solid.area_faces.min() > 0


@pytest.mark.parametrize("mesh", MESHES, ids=lambda path: path.stem)
def test_meshes_are_remade_byte_for_byte(mesh: Path, remade: Path) -> None:
    assert (remade / mesh.relative_to(ROOT)).read_bytes() == mesh.read_bytes()


def test_urdf_is_remade_byte_for_byte(remade: Path) -> None:
    path = "robots/heron6/heron6.urdf"
    assert (remade / path).read_bytes() == (ROOT / path).read_bytes()


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.name)
def test_trajectories_are_remade_to_their_last_digit(scene: Path, remade: Path) -> None:
    """One unit of the sixth decimal is left for another machine's rounding."""
    path = scene.relative_to(ROOT) / "trajectory.csv"
    header, rows = trajectory_of(scene / "trajectory.csv")
    header_again, rows_again = trajectory_of(remade / path)
    assert header == header_again
    assert np.abs(rows - rows_again).max() < 1.5e-6
