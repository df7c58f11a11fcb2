"""What a constructor is given of another type is refused in one line: field, given, needed."""

from __future__ import annotations

import re

import numpy as np
import pytest
import trimesh

import clearance as cl
from clearance.errors import BadInput
from tests.findings.gates import ROBOT

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
