"""Planar arms whose worst case is worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body, Obstacle
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.budget.budget_cases import X, Z, bar, proven_sections
from tests.made_cases import at

EXACT = 1e-12
UPPER, FORE, WIDTH = 0.5, 0.4, 0.04


TIP = np.array([FORE, 0.2])
"""[m] Of a thorn at the end of the second link, across it: farthest of all from either axis."""


def thorn() -> Polyhedron:
    """A pyramid across the end of the second link, up to `TIP`."""
    base = [
        [FORE + x, 0.0, z] for x, z in ((-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01))
    ]
    faces = [[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]
    return Polyhedron(np.array([*base, [*TIP, 0.0]]), np.array(faces)).outward()


def two_links(elbow: JointKind = JointKind.REVOLUTE, shape: Polyhedron | None = None) -> Robot:
    """Two bars along x: the shoulder turns about z, the elbow turns about z or slides along x."""
    joints = (
        Joint("shoulder", JointKind.REVOLUTE, "base", "upper", at(), Z),
        Joint("elbow", elbow, "upper", "fore", at(UPPER), Z if elbow is JointKind.REVOLUTE else X),
    )
    return Robot(
        "arm", ("base", "upper", "fore"), joints, (Body("fore", shape or bar(FORE, WIDTH)),)
    )


def proven(
    robot: Robot, q: tuple[float, float], obstacle: Obstacle, budget: Budget
) -> tuple[float, float]:
    """[m] nominal and proven clearance of the arm at one position."""
    trajectory = Trajectory(np.zeros(1), ("shoulder", "elbow"), np.array([q]))
    case = Case("hand", (PlacedRobot(robot, trajectory),), (obstacle,))
    ((_, found, _, steps, _),) = proven_sections(replace(case, tolerance=budget))
    return float(found.clearance[0]), float(steps.proven[0])


def joints(**positions: float) -> Budget:
    """Tolerances of joints alone."""
    own = {name: JointTolerance(position) for name, position in positions.items()}
    return Budget({"arm": RobotTolerance(own)})


def wall(x: float) -> Obstacle:
    """A wall across x, its face at x."""
    return Obstacle(Body("wall", cl.box([0.2, 2.0, 2.0])), at(x + 0.1))


def pin_beyond(corner: np.ndarray, angle: float, gap: float, about: np.ndarray) -> Obstacle:
    """A cube whose face lies across the chord of a corner's turn by `angle` about a point, `gap` beyond it."""
    arm = corner - about
    turned = np.array(
        [
            np.cos(angle) * arm[0] - np.sin(angle) * arm[1],
            np.sin(angle) * arm[0] + np.cos(angle) * arm[1],
        ]
    )
    way = (turned - arm) / np.linalg.norm(turned - arm)
    frame = np.eye(3)
    frame[:2, 0], frame[:2, 1] = way, (-way[1], way[0])
    centre = corner + (gap + 0.05) * way
    return Obstacle(Body("pin", cl.box([0.1, 0.001, 0.1])), at(*centre, 0.0, turned=frame))


def test_slide_offset_place_and_surfaces_add_up():
    budget = Budget(
        {
            "arm": RobotTolerance(
                {"elbow": JointTolerance(0.001, 0.0005, PlacementTolerance(0.0002))},
                PlacementTolerance(0.002),
                {"fore": 0.0004},
            )
        },
        {"wall": ObstacleTolerance(PlacementTolerance(0.003), 0.0006)},
    )
    nominal, left = proven(two_links(JointKind.PRISMATIC), (0.0, 0.0), wall(1.0), budget)
    assert nominal - left == pytest.approx(
        0.0015 + 0.0002 + 0.002 + 0.0004 + 0.003 + 0.0006, abs=EXACT
    )


@pytest.mark.parametrize("angle", [0.001, 0.05, 0.2])
def test_a_turn_of_the_shoulder_takes_the_chord(angle):
    corner = np.array([UPPER, 0.0]) + TIP
    pin = pin_beyond(corner, angle, 0.3, np.zeros(2))
    nominal, left = proven(two_links(shape=thorn()), (0.0, 0.0), pin, joints(shoulder=angle))
    chord = 2.0 * np.sin(0.5 * angle) * np.linalg.norm(corner)
    assert nominal == pytest.approx(0.3, abs=EXACT)
    assert nominal - left == pytest.approx(chord, abs=EXACT)


def test_turns_of_the_base_and_the_shoulder_about_one_place_are_one_turn():
    """Both about the origin: the worst is the turn by their sum, of which two chords are no less."""
    corner = np.array([UPPER, 0.0]) + TIP
    pin = pin_beyond(corner, 0.004, 0.3, np.zeros(2))
    own = RobotTolerance({"shoulder": JointTolerance(0.002)}, PlacementTolerance(0.0, 0.002))
    nominal, left = proven(two_links(shape=thorn()), (0.0, 0.0), pin, Budget({"arm": own}))
    worst = 2.0 * np.sin(0.002) * np.linalg.norm(corner)
    assert worst - EXACT <= nominal - left <= worst + 1e-5


def test_what_turns_about_the_line_to_the_wall_takes_the_second_order_only():
    """The tip of a straight arm is led away from the wall by any turn of the shoulder but for its corners."""
    nominal, left = proven(two_links(), (0.0, 0.0), wall(1.0), joints(shoulder=0.001))
    corner = np.arctan2(0.5 * WIDTH, UPPER + FORE)
    reach = np.hypot(UPPER + FORE, 0.5 * WIDTH)
    worst = reach * np.cos(corner - 0.001) - (UPPER + FORE)
    assert worst - EXACT <= nominal - left <= worst + 2e-6


def test_another_pair_than_the_nearest_is_the_worst():
    """The wall is nearer, the loose post is what errors bring nearest."""
    trajectory = Trajectory(np.zeros(1), ("shoulder", "elbow"), np.zeros((1, 2)))
    post = Obstacle(Body("post", cl.box([0.1, 0.1, 0.5])), at(0.7, 0.5 * WIDTH + 0.12 + 0.05))
    case = Case("hand", (PlacedRobot(two_links(), trajectory),), (wall(1.0), post))
    loose = ObstacleTolerance(PlacementTolerance(0.05))
    case = replace(case, tolerance=Budget(obstacles={"post": loose}))
    ((section, found, _, steps, _),) = proven_sections(case)
    names = [pair.b.own_name_in(case) for pair in section.pairs]
    assert names[found.pair[0]] == "wall"
    assert names[steps.pair[0]] == "post"
    assert steps.proven[0] == pytest.approx(0.07, abs=EXACT)
