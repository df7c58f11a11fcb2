"""The scenes and robots of the repository: consistent, smooth, and what their scripts make."""

from __future__ import annotations

import csv
import functools
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


@functools.cache
def case_of(scene: Path) -> dict:
    return YAML(typ="safe").load((scene / "case.yaml").read_text(encoding="utf-8"))


def joint_tables() -> list[tuple[Path, dict]]:
    """Each table of joints of a scene, and the robot in its case file that follows it."""
    found = []
    for scene in SCENES:
        case = case_of(scene)
        for robot in case.get("robots") or [case["robot"]]:
            asked = robot.get("trajectory") or case["trajectory"]
            if isinstance(asked, str) or "file" in asked:
                path = scene / (asked if isinstance(asked, str) else asked["file"])
                found.append((path, robot))
    return found


def pose_tables() -> list[Path]:
    """Each table of poses of a scene."""
    moves = [
        scene / (asked if isinstance(asked, str) else asked["file"])
        for scene in SCENES
        for obstacle in case_of(scene)["scene"]["obstacles"]
        if (asked := obstacle.get("moves"))
    ]
    return sorted(set(moves))


def name_of(value: object) -> str:
    return f"{value.parent.name}-{value.stem}" if isinstance(value, Path) else ""


def joints_of(scene: Path, given: str) -> dict[str, ElementTree.Element]:
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
    for maker in ("robot", "scenes"):
        command = [sys.executable, "-m", f"scripts.makers.{maker}", "--out", out]
        subprocess.run(command, check=True, timeout=120, cwd=ROOT)
    return out


def test_all_scenes_are_there() -> None:
    names = {scene.name for scene in SCENES}
    assert names >= {"box_box", "box_pipe", "iiwa_pipe_rack", "panda_shelf", "hot_cell"}
    assert names >= {"dual_arm_handover", "turntable_cell", "door_and_arm"}
    assert names >= {"welding_cell", "palletising_cell"}
    assert all(case_of(scene)["name"] == scene.name for scene in SCENES)


@pytest.mark.parametrize(("path", "robot"), joint_tables(), ids=name_of)
def test_trajectory_is_smooth_and_within_limits(path: Path, robot: dict) -> None:
    header, rows = trajectory_of(path)
    joints = joints_of(path.parent, robot["urdf"])
    assert header[0] == "time" and len(rows) >= 100
    assert (np.diff(rows[:, 0]) > 0).all()
    speeds = np.diff(rows[:, 1:], axis=0) / np.diff(rows[:, 0])[:, None]
    for i, name in enumerate(header[1:]):
        limit = joints[name].find("limit")
        assert rows[:, 1 + i].min() >= float(limit.get("lower"))
        assert rows[:, 1 + i].max() <= float(limit.get("upper"))
        assert np.abs(speeds[:, i]).max() <= float(limit.get("velocity"))
    changes = np.abs(np.diff(speeds, axis=0)).max(axis=0)
    assert (changes <= 0.25 * np.abs(speeds).max(axis=0) + 1e-3).all()


@pytest.mark.parametrize("path", pose_tables(), ids=name_of)
def test_poses_are_in_order_and_of_unit_quaternions(path: Path) -> None:
    header, rows = trajectory_of(path)
    assert header == ["time", "x", "y", "z", "qx", "qy", "qz", "qw"]
    assert (np.diff(rows[:, 0]) > 0).all()
    assert np.abs(np.linalg.norm(rows[:, 4:], axis=1) - 1.0).max() < 2e-9


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.name)
def test_scenes_are_small(scene: Path) -> None:
    assert sum(path.stat().st_size for path in scene.rglob("*") if path.suffix != ".png") < 1e6


@pytest.mark.parametrize("mesh", MESHES, ids=lambda path: path.stem)
def test_meshes_are_small_closed_and_outward(mesh: Path) -> None:
    assert mesh.stat().st_size < 200_000
    solid = trimesh.load(mesh)
    assert solid.is_watertight and solid.is_winding_consistent and solid.volume > 0
    assert solid.area_faces.min() > 0


@pytest.mark.cold
@pytest.mark.parametrize("mesh", MESHES, ids=lambda path: path.stem)
def test_meshes_are_remade_byte_for_byte(mesh: Path, remade: Path) -> None:
    assert (remade / mesh.relative_to(ROOT)).read_bytes() == mesh.read_bytes()


@pytest.mark.cold
def test_urdf_is_remade_byte_for_byte(remade: Path) -> None:
    path = "robots/heron6/heron6.urdf"
    assert (remade / path).read_bytes() == (ROOT / path).read_bytes()


PROGRAMS = [*ROOT.glob("scenes/*/weld.yaml"), *ROOT.glob("scenes/*/*.mod")]


@pytest.mark.cold
@pytest.mark.parametrize("path", PROGRAMS, ids=name_of)
def test_programs_are_remade_byte_for_byte(path: Path, remade: Path) -> None:
    assert (remade / path.relative_to(ROOT)).read_bytes() == path.read_bytes()


TABLES = sorted({path for path, _ in joint_tables()} | set(pose_tables()))


@pytest.mark.cold
@pytest.mark.parametrize("path", TABLES, ids=name_of)
def test_tables_are_remade_to_their_last_digit(path: Path, remade: Path) -> None:
    """One unit of the sixth decimal is left for another machine's rounding."""
    header, rows = trajectory_of(path)
    header_again, rows_again = trajectory_of(remade / path.relative_to(ROOT))
    assert header == header_again
    assert np.abs(rows - rows_again).max() < 1.5e-6
