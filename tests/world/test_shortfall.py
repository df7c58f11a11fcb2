"""How far what a surface stands for may stand outside it, taken off the clearance like padding."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension, BadInput, UnknownLink
from clearance.world.robot import Joint, JointKind

CUBE = cl.box((1.0, 1.0, 1.0))


def off(shape: cl.Polyhedron, shortfall: float) -> cl.Polyhedron:
    faces = [shape.face_vertices[i : i + 4] for i in shape.face_starts[:-1]]
    return cl.Polyhedron(shape.vertices, faces, shortfall=shortfall)


def case_of(link: float, obstacle: float, **asked) -> cl.Case:
    """A cube that slides along x from 0 to 1 m before one that stands 4 m off."""
    slide = Joint("slide", JointKind.PRISMATIC, "base", "tip", np.eye(4))
    robot = cl.Robot("r", ("base", "tip"), (slide,), (cl.Body("tip", off(CUBE, link)),))
    path = cl.Trajectory([0.0, 1.0], ("slide",), [[0.0], [1.0]])
    place = np.eye(4)
    place[0, 3] = 4.0
    stands = cl.Obstacle(cl.Body("post", off(CUBE, obstacle)), place)
    return cl.Case("c", (cl.PlacedRobot(robot, path, **asked),), (stands,))


def test_both_shortfalls_and_the_padding_are_subtracted():
    run = cl.check(case_of(0.125, 0.25, padding={"tip": 0.0625}))
    assert run.record.steps["clearance"].to_pylist() == pytest.approx([2.5625, 1.5625], abs=1e-12)
    assert run.summary["paddings"] == {"tip": 0.1875, "post": 0.25}
    assert run.record.certificate.lower_bound.min() <= 1.5625
    checker = cl.Checker(case_of(0.125, 0.25, padding={"tip": 0.0625}))
    assert checker.distance([1.0]).distance == pytest.approx(1.5625, abs=1e-12)


@pytest.mark.parametrize("need", ["limit", "minimum"])
def test_they_are_taken_off_the_bounds_of_steps_that_are_not_measured_too(need):
    case = case_of(0.125, 0.25, padding={"tip": 0.0625})
    steps = cl.check(case, need=need, certify=False).steps
    assert steps["clearance"].to_pylist()[0] is None
    assert (steps["lower_bound"].to_numpy() <= [2.5625, 1.5625]).all()


def test_what_a_shortfall_brings_to_nothing_is_violated_and_no_contact():
    run = cl.check(case_of(1.0, 1.5))
    assert run.summary["verdict"] == "violated"


def test_moved_turned_scaled_and_joined_surfaces_keep_it():
    shape = off(CUBE, 0.25)
    pose = np.eye(4)
    pose[0, 3] = 1.0
    assert shape.transformed(pose).shortfall == 0.25 == shape.flipped().shortfall
    assert shape.scaled((1.0, -2.0, 0.5)).shortfall == pytest.approx(0.5)
    assert cl.Polyhedron.merged([CUBE, shape]).shortfall == 0.25
    with pytest.raises(BadDimension, match="shortfall is -1"):
        off(CUBE, -1.0)


def test_what_counts_no_padding_refuses_it():
    with pytest.raises(BadInput, match="which a profile does not count"):
        cl.swept_profile(case_of(0.125, 0.0))


@pytest.mark.parametrize("given", [{"padding": {"tp": 0.01}}, {"exclude_links": ("tp",)}])
def test_padding_and_exclusion_of_a_link_that_is_not_there_are_refused(given):
    with pytest.raises(UnknownLink, match="unknown link 'tp'; did you mean 'tip'"):
        case_of(0.0, 0.0, **given)
