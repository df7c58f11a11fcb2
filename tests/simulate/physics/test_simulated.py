"""Simulated motion of several robots, on mounts and with parts in hand: as alone, or told, or refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.simulate.physics.bullet import simulated_motion
from clearance.simulate.physics.course import notices_on_limits
from clearance.simulate.physics.motions import simulated_motions
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing, Window
from clearance.world.trajectory import Trajectory
from tests.made_cases import at
from tests.simulate.physics.test_bullet import TILTED, about_y, cart, placed_robot, rail_up

PLATE = """<robot name="plate">
  <link name="ground"/>
  <link name="top"><inertial><mass value="5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="tilt" type="revolute"><parent link="ground"/><child link="top"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="5000" velocity="2"/></joint></robot>"""


def named(placed: PlacedRobot, name: str, **changes) -> PlacedRobot:
    return replace(placed, robot=replace(placed.robot, name=name), **changes)


def plate(tmp_path, angles) -> PlacedRobot:
    path = tmp_path / "plate.urdf"
    path.write_text(PLATE)
    times = np.linspace(0.0, 1.0, len(angles))
    return placed_robot(path, Trajectory(times, ("tilt",), np.array(angles, float)[:, None]))


def post(**changes) -> Obstacle:
    return Obstacle(Body("post", cl.box((0.1, 0.1, 0.1))), at(0.0, 0.0, 3.0), **changes)


def test_each_of_several_robots_moves_by_its_own_table_as_it_would_alone(tmp_path):
    one, two = cart(tmp_path), cart(tmp_path, effort=0.0)
    slow = Trajectory(np.array([0.0, 2.0]), ("rail",), np.array([[0.0], [0.3]]))
    two = named(two, "two", trajectory=slow, world_from_base=at(0.0, 2.0))
    found = simulated_motions(Case("both", (one, two), (post(),)))
    for motion, placed in zip(found, (one, two), strict=True):
        alone = simulated_motion(placed)
        assert np.array_equal(motion.positions, alone.positions)
        assert np.array_equal(motion.times, alone.times)
    assert (
        found[1].notes[0].startswith("simulated motion of two: the URDF limits no effort of rail")
    )


def test_a_robot_on_what_stands_moves_as_it_would_standing_there(tmp_path):
    placed = cart(tmp_path, effort=20.0)
    there = replace(placed, world_from_base=TILTED)
    table = Obstacle(Body("table", cl.box((0.1, 0.1, 0.1))), TILTED)
    on = replace(placed, mount=Mount("table"))
    (found,) = simulated_motions(Case("made", (on,), (table,)))
    (standing,) = simulated_motions(Case("made", (there,), (table,)))
    assert np.array_equal(found.positions, standing.positions)
    assert found.placed is on and found.notes == standing.notes


@pytest.mark.slow
def test_gravity_is_that_of_the_base_and_turns_with_it(tmp_path):
    """A weak rail slides down as it does on a base that stands at the angle, until the base grows steeper."""
    weak = cart(tmp_path, effort=1.0)
    angles = np.concatenate([np.full(10, 0.7), np.linspace(0.7, 1.2, 10)])
    on = replace(weak, mount=Mount("plate/top"))
    _, found = simulated_motions(Case("made", (plate(tmp_path, angles), on), (post(),)))
    standing = simulated_motion(replace(weak, world_from_base=at(turned=about_y(0.7))))
    early = found.times <= 0.45
    assert found.positions[early] == pytest.approx(standing.positions[early], abs=2e-3)
    assert abs(standing.positions[early][-1, 0]) > 0.1
    n = min(len(found.positions), len(standing.positions))
    assert np.abs(found.positions[:n] - standing.positions[:n]).max() > 1e-2
    assert any("acceleration of its base on plate/top is not felt" in n for n in found.notes)


@pytest.mark.slow
def test_a_table_that_is_followed_faster_is_simulated_faster(tmp_path):
    placed = cart(tmp_path, effort=3.0)
    asked = placed.given_trajectory
    quick = replace(asked, times=asked.times / 2.0)
    (found,) = simulated_motions(
        Case("made", (replace(placed, timing=Timing(start=5.0, rate=2.0)),), (post(),))
    )
    wanted = simulated_motion(replace(placed, trajectory=quick))
    assert found.positions == pytest.approx(wanted.positions, abs=1e-9)
    assert found.times == pytest.approx(2.0 * wanted.times)


def test_what_is_on_a_robot_has_no_weight_and_that_is_told(tmp_path):
    one = cart(tmp_path)
    rider = named(one, "rider", mount=Mount("cart/slider", at(0.0, 1.0)))
    lamp = Obstacle(Body("lamp", cl.box((0.1, 0.1, 0.1))), mount=Mount("rider/slider"))
    case = Case(
        "made", (one, rider), (post(), lamp), carries=(Carry("post", "rider/slider", Window(0.2)),)
    )
    notes = [motion.notes for motion in simulated_motions(case)]
    assert notes[0] == (
        "simulated motion of cart: the weight of rider, which it carries, is not felt",
    )
    assert any("simulated motion of rider: the weight of lamp, post" in note for note in notes[1])


