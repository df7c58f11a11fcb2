"""Swept profiles: closed forms, and against sampling many times finer."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadDimension, BadInput, NothingToMeasure, UnknownLink
from clearance.profiles.chain import chain_of, positions_at
from clearance.profiles.chords import knots_of
from clearance.profiles.plane import Plane
from clearance.world.body import Mount
from clearance.world.kinematics import link_poses
from clearance.world.motion import kinematic_motion
from clearance.world.pose_table import PoseTable
from clearance.world.robot import JointKind
from clearance.world.trajectory import CornerZone, Deviation
from tests.examples import examples
from tests.oracle.outlines import inside
from tests.profiles.finely import (
    assert_within_chord_and_turn,
    finely_swept,
    interpolated,
    strays,
    sweeps,
)
from tests.profiles.moving import (
    Z,
    joint,
    moved,
    rows,
    slab,
    sliding,
    turning,
)

shapely = pytest.importorskip("shapely")


def test_a_bar_turning_about_a_point_sweeps_a_sector_of_an_annulus():
    near, far, wide, angle = 0.2, 1.0, 0.1, 1.3
    found = cl.swept_profile(
        turning(slab([near, -wide / 2, 0], [far, wide / 2, 0.1]), [0, 0.6, angle])
    )
    corner_sq = far**2 + wide**2 / 4
    area = (far - near) * wide + 0.5 * angle * (corner_sq - near**2)
    assert area <= found.area <= area + found.bound * found.length
    assert found.bound <= 5e-4
    radius = np.hypot(*np.concatenate([c.flattened(1e-7) for c in found.contours]).T)
    assert math.sqrt(corner_sq) <= radius.max() <= math.sqrt(corner_sq) + found.bound
    assert near - found.bound <= radius.min() <= near
    assert found.n_pieces <= 20  # two arcs, two sides, two ends, and their corners


def test_in_a_corner_zone_all_that_links_may_sweep_is_swept():
    """A slab of 0.1 m slides by 1 m; on 0.25 m of its way it may be 20 mm off: a strip of 0.35 m either side and
    two quarters of a circle at its ends."""
    case, off, wide = (
        sliding(slab([0, -0.05, 0], [0.1, 0.05, 0.1]), np.linspace(0.0, 1.0, 5)),
        0.02,
        0.1,
    )
    (placed,) = case.robots
    times = placed.trajectory.times
    zone = CornerZone(
        "LIN 1", times[1], times[2], 0.05, {placed.robot.bodies[0].name: Deviation(off, 0.0)}
    )
    in_zone = replace(placed, trajectory=replace(placed.trajectory, corners=(zone,)))
    case = replace(case, robots=(in_zone,))
    found = cl.swept_profile(case)
    area = 1.1 * wide + 2.0 * (0.35 * off + 0.5 * math.pi * off**2)
    assert area <= found.area <= area + found.bound * found.length and found.bound <= 5e-4
    assert found.notes == ("in corner zones links are up to 20 mm off, which is swept as well",)
    with pytest.raises(BadInput, match="links may be 20 mm off in corner zones"):
        cl.swept_profile(case, section=0.05)


def test_what_is_mounted_on_a_link_is_swept_with_it_and_what_moves_by_itself_is_said():
    """A slab of 0.1 m slides by 1 m with a bar across it; a door slides far away."""
    case = sliding(slab([0, -0.05, 0], [0.1, 0.05, 0.1]), np.linspace(0.0, 1.0, 5))
    bar = cl.Obstacle(cl.Body("bar", slab([0, -0.5, 0], [0.1, 0.5, 0.1])), mount=Mount("l1"))
    ways = np.array([[9.0, 0.0, 0.0], [9.5, 0.0, 0.0]]), np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    table = PoseTable(np.array([0.0, 4.0]), *ways)
    door = cl.Obstacle(cl.Body("door", cl.box((0.1, 0.1, 0.1))), moves=table)
    found = cl.swept_profile(replace(case, obstacles=(bar, door)))
    assert 1.1 <= found.area <= 1.1 + found.bound * found.length
    assert found.notes == ("not swept, though moving by themselves: door",)


def test_a_sphere_on_a_line_sweeps_a_stadium():
    radius, way = 0.1, 0.5
    found = cl.swept_profile(sliding(cl.sphere(radius), [0, way]))
    truth = cl.Curve.chain(
        [
            cl.Curve.line([0, -radius], [way, -radius]),
            cl.Curve.arc([way, 0], radius, -math.pi / 2, math.pi / 2),
            cl.Curve.line([way, radius], [0, radius]),
            cl.Curve.arc([0, 0], radius, math.pi / 2, 3 * math.pi / 2),
        ]
    )
    assert 0 < found.facets <= 1e-4
    assert cl.hausdorff(found.curve, truth).distance <= found.bound + found.facets
    assert cl.minimum_distance(found.curve, truth).distance > 0.0


@pytest.mark.peer
@examples(8)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(["xy", "xz", "yz", "0.1 0 0 1 2 3"]), st.booleans()
)  # fmt: skip
def test_contains_a_sampling_many_times_finer_and_is_near_it(seed, name, bent):
    """Of motions on lines, and on cubics."""
    rng, case = sweeps(seed, bent=bent)
    found = cl.swept_profile(case, name, tolerance=2e-3)
    sampled, truth = finely_swept(case, Plane.of(name), 40)
    assert sampled.difference(found.region).area == 0.0
    assert found.bound <= 2e-3 and strays(found, truth) <= found.bound
    corners = shapely.get_coordinates(sampled)
    chosen = rows(found)
    assert all(inside(point, chosen) for point in corners[rng.integers(len(corners), size=15)])


@pytest.mark.peer
def test_a_long_bar_spinning_about_its_middle_is_a_double_wedge_not_its_hull():
    case = turning(cl.box((2.0, 0.004, 0.1)), [0.0, 0.04])
    found = cl.swept_profile(case)
    sampled, truth = finely_swept(case, Plane.of("xy"), 100)
    assert sampled.difference(found.region).area == 0.0
    assert strays(found, truth) <= found.bound


@pytest.mark.slow
@examples(10)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_a_section_holds_every_point_cut_and_lies_near_the_body_in_space(seed, bent):
    rng, case = sweeps(seed, bent=bent)
    motion = kinematic_motion(case.robots[0])
    height = float(motion.poses()[:, -1, 2, 3].mean())
    try:
        found = cl.swept_profile(case, section=height, tolerance=2e-3, links=["l1"])
    except NothingToMeasure:
        return
    body = case.robots[0].robot.bodies[0]
    instants = rng.uniform(0, motion.n_steps - 1, 400)
    poses = link_poses(case.robots[0], positions_at(motion, instants))[:, 1]
    low, high = body.shape.bounds
    page = np.array([c.vertices for c in found.contours], dtype=object)
    vertices = np.concatenate(list(page)).astype(float)
    on_plane = rng.uniform(vertices.min(axis=0), vertices.max(axis=0), (400, 2))
    world = np.column_stack([on_plane, np.full(400, height)])
    local = np.einsum("nji,npj->npi", poses[:, :3, :3], world[None] - poses[:, None, :3, 3])
    cut = ((local >= low) & (local <= high)).all(axis=2).any(axis=0)
    chosen = rows(found)
    assert all(inside(point, chosen) for point in on_plane[cut][:40])
    dense = link_poses(
        case.robots[0], positions_at(motion, np.linspace(0, motion.n_steps - 1, 3000))
    )[:, 1]
    outline = np.column_stack([vertices, np.full(len(vertices), height)])[:60]
    local = np.einsum("nji,npj->npi", dense[:, :3, :3], outline[None] - dense[:, None, :3, 3])
    away = np.linalg.norm(np.maximum(np.maximum(low - local, local - high), 0.0), axis=2).min(
        axis=0
    )
    assert away.max() <= found.bound + 5e-4  # the dense samples' own steps


@examples(30)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_points_stay_within_the_chord_bound_and_the_view_within_its_turn(seed, bent):
    _, case = sweeps(seed, bent=bent)
    (placed,), plane = case.robots, Plane.of("xz")
    motion, shape = kinematic_motion(placed), placed.robot.bodies[1].shape
    knots = knots_of(chain_of(case, (motion,), 2), shape, plane, 1.0, solid=False)

    def poses_at(instants):
        return link_poses(placed, interpolated(motion, instants))[:, 2]

    assert_within_chord_and_turn(knots, shape, plane, poses_at, 1e-13)


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


@pytest.mark.parametrize(
    ("options", "fault", "said"),
    [
        ({"plane": "zz"}, BadInput, "plane: 'zz'"),
        ({"plane": "0 0 0 0 0 0"}, BadInput, "zero length"),
        ({"links": ["l3"]}, UnknownLink, "unknown link 'l3'; valid: l1"),
        ({"section": 9.0}, NothingToMeasure, "cuts no link"),
        ({"tolerance": 0.0}, BadDimension, "at least 1e-6 m"),
    ],
)
def test_refusals_are_one_line(options, fault, said):
    case = sliding(slab([0, 0, 0], [0.3, 0.2, 0.1]), [0, 0.1])
    with pytest.raises(fault) as caught:
        cl.swept_profile(case, **options)
    assert said in str(caught.value)
