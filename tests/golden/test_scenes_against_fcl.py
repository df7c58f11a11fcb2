"""Every scene of ours, held against FCL to 1e-9 m: at every step, of the longest two at every fourth. And input on
which well-known libraries answer wrongly; each must be right here.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from tests import oracle
from tests.made_cases import at

SCENES = Path(__file__).parents[2] / "scenes"
LONGEST = {"palletising_cell", "welding_cell"}
NAMES = LONGEST | {
    "box_box", "box_pipe", "door_and_arm", "dual_arm_handover", "hot_cell", "iiwa_pipe_rack", "panda_shelf",
    "turntable_cell",
}  # fmt: skip


def thinned(case: cl.Case, n: int) -> cl.Case:
    """The case with every n-th sample of its robots."""
    robots = []
    for placed in case.robots:
        asked = placed.trajectory
        rows = cl.Trajectory(asked.times[::n], asked.joint_names, asked.positions[::n])
        robots.append(replace(placed, trajectory=rows))
    return replace(case, robots=tuple(robots))


@pytest.mark.slow
@pytest.mark.peer
@pytest.mark.parametrize("name", sorted(NAMES))
def test_fcl_agrees(name):
    case = cl.load_case(SCENES / name / "case.yaml")
    run = cl.check(thinned(case, 4) if name in LONGEST else case, cross_check=True, certify=False)
    assert run.steps.num_rows >= 200
    assert run.cross_check.n_steps == run.steps.num_rows
    assert run.cross_check.disagreements == ()
    assert run.cross_check.greatest_difference <= 1e-9
    assert run.cross_check.worst_witness_error <= 1e-9


@pytest.mark.parametrize("gap", [1e-6, 1e-5])
@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_a_needle_over_a_small_face_is_not_in_contact(gap, scale):
    """Triangles with edges of 0.1 mm in metres: an absolute threshold on |n|^2 makes others answer 0."""
    edge = 1e-4
    face = scale * np.array([[0, 0, 0], [edge, 0, 0], [0, edge, 0]])
    tip = np.array([0.3 * edge, 0.3 * edge, gap])
    needle = scale * np.array([tip, tip + [1e-6, 0, 5 * edge], tip + [0, 1e-6, 5 * edge]])
    near = cl.polygon_distance(face, needle)
    truth = float(oracle.root(oracle.polygon_distance_sq(face, needle)))
    assert not near.contact
    assert near.distance == pytest.approx(truth, rel=1e-12)


def test_overlapping_boxes_meet_in_a_point_of_both():
    a, b = cl.box((1.0, 1.0, 1.0)), cl.box((0.2, 0.2, 3.0))
    near = cl.distance(a, b, pose_b=at(0.3, -0.2, 0.0))
    assert near.contact
    assert np.array_equal(near.point_a, near.point_b)
    assert np.abs(near.point_a).max() <= 0.5
    assert np.abs(near.point_a - [0.3, -0.2, 0.0]).max() <= 1.5


@pytest.mark.slow
def test_a_triangle_without_area_changes_nothing():
    vertices = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5], [6, 6, 6], [7, 7, 7]], dtype=float
    )
    with_needle = cl.Polyhedron(vertices, [[0, 1, 2], [3, 4, 5]])
    near = cl.distance(cl.sphere(0.5), with_needle, pose_a=at(0.2, 0.2, 2.5))
    assert near.face_b == 0
    assert near.distance == pytest.approx(2.0, abs=2e-4)


def test_a_box_flies_through_a_bore_without_touching():
    bore = cl.pipe(inner_radius=0.1, outer_radius=0.12, length=1.0)
    box = cl.box((0.1, 0.1, 0.1))
    truth = 0.1 - np.hypot(0.05, 0.05)
    for z in np.linspace(-0.9, 0.9, 19):
        near = cl.distance(box, bore, pose_a=at(z=z))
        assert not near.contact
        if abs(z) <= 0.5:
            assert truth - bore.excess <= near.distance <= truth + 1e-12
