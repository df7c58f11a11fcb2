"""A robot inside a solid with a fault is in contact or suspect, never quietly clear; sheets make no noise."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.simulate import inside
from clearance.world.notice import Severity
from clearance.world.pairs import measured_pairs
from tests.made_cases import WORST, at, ball, faces_of, flying

BALL = ball(2.0, 2)
LINK = cl.box((0.05, 0.05, 0.05))


def moved(shape: Polyhedron, positions: np.ndarray, outer: Polyhedron, **options) -> cl.Run:
    steps = np.zeros((len(positions), 6))
    steps[:, :3] = positions
    return cl.check(flying("inside", shape, [(outer, np.eye(4))], steps), **options)


WAY = np.linspace((-0.3, 0.1, 0.0), (0.3, 0.1, 0.2), 30)


@pytest.mark.parametrize("need", ["steps", "pairs", "limit", "minimum"])
@pytest.mark.parametrize("fault", ["twice", "missing", "turned"])
def test_a_robot_wholly_inside_is_in_contact_whatever_is_asked(fault: str, need: str) -> None:
    faces = faces_of(BALL)
    faces = {"twice": [*faces, faces[9]], "missing": faces[1:], "turned": [faces[0][::-1], *faces[1:]]}[fault]
    run = moved(LINK, WAY, Polyhedron(BALL.vertices, faces), need=need)
    assert run.status == "contact" and not run.passed and run.worst["clearance"] == 0.0
    assert run.record.notices == ()


def test_a_link_round_an_obstacle_is_in_contact_as_well() -> None:
    run = moved(Polyhedron(BALL.vertices, faces_of(BALL)[1:]), WAY, LINK)
    assert run.status == "contact"


def test_where_the_hole_decides_the_pair_is_suspect_by_name_and_first_step() -> None:
    outer = Polyhedron(BALL.vertices, faces_of(BALL)[1:])
    middle = BALL.face(0).mean(axis=0)
    run = moved(LINK, np.linspace(3.0, 1.0, 21)[:, None] * middle, outer)
    (notice,) = run.record.notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "inside")
    assert notice.text.startswith("link l6 may be inside obstacle o0, or round it, at 0.200 s (step 20)")
    assert moved(LINK, np.linspace(3.0, 1.5, 21)[:, None] * middle, outer).record.notices == ()


def test_larger_holes_make_it_suspect_and_sheets_do_not() -> None:
    faces = faces_of(BALL)
    (notice,) = moved(LINK, WAY, Polyhedron(BALL.vertices, faces[12:])).record.notices
    assert "step 0" in notice.text
    for shape in (Polyhedron(BALL.vertices, faces[100:]), Polyhedron(BALL.vertices, faces[:100])):
        assert moved(LINK, WAY, shape).record.notices == ()


@pytest.mark.parametrize("name", ["linked_tori", "nested_shells", "everything_equidistant", "facing_plates"])
def test_closed_and_open_surfaces_have_no_notices(name: str) -> None:
    case = WORST[name]()
    assert cl.check(case).record.notices == ()


def test_steps_in_contact_are_not_in_doubt() -> None:
    """A link that reaches through the surface itself is in contact there, which is known."""
    outer = Polyhedron(BALL.vertices, faces_of(BALL)[1:])
    rod = cl.box((0.05, 0.05, 5.0))
    case = flying("through", rod, [(outer, at())], np.zeros((3, 6)))
    run = cl.check(case)
    assert run.status == "contact"
    assert inside.notices(case, run.record.motions, measured_pairs(case)[0]) == ()
