"""What constructors are given: it keeps its numbers whatever the caller does, and another type is refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
import trimesh

import clearance as cl
from clearance.errors import BadInput
from clearance.world.body import Mount
from clearance.world.pose_table import PoseTable
from tests.findings.gates import ROBOT
from tests.report.cells import slider

CUBE = cl.Body("cube", cl.box((0.1, 0.1, 0.1)))
NO_TURN = np.array([[0.0, 0.0, 0.0, 1.0]])


def placed(base: np.ndarray) -> cl.PlacedRobot:
    return cl.PlacedRobot(slider("axis"), cl.Trajectory([0.0], ["s"], [[0.0]]), base)


MADE: dict[str, tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]] = {
    "obstacle": (np.eye(4), lambda pose: cl.Obstacle(CUBE, pose).world_from_body),
    "mount": (np.eye(4), lambda pose: Mount("tool", pose).pose),
    "base": (np.eye(4), lambda base: placed(base).world_from_base),
    "trajectory": (np.zeros((1, 1)), lambda x: cl.Trajectory([0.0], ["x"], x).positions),
    "velocities": (
        np.zeros((1, 1)),
        lambda v: cl.Trajectory([0.0], ["x"], [[0.0]], velocities=v).velocities,
    ),
    "pose table": (np.zeros((1, 3)), lambda xyz: PoseTable([0.0], xyz, NO_TURN).positions),
}


@pytest.mark.parametrize("kind", MADE)
def test_an_array_that_is_used_again_changes_nothing_made_before(kind: str) -> None:
    given, make = MADE[kind]
    buffer = given.copy()
    made = make(buffer)
    before = made.copy()
    buffer += 0.25
    assert np.array_equal(made, before)


def test_a_dict_that_is_used_again_changes_no_robot_made_before() -> None:
    given = {"s": 0.5}
    made = cl.PlacedRobot(slider("axis"), fixed_positions=given)
    given["s"] = 0.9
    assert made.fixed_positions == {"s": 0.5}


def test_a_list_that_is_used_again_changes_nothing_made_before() -> None:
    """What is worked out of a case once is asked for again: a list that changes would be answered as it was."""
    robot, motion = slider("axis"), cl.Trajectory([0.0], joints := ["s"], [[0.0]])
    robots = [cl.PlacedRobot(robot, motion, exclude_links=(excluded := []))]
    rules, touch = [cl.Rule(("*", "cube"), fail=0.1)], ["*"]
    carry = cl.Carry("cube", "axis", cl.Window(0.0, 1.0), touch=touch)
    limits, obstacles = cl.Limits(rules=rules), [cl.Obstacle(CUBE)]
    case = cl.Case("case", robots, obstacles, limits)
    own = (
        case.robots,
        case.obstacles,
        limits.rules,
        carry.touch,
        motion.joint_names,
        robots[0].exclude_links,
    )
    before = [*own]
    for given in (robots, obstacles, rules, touch, joints):
        given.clear()
    excluded.append("axis")
    assert all(isinstance(one, tuple) for one in own) and [*own] == before
    assert case.obstacles and replace(robot, joints=[*robot.joints]).joints == robot.joints


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (np.ma.array([[0.0]], mask=[[True]]), "values are masked"),
        (np.array([[0]], "timedelta64[ns]"), "values have the type timedelta64"),
        (np.array([[0j]]), "values have the type complex128"),
        (np.array([[True]]), "values have the type bool"),
    ],
)
def test_numbers_that_are_not_known_are_refused(given: np.ndarray, told: str) -> None:
    with pytest.raises(cl.BadInput, match=told):
        cl.Trajectory([0.0], ["x"], given)


def test_a_table_of_poses_has_the_scalar_last_also_where_it_names_its_columns() -> None:
    """A frame (qw, qx, qy, qz) of length one was read as (x, y, z, w)."""
    rows = {"qw": [1.0], "qx": [0.0], "qy": [0.0], "qz": [0.0]}
    told = "quaternions: the columns are qw, qx, qy, qz; x, y, z, w, in this order"
    with pytest.raises(cl.BadInput, match=told):
        PoseTable([0.0], [[0.0, 0.0, 0.0]], pa.table(rows))
    with pytest.raises(cl.BadInput, match="values are masked"):
        PoseTable([0.0], np.ma.array([[0.0, 0.0, 0.0]], mask=[[True, False, False]]), NO_TURN)
    last = pa.table({name: rows[name] for name in ("qx", "qy", "qz", "qw")})
    assert PoseTable([0.0], [[0.0, 0.0, 0.0]], last).quaternions.tolist() == NO_TURN.tolist()


ARM = cl.load_robot(ROBOT)
MOTION = cl.Trajectory([0.0, 1.0], ["slide_x"], [[0.0], [0.3]])
PLACED = cl.PlacedRobot(ARM, MOTION)
BODY = cl.Body("post", cl.box((0.1, 0.1, 1.0)))
POST = cl.Obstacle(BODY, np.eye(4))
ALL = cl.Window(0.0, 1.0)

WRONG = {
    "PlacedRobot.robot: 'arm.urdf' is given; a Robot is needed": lambda: cl.PlacedRobot("arm.urdf", MOTION),
    "PlacedRobot.trajectory: 'm.csv' is given; a Trajectory is needed": lambda: cl.PlacedRobot(ARM, "m.csv"),
    "PlacedRobot.self_clearance: 'x.srdf' is given; a SelfClearance": lambda: cl.PlacedRobot(
        ARM, MOTION, self_clearance="x.srdf"
    ),
    "PlacedRobot.padding: 0.01 is given; a mapping": lambda: cl.PlacedRobot(ARM, MOTION, padding=0.01),
    "PlacedRobot.timing: 3 is given; a Timing": lambda: cl.PlacedRobot(ARM, MOTION, timing=3),
    "PlacedRobot.mount: 'table' is given; a Mount": lambda: cl.PlacedRobot(ARM, MOTION, mount="table"),
    "PlacedRobot.exclude_links: 'box' is given; a sequence of str": lambda: cl.PlacedRobot(
        ARM, MOTION, exclude_links="box"
    ),
    "SelfClearance.matrix: 'x.srdf' is given": lambda: cl.SelfClearance("x.srdf"),
    "Case.name: 3 is given; a str": lambda: cl.Case(3, [PLACED], [POST]),
    "Case.robots: <Robot 'gantry_box'": lambda: cl.Case("c", [ARM], [POST]),
    "Case.obstacles: ": lambda: cl.Case("c", [PLACED], POST),
    "Case.limits: {'fail': 0.01} is given; a Limits is needed": lambda: cl.Case(
        "c", [PLACED], [POST], limits={"fail": 0.01}
    ),
    "Case.clock: 'common' is given; a Clock": lambda: cl.Case("c", [PLACED], [POST], clock="common"),
    "Case.waivers: 'w.yaml' is given; a Waiver": lambda: cl.Case("c", [PLACED], [POST], waivers=["w.yaml"]),
    "Case.carries: 'x' is given; a Carry": lambda: cl.Case("c", [PLACED], [POST], carries=["x"]),
    "Case.tolerance: {'base': 1} is given; a Budget": lambda: cl.Case(
        "c", [PLACED], [POST], tolerance={"base": 1}
    ),
    "accept: 'unitz' is given; kinds of suspect input": lambda: cl.Case("c", [PLACED], [POST], accept=["unitz"]),
    "Case.accept: 'units' is given; a sequence of str": lambda: cl.Case("c", [PLACED], [POST], accept="units"),
    "Case.allow: 'post' is given; two patterns": lambda: cl.Case("c", [PLACED], [POST], allow=["post"]),
    "Body.name: 3 is given": lambda: cl.Body(3, BODY.shape),
    "Obstacle.moves: 'a.csv' is given; a PoseTable": lambda: cl.Obstacle(BODY, moves="a.csv"),
    "Limits.rules: 'a' is given; a Rule": lambda: cl.Limits(0.01, rules=["a"]),
    "Limits.joints: 'x' is given; one of warn, fail": lambda: cl.Limits(0.01, joints="x"),
    "Rule.between: 'ab' is given; two patterns": lambda: cl.Rule("ab"),
    "Waiver.between: ('a',) is given; two patterns": lambda: cl.Waiver(("a",), reason="r", by="b"),
    "Rule.window: (0, 1) is given; a Window": lambda: cl.Rule(("a", "b"), window=(0, 1)),
    "Carry.window: (0, 1) is given; a Window": lambda: cl.Carry("p", "b", (0, 1)),
    "Carry.part: ": lambda: cl.Carry(POST, "b", ALL),
    "Mount.on: 3 is given; a str": lambda: cl.Mount(3),
    "Window.start: 'a' is given; a number": lambda: cl.Window("a", 1.0),
    "Timing.start: 'a' is given; a number": lambda: cl.Timing(start="a"),
    "Clock.slack: 'x' is given; a number": lambda: cl.Clock("x"),
    "Trajectory.joint_names: 1 is given; a str": lambda: cl.Trajectory([0, 1], [1], [[0], [1]]),
    "times": lambda: cl.Trajectory(None, ["a"], [[0]]),
}  # fmt: skip


@pytest.mark.parametrize("told", WRONG)
def test_another_type_is_refused_in_one_line(told):
    with pytest.raises(BadInput, match=re.escape(told)) as caught:
        WRONG[told]()
    assert "\n" not in str(caught.value)


def test_self_clearance_is_asked_for_with_true():
    case = cl.Case("c", [cl.PlacedRobot(ARM, MOTION, self_clearance=True)], [POST])
    assert case.robots[0].self_clearance == cl.SelfClearance()
    assert cl.PlacedRobot(ARM, MOTION, self_clearance=False).self_clearance is None
    assert "self-collision" not in cl.check(case, need="minimum").verdict.not_checked


@pytest.mark.parametrize("unit", ["inches", "millimeters"])
def test_a_mesh_that_says_another_unit_than_metres_is_refused(unit):
    mesh = trimesh.creation.box((4.0, 4.0, 4.0))
    mesh.units = unit
    with pytest.raises(
        BadInput, match=f"body 'b': the mesh has units {unit!r}; metres: mesh.convert_units"
    ):
        cl.Body("b", mesh)
    mesh.convert_units("meters")
    assert cl.Body("b", mesh).shape.n_faces == 6


@pytest.mark.parametrize("kind", ["Sphere", "Cylinder", "Capsule"])
def test_round_shapes_of_trimesh_are_refused_since_their_facets_are_inscribed(kind):
    shape = getattr(trimesh.primitives, kind)(radius=0.5)
    with pytest.raises(
        BadInput, match=f"the facets of a {kind} of trimesh lie inside it; cl.{kind.lower()}"
    ):
        cl.Body("b", shape)
    assert cl.Body("b", shape.to_mesh()).shape.n_faces > 6
    assert cl.Body("b", trimesh.primitives.Box()).shape.n_faces == 6
