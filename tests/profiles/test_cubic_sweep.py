"""Sweeps of motions on cubics: against closed forms, and against sampling a hundred times finer."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.profiles.chain import chain_of, positions_at
from clearance.profiles.chords import knots_of
from clearance.profiles.plane import Plane
from clearance.world.kinematics import link_poses
from clearance.world.motion import kinematic_motion
from clearance.world.robot import JointKind
from tests.examples import examples
from tests.oracle.outlines import inside
from tests.profiles.finely import (
    assert_within_chord_and_turn,
    finely_swept,
    interpolated,
    strays,
    sweeps,
)
from tests.profiles.moving import Z, joint, moved, rows, slab


@pytest.mark.peer
@examples(4)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["xy", "xz", "yz", "0.1 0 0 1 2 3"]))
def test_contains_a_sampling_a_hundred_times_finer_and_is_near_it(seed, name):
    rng, case = sweeps(seed, bent=True)
    found = cl.swept_profile(case, name, tolerance=2e-3)
    sampled, truth = finely_swept(case, Plane.of(name), 100)
    assert sampled.difference(found.region).area == 0.0
    assert found.bound <= 2e-3 and strays(found, truth) <= found.bound
    corners = np.concatenate(
        [np.array(p.exterior.coords) for p in getattr(sampled, "geoms", [sampled])]
    )
    chosen = rows(found)
    assert all(inside(point, chosen) for point in corners[rng.integers(len(corners), size=15)])


def test_a_box_that_swings_out_between_two_equal_steps_is_swept_where_it_was():
    """Linear joints would stand still: q(s) = v s (1 - s) reaches v / 4 at half time."""
    case = moved(
        [joint(0, JointKind.PRISMATIC, (1.0, 0.0, 0.0))],
        {1: slab([0, 0, 0], [0.3, 0.2, 0.1])},
        [[0.0], [0.0]],
        np.array([[0.8], [-0.8]]),
    )
    found = cl.swept_profile(case)
    low, high = found.curve.bounding_box
    for value, wanted in zip([*low, *high], [0.0, 0.0, 0.5, 0.2], strict=True):
        assert abs(value - wanted) <= found.bound
    assert (low <= 0.0).all() and (high >= [0.5, 0.2]).all()
    assert found.bound <= 5e-4


@pytest.mark.slow
def test_a_bar_that_overshoots_sweeps_the_sector_to_its_turning_point():
    """At rest at the start and fast at the end: the cubic turns back before it comes forward."""
    case = moved(
        [joint(0, JointKind.REVOLUTE, Z)],
        {1: slab([0.3, -1e-3, 0], [0.6, 1e-3, 0.1])},
        [[0.0], [0.5]],
        np.array([[0.0], [3.0]]),
        times=[0.0, 2.0],
    )
    motion = kinematic_motion(case.robots[0])
    share = np.linspace(0.0, 1.0, 20001)
    angle = interpolated(motion, share)[:, 0]
    assert angle.min() < -0.2
    found = cl.swept_profile(case)
    points = found.contours[0].flattened(1e-6)
    turned = np.arctan2(points[:, 1], points[:, 0])
    thick = math.asin((1e-3 + found.bound) / 0.3)
    assert turned.min() <= angle.min() <= turned.min() + thick
    assert turned.max() >= 0.5 >= turned.max() - thick


@pytest.mark.slow
@examples(6)
@given(st.integers(0, 2**32 - 1))
def test_a_section_holds_every_point_cut(seed):
    rng, case = sweeps(seed, bent=True)
    motion = kinematic_motion(case.robots[0])
    height = float(motion.poses()[:, 1, 2, 3].mean())
    try:
        found = cl.swept_profile(case, section=height, tolerance=2e-3, links=["l1"])
    except cl.ClearanceError:
        return
    low, high = case.robots[0].robot.bodies[0].shape.bounds
    poses = link_poses(case.robots[0], interpolated(motion, rng.uniform(0.0, 2.0, 400)))[:, 1]
    box = found.curve.box
    on_plane = rng.uniform(box[0] - 0.05, box[1] + 0.05, (300, 2))
    world = np.column_stack([on_plane, np.full(len(on_plane), height)])
    local = np.einsum("nji,npj->npi", poses[:, :3, :3], world[None] - poses[:, None, :3, 3])
    cut = ((local >= low) & (local <= high)).all(axis=2).any(axis=0)
    chosen = rows(found)
    assert all(inside(point, chosen) for point in on_plane[cut][:40])


@examples(20)
@given(st.integers(0, 2**32 - 1))
def test_points_stay_within_the_chord_bound_and_the_view_within_its_turn(seed):
    _, case = sweeps(seed, bent=True)
    motion = kinematic_motion(case.robots[0])
    assert_within_chord_and_turn(case, motion, lambda at: interpolated(motion, at), slack=1e-13)


@examples(20)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_the_course_is_the_motion(seed, bent):
    _, case = sweeps(seed, bent=bent)
    motion = kinematic_motion(case.robots[0])
    low = np.array([0.0, 0.25, 1.0, 1.5])
    high = low + np.array([1.0, 0.25, 0.5, 0.125])
    course = chain_of(case, (motion,), 2).course(low, high)
    for s in (-1.0, -0.3, 0.0, 0.7, 1.0):
        reported = course.position + s * (
            course.speed + s * (course.bend / 2 + s * course.jerk / 6)
        )
        at = 0.5 * (low + high) + 0.5 * s * (high - low)
        assert reported[:, 1:] == pytest.approx(interpolated(motion, at), abs=1e-12)
        assert positions_at(motion, at) == pytest.approx(interpolated(motion, at), abs=1e-12)
    assert (positions_at(motion, np.arange(3.0)) == motion.positions).all()


@pytest.mark.parametrize("kind", [JointKind.REVOLUTE, JointKind.PRISMATIC])
@pytest.mark.parametrize(("speeds", "bulge"), [((0.01, -0.01), 0.25), ((0.01, 0.01), 3**0.5 / 18)])
def test_what_alone_bends_or_alone_jerks_is_in_the_bound(kind, speeds, bulge):
    """Between equal steps the chords stand still; a joint leaves them by `bulge` times its speed."""
    case = moved(
        [joint(0, kind, Z if kind is JointKind.REVOLUTE else (0.0, 1.0, 0.0))],
        {1: slab([1.0, -1e-4, 0], [1.001, 1e-4, 0.1])},
        [[0.0], [0.0]],
        np.array(speeds)[:, None],
    )
    motion, body = kinematic_motion(case.robots[0]), case.robots[0].robot.bodies[0]
    chain = chain_of(case, (motion,), 1)
    knots = knots_of(chain, body.shape, Plane.of("xy"), 1.0, solid=False)
    assert len(knots.chord) == 1 and knots.moves.all()
    assert 0.01 * bulge <= knots.chord[0] <= 0.01 * 2.7 * bulge