def test_a_robot_without_a_trajectory_stands_and_that_is_told(tmp_path):
    still = named(cart(tmp_path), "still", trajectory=None, world_from_base=at(0.0, 2.0))
    _, found = simulated_motions(Case("made", (cart(tmp_path), still), (post(),)))
    assert found.n_steps == 1 and "stands as given and is not simulated" in found.notes[0]


def test_a_robot_whose_file_nobody_gives_is_refused_with_the_way_out(tmp_path):
    made = replace(cart(tmp_path), urdf_path="")
    with pytest.raises(
        BadInput, match=r"robot made in Python are not known; PlacedRobot\(…, urdf_path=FILE\)"
    ):
        simulated_motions(Case("made", (made,), (post(),)))


@pytest.mark.parametrize("kind", ["robots", "rides", "moves", "carried", "loops"])
def test_what_cannot_be_simulated_is_refused_in_one_line(tmp_path, kind):
    one = cart(tmp_path)
    two = named(one, "two", world_from_base=at(0.0, 2.0))
    turned = np.array([[0.0, 0, 0, 1]] * 2)
    table = PoseTable(np.array([0.0, 1.0]), np.zeros((2, 3)), turned)
    door = Obstacle(Body("door", cl.box((0.1, 0.1, 0.1))), moves=table)
    rides = Obstacle(Body("lamp", cl.box((0.1, 0.1, 0.1))), mount=Mount("slider"))
    carry = (Carry("post", "slider", Window(0.2)),)
    loop = replace(one, timing=Timing(after="loop"))
    case, said = {
        "robots": (
            Case("made", (one, two), (post(),)),
            "2 robots: in simulated motion robots do not",
        ),
        "rides": (Case("made", (one,), (post(), rides)), "lamp would not push back"),
        "moves": (Case("made", (one,), (post(), door)), "door would not push back"),
        "carried": (Case("made", (one,), (post(),), carries=carry), "post would not push back"),
        "loops": (Case("made", (loop,), (post(), door)), "robot 'cart': after: loop in simulated"),
    }[kind]
    with pytest.raises(BadInput) as caught:
        simulated_motions(replace(case, contact_response=kind != "loops"))
    assert said in str(caught.value)


def test_a_whole_run_of_two_robots_and_a_part_in_hand(tmp_path):
    one = cart(tmp_path)
    two = named(one, "two", world_from_base=at(0.0, 2.0), timing=Timing(start=0.5))
    case = Case("made", (one, two), (post(),), carries=(Carry("post", "two/slider", Window(0.7)),))
    record = cl.check(case, motion="simulated", certify=False).record
    assert record.steps.num_rows == len(record.timeline.times)
    assert record.timeline.times[-1] == pytest.approx(1.75)
    assert any("of two: the weight of post" in note for note in record.notes)
    assert record.steps["tracking_error"].to_numpy().max() > 0.0


@pytest.mark.slow
def test_joint_limits_are_those_of_the_simulated_motion(tmp_path):
    """A rail that gravity pulls, whose motor is too weak to brake: faster than its 2 m/s."""
    case = Case("falls", (rail_up(cart(tmp_path, effort=1e-6)),), (post(),))
    (motion,) = simulated_motions(case)
    texts = [one.text for one in motion.notices if one.kind == "limits"]
    assert all(text.startswith("simulated motion: ") for text in texts)
    assert any("joint 'rail' moves at up to" in text for text in texts)
    record = cl.check(case, motion="simulated", certify=False).record
    assert {*motion.notices} <= {*record.notices}


def test_the_headline_says_that_the_motion_is_simulated(tmp_path):
    case = Case("made", (cart(tmp_path),), (post(),), contact_response=True)
    run = cl.check(case, motion="simulated")
    assert "in simulated motion" in run.verdict.headline() and run.passed
    plain = cl.check(case)
    assert "simulated" not in plain.verdict.headline()
    assert any("contact_response has no effect" in note for note in plain.record.notes)


def test_a_speed_that_drives_keep_but_for_rounding_is_no_warning(tmp_path):
    placed, times = plate(tmp_path, [0.0, 0.0]), np.array([0.0, 0.1, 0.2])  # 2 rad/s
    for speed, n_notices in ((2.0 * (1.0 + 5e-4), 0), (2.0 * (1.0 + 2e-3), 1)):
        positions = speed * times[:, None]
        found = [*notices_on_limits(placed, times, positions, "fail", "")]
        assert len(found) == n_notices
