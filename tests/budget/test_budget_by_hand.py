"""Planar arms, and parts gripped by what is off, whose worst case is worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body, Mount, Obstacle
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
from tests.budget.part_cases import (
    END,
    OUT,
    QUARTER,
    arm,
    carried,
    cube,
    gantry,
    off_by,
    passing,
    quarter_turn,
    slid,
    turned_face,
    turned_past,
    wall,
)
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


def wall_from(x: float) -> Obstacle:
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
    nominal, left = proven(two_links(JointKind.PRISMATIC), (0.0, 0.0), wall_from(1.0), budget)
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


def test_another_pair_than_the_nearest_is_the_worst():
    """The wall is nearer, the loose post is what errors bring nearest."""
    trajectory = Trajectory(np.zeros(1), ("shoulder", "elbow"), np.zeros((1, 2)))
    post = Obstacle(Body("post", cl.box([0.1, 0.1, 0.5])), at(0.7, 0.5 * WIDTH + 0.12 + 0.05))
    case = Case("hand", (PlacedRobot(two_links(), trajectory),), (wall_from(1.0), post))
    loose = ObstacleTolerance(PlacementTolerance(0.05))
    case = replace(case, tolerance=Budget(obstacles={"post": loose}))
    ((section, found, _, steps, _),) = proven_sections(case)
    names = [pair.b.own_name_in(case) for pair in section.pairs]
    assert names[found.pair[0]] == "wall"
    assert names[steps.pair[0]] == "post"
    assert steps.proven[0] == pytest.approx(0.07, abs=EXACT)


SLACK = 1e-9

MORE = 1.06
"""So many times the worst of turns may be taken: a bound of the second order, of faces that are not cut."""

GAP = 1e-4


def left_at_end(case: Case, *names: str) -> float:
    """[m] proven of the last step, of the pair of these names."""
    *_, (section, _, _, steps, _) = proven_sections(case)
    nearest = section.pairs[int(steps.pair[-1])]
    assert {body.name_in(case) for body in nearest} == set(names or ("part", "wall"))
    return float(steps.proven[-1])


def test_a_part_has_the_carriers_error_of_the_grasp_and_that_of_now():
    """Gripped at -0.03 rad, and led 0.03 rad beyond its course, the part is turned by 0.06 rad."""
    taken = 0.1 - left_at_end(quarter_turn(0.1, 0.03))
    assert turned_face(0.06) <= taken <= MORE * turned_face(0.06)


def test_the_motion_between_the_steps_has_both_errors():
    ((_, _, _, steps, between),) = proven_sections(quarter_turn(0.1, 0.03), GAP)
    assert steps.proven[-1] - GAP <= between.proven.min() <= steps.proven[-1]


def test_what_both_errors_bring_into_contact_is_not_proven():
    case = replace(quarter_turn(0.04838, 0.03), limits=cl.Limits(0.001, 0.001))
    run = cl.check(case)
    assert run.worst["clearance"] == pytest.approx(0.04838, abs=SLACK)
    assert not run.record.budget[0].keeps
    driven_so = replace(case, robots=(arm("arm", -0.03, QUARTER + 0.03),), tolerance=None)
    assert cl.check(driven_so).worst["clearance"] == 0.0


def test_an_exact_grasp_leaves_the_errors_of_now():
    taken = 0.1 - left_at_end(quarter_turn(0.1, 0.03, exact_grasp=True))
    assert turned_face(0.03) <= taken <= MORE * turned_face(0.03)


def test_what_was_laid_down_keeps_the_errors_of_grasp_and_release():
    worst = 0.1 - turned_past(0.1, 0.06)
    taken = 0.1 - left_at_end(passing(0.1), "part", "right/bar")
    assert worst <= taken <= MORE * worst


def test_a_slide_takes_its_size_at_both_moments():
    assert left_at_end(slid(off_by(0.004))) == pytest.approx(0.092, abs=SLACK)


def test_frames_and_the_base_count_at_the_grasp_too():
    frame = {"j": JointTolerance(frame=PlacementTolerance(0.001))}
    budget = Budget({"arm": RobotTolerance(frame, PlacementTolerance(0.002))})
    assert left_at_end(slid(budget)) == pytest.approx(0.094, abs=SLACK)


def test_from_hand_to_hand_the_errors_of_all_moments_add_up():
    """Left grips and lets go with 4 mm, right takes it over and leads it on with 3 mm."""
    robots = (gantry("left", 0.0, -0.3, -0.3), gantry("right", 0.0, 0.0, -0.2, lift=5.0))
    carries = (carried("left/bar", 0.0, 1.0), carried("right/bar", 1.0))
    budget = Budget(off_by(0.004, "left").robots | off_by(0.003, "right").robots)
    left = left_at_end(slid(budget, *carries, robots=robots))
    assert left == pytest.approx(0.1 - 0.014, abs=SLACK)


def test_what_it_lay_on_counts_as_that_was_at_the_grasp():
    """The table is off by 2 mm, the part on it by 1 mm, the gantry by 4 mm at each moment."""
    table = cube("table", at(OUT, 0.0, -1.0))
    on_it = cube(mount=Mount("table", at(0.0, 0.0, 1.0)))
    places = {
        name: ObstacleTolerance(PlacementTolerance(size))
        for name, size in (("table", 0.002), ("part", 0.001))
    }
    budget = Budget(off_by(0.004).robots, places)
    left = left_at_end(slid(budget, obstacles=(table, on_it)))
    assert left == pytest.approx(0.1 - 0.011, abs=SLACK)


def test_what_rides_on_a_part_has_its_errors():
    """A label on the side of the wall, which is off by 1 mm on the part."""
    label = cube("label", mount=Mount("part", at(-0.1)))
    budget = Budget(off_by(0.004).robots, {"part": ObstacleTolerance(PlacementTolerance(0.001))})
    case = replace(slid(budget), obstacles=(cube(), label, wall(END - 0.2)))
    assert left_at_end(case, "label", "wall") == pytest.approx(0.1 - 0.009, abs=SLACK)


def test_a_robot_is_not_off_against_itself_when_it_grips_what_rides_on_it():
    """Its base is off by 5 mm, at the grasp and now; the part that rides on it was off with it."""
    on_it = cube(mount=Mount("base", at(OUT)))
    budget = Budget({"arm": RobotTolerance(base=PlacementTolerance(0.005))})
    assert left_at_end(slid(budget, obstacles=(on_it,))) == pytest.approx(0.095, abs=SLACK)


def test_what_is_held_from_the_start_was_not_gripped():
    """It rides on the bar as the case says; that the bar carries it is no moment at which it is gripped."""
    on_it = cube(mount=Mount("bar", at(OUT)))
    left = left_at_end(slid(off_by(0.004), obstacles=(on_it,)))
    assert left == pytest.approx(0.096, abs=SLACK)


def test_the_clock_of_a_carrier_is_refused_where_it_grips_at_the_start():
    late = Budget({"arm": RobotTolerance(timing=0.01)})
    with pytest.raises(BadInput, match="clock of 'arm' may be off"):
        cl.check(slid(late))


def test_sources_are_told_for_each_moment():
    run = cl.check(replace(slid(off_by(0.004)), limits=cl.Limits(0.08, 0.08)))
    sources = run.session.error_sources(run.record.budget[0]).sources
    assert sorted(one.moment for one in sources) == ["", "grasp (0 s)"]
    for one in sources:
        assert (one.owner, one.kind, one.part) == ("arm", "tracking", "j")
        assert one.proven == pytest.approx(0.004, abs=SLACK)
        assert one.expected == pytest.approx(0.004 / np.sqrt(3.0), abs=SLACK)
        assert one.largest == pytest.approx((0.01,), rel=0.003)  # twice as much is left as is asked


def test_an_error_takes_its_own_loss_though_another_pair_is_next():
    """Two walls, 0.1 mm apart, may each stand 10 mm nearer: without the error of one, the other is the nearest."""
    near, far = wall(END - 0.1), wall(END - 0.1001)
    far = replace(far, body=replace(far.body, name="far"))
    placed = ObstacleTolerance(PlacementTolerance(0.01))
    case = replace(slid(Budget({}, {"wall": placed, "far": placed})), obstacles=(cube(), near, far))
    run = cl.check(case)
    (source,) = run.session.error_sources(run.record.budget[0]).sources
    assert (source.owner, source.proven) == ("wall", pytest.approx(0.01, abs=SLACK))
