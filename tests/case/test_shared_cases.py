"""The four real cases load unchanged, and hold what an independent reading of the same files finds."""

from pathlib import Path

import numpy as np
import pytest

from clearance.case.case_file import load_case
from tests.shared_cases import SHARED_CASES as CASES

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not CASES.is_dir(), reason="shared/cases is not beside the checkout"),
]

# links measured, triangles of their meshes, obstacles, triangles of flat obstacles, steps
EXPECTED = {
    "panda_bookshelf_thin_planned": (11, 3472, 21, 132, 300),
    "kuka_iiwa_valve_wall": (7, 11720, 9, 49303, 300),
    "lbr_puzzle_grinder": (9, 12644, 2, 1530, 437),
    "fetch_cage_planned": (14, 1442, 8, 96, 300),
}

MESHES = sorted(p for p in CASES.rglob("*") if p.suffix.lower() in (".stl", ".obj"))


def rows_of(path: Path) -> np.ndarray:
    """(m, 3, 3) corners of the triangles in a mesh file, by a reader of ten lines that only these files need."""
    if path.suffix.lower() == ".stl":
        facets = np.frombuffer(path.read_bytes()[84:], np.uint8).reshape(-1, 50)
        return np.ascontiguousarray(facets[:, 12:48]).view("<f4").reshape(-1, 3, 3).astype(float)
    words = [line.split() for line in path.read_text().splitlines() if line.strip()]
    points = np.array([[float(x) for x in w[1:4]] for w in words if w[0] == "v"])
    faces = [[int(x.split("/")[0]) - 1 for x in w[1:]] for w in words if w[0] == "f"]
    assert all(len(face) == 3 for face in faces)
    return points[np.array(faces)]


@pytest.mark.parametrize("name", EXPECTED)
def test_a_shared_case_is_what_its_table_says(name):
    case = load_case(CASES / name / "case.yaml")
    placed = case.robots[0]
    n_links, n_robot, n_obstacles, n_flat, n_steps = EXPECTED[name]
    bodies = [body for body in placed.robot.bodies if body.name not in placed.exclude_links]
    assert (len(bodies), len(case.obstacles)) == (n_links, n_obstacles)
    in_file = {str(p.relative_to(CASES)): len(rows_of(p)) for p in MESHES}

    def count(origin: str) -> int:
        parts = [part.removeprefix("../") for part in origin.split(", ")]
        return sum(in_file.get(part, 12 if part == "box" else 0) for part in parts)

    assert sum(count(body.origin) for body in bodies) == n_robot
    assert sum(count(obstacle.body.origin) for obstacle in case.obstacles) == n_flat
    trajectory = placed.trajectory
    assert trajectory.n_steps == n_steps
    assert set(trajectory.joint_names) == {joint.name for joint in placed.robot.moving_joints} or (
        "stay at 0" in " ".join(case.notes)
    )
    table = np.loadtxt(CASES / name / "trajectory.csv", delimiter=",", skiprows=1)
    assert (trajectory.times == table[:, 0]).all() and (trajectory.positions == table[:, 1:]).all()
