"""Runs that hit something: the scene that does, and a real case with an obstacle pushed into its way."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import clearance as cl
from clearance.geometry import boolean
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.report.records import moved
from tests.shared_cases import shared_case

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def shelf():
    return cl.check(cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml"), contact="every")


def confirm(run, row):
    """The overlap's translation of the link parts the pair; less than the lower bound does not."""
    case, motion = run.record.case, run.record.motions[0]
    body = next(b for b in motion.placed.robot.bodies if b.name == row.link)
    obstacle = next(o for o in case.obstacles if o.name == row.obstacle)
    i_link = motion.placed.robot.link_names.index(row.link)
    pose = motion.poses(row.step, row.step + 1)[0, i_link]

    def after(length):
        moved = pose.copy()
        moved[:3, 3] += length * row.known.direction
        there = obstacle.world_from_body
        return cl.distance(body.shape, obstacle.body.shape, pose_a=moved, pose_b=there)

    assert after(row.known.penetration * (1 + 1e-9) + 1e-12).distance > 0.0
    assert after(0.999 * row.known.penetration_at_least - 1e-12).contact


@pytest.mark.slow
def test_the_scene_in_contact_has_depth_and_volume_at_its_22_steps(shelf):
    rows = shelf.steps.to_pylist()
    hit = [row for row in rows if row["clearance"] == 0.0]
    assert [row["step"] for row in hit] == list(range(136, 158))
    assert all(row["penetration"] > 0.0 and row["volume"] > 0.0 for row in hit)
    clear = [row for row in rows if row["clearance"] > 0.0]
    assert {(row["penetration"], row["volume"]) for row in clear} == {(None, None)}


@pytest.mark.slow
def test_the_row_of_a_step_is_its_deepest_pair_and_the_sum_of_its_volumes(shelf):
    for step in (136, 148, 157):
        found = [row.known for row in shelf.record.contacts if row.step == step]
        row = shelf.steps.slice(step, 1).to_pylist()[0]
        assert row["penetration"] == max(one.penetration for one in found)
        assert row["volume"] == pytest.approx(sum(one.volume for one in found), rel=1e-15)
    assert {row.link for row in shelf.record.contacts} == {"panda_leftfinger", "panda_rightfinger"}


@pytest.mark.slow
def test_the_way_out_of_the_carton_is_back_out_of_the_shelf(shelf):
    deepest = shelf.record.deepest
    assert deepest.step == 148 and deepest.obstacle == "carton"
    face = [-np.cos(0.1), -np.sin(0.1), 0.0]  # the carton's front, turned by 0.1 rad
    assert deepest.known.direction == pytest.approx(face, abs=1e-9)
    assert deepest.known.penetration == pytest.approx(0.03206, abs=1e-5)
    assert deepest.known.penetration - deepest.known.penetration_at_least < 1e-4
    for row in shelf.record.contacts[::5]:
        confirm(shelf, row)


@pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")
def test_the_shared_region_lies_in_the_carton(shelf):
    carton = next(o for o in shelf.record.case.obstacles if o.name == "carton")
    low, high = carton.body.shape.bounds
    for row in shelf.record.contacts:
        corners = row.known.region.vertices - carton.world_from_body[:3, 3]
        inside = corners @ carton.world_from_body[:3, :3]
        assert (inside >= low - 1e-9).all() and (inside <= high + 1e-9).all()
        assert row.known.region.volume == pytest.approx(row.known.volume, rel=1e-12)


def test_what_stands_for_a_body_reaches_the_notes(shelf):
    told = [
        note
        for note in shelf.record.contact_notes
        if note.startswith("contact: panda_leftfinger: ")
    ]
    assert len(told) == 1 and "its hull stands for it" in told[0]


def test_a_touch_that_rounding_parts_in_another_frame_is_a_contact_of_depth_0():
    """A slider that ends exactly at a wall: contact in the world, whatever the wall's own frame says."""
    turned = np.eye(4)
    turned[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    run = cl.check(touching_case(turned))
    rows = run.steps.to_pylist()
    for row in rows:
        assert (row["clearance"] == 0.0) == (row["penetration"] is not None)
    deepest = [row["penetration"] for row in rows if row["clearance"] == 0.0]
    assert all(depth < 1e-12 for depth in deepest)


def touching_case(world):
    """A cube that slides along x up to a wall at 0.1, both turned and moved by `world`, to rounding."""
    joint = Joint("rail", JointKind.PRISMATIC, "ground", "cube", np.eye(4))
    body = Body("cube", cl.box((0.2, 0.2, 0.2)))
    robot = Robot("cart", ("ground", "cube"), (joint,), (body,))
    near = 0.1 * np.array([1.0, 1e-16, 0.0, -1e-16, -2e-16]) - 0.1
    path = Trajectory(np.arange(5.0), ("rail",), near[:, None])
    wall = Obstacle(Body("wall", cl.box((0.2, 1.0, 1.0))), world @ moved(0.2))
    return Case("touch", (PlacedRobot(robot, path, world),), (wall,))


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    """The Fetch in its cage, with the obstacle that it comes nearest to pushed 2 cm into it."""
    folder = shared_case("fetch_cage_planned").parent
    with (folder / "reference.csv").open(encoding="utf-8") as file:
        nearest = min(csv.DictReader(file), key=lambda row: float(row["clearance"]))
    points = [[float(nearest[f"{body}_{k}"]) for k in "xyz"] for body in ("link", "obstacle")]
    way = np.subtract(*points)
    given = YAML(typ="safe").load((folder / "case.yaml").read_text(encoding="utf-8"))
    robot = folder / given["robot"]["urdf"]
    given["robot"] |= {"urdf": str(robot), "package_dirs": [str(robot.parent)]}
    given["trajectory"]["file"] = str(folder / "trajectory.csv")
    obstacle = next(o for o in given["scene"]["obstacles"] if o["name"] == nearest["obstacle"])
    shift = way + 0.02 * way / np.linalg.norm(way)
    obstacle["pose"]["xyz"] = (np.array(obstacle["pose"]["xyz"]) + shift).tolist()
    path = tmp_path_factory.mktemp("pushed") / "case.yaml"
    with path.open("w", encoding="utf-8") as file:
        YAML(typ="safe").dump(given, file)
    return cl.check(cl.load_case(path)), int(nearest["step"]), nearest["link"], nearest["obstacle"]


@pytest.mark.shared
def test_a_real_case_pushed_into_an_obstacle(pushed):
    run, step, link, obstacle = pushed
    assert not run.passed
    here = [row for row in run.record.contacts if row.step == step]
    hit = next(row for row in here if (row.link, row.obstacle) == (link, obstacle))
    assert 0.0 < hit.known.penetration <= 0.0205
    assert hit.known.volume > 0.0
    for row in here:
        confirm(run, row)
    in_contact = {row.step for row in run.record.contacts}
    assert in_contact == set(np.flatnonzero(run.record.clearances == 0.0).tolist())
