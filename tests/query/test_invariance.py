"""What the distance must not depend on, and how it may change: motion, subdivision, direction."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from clearance import Polyhedron, distance, polygon_distance
from tests.examples import examples
from tests.strategies import (
    QUARTER_TURNS,
    boxes,
    lattice_polygons,
    polygon_pairs,
    poses,
    rotations,
)

QUARTERS = st.integers(-64, 64).map(lambda n: n / 4.0)


def agree(one, other):
    """True if two answers of the same truth are within their bounds."""
    return abs(one.distance - other.distance) <= one.error_bound + other.error_bound


@given(
    boxes(),
    boxes(),
    poses(),
    st.sampled_from(QUARTER_TURNS),
    st.tuples(QUARTERS, QUARTERS, QUARTERS),
)
@examples(60)
def test_a_motion_that_floats_hold_exactly_changes_nothing_but_the_last_bit(
    a, b, pose, turn, shift
):
    """A quarter turn of both bodies; a shift too where it rounds no coordinate."""
    one, other = Polyhedron(*a), Polyhedron(*b)
    motion = np.eye(4)
    motion[:3, :3] = turn
    if np.array_equal(pose[:3, 3] * 4.0, np.round(pose[:3, 3] * 4.0)):
        motion[:3, 3] = shift
    near = distance(one, other, pose_b=pose)
    moved = distance(one, other, pose_a=motion, pose_b=motion @ pose)
    assert near.contact == moved.contact
    assert agree(near, moved)


@given(boxes(), boxes(), poses(), st.integers(0, 2**32 - 1), st.floats(0.0, 1e6))
@examples(60)
def test_any_rigid_motion_of_both_bodies_changes_only_by_its_rounding(a, b, pose, seed, far):
    random = np.random.default_rng(seed)
    motion = np.eye(4)
    motion[:3, :3] = rotations(random, 1)[0]
    motion[:3, 3] = random.uniform(-far, far, 3)
    one, other = Polyhedron(*a), Polyhedron(*b)
    near = distance(one, other, pose_b=pose)
    moved = distance(one, other, pose_a=motion, pose_b=motion @ pose)
    rounding = 64 * np.spacing(far + np.abs(pose).max() + 4.0)
    assert abs(near.distance - moved.distance) <= near.error_bound + moved.error_bound + rounding


@given(lattice_polygons(max_corners=5), lattice_polygons(max_corners=5))
@examples(100)
def test_subdividing_a_polygon_changes_nothing(p, q):
    """The fan's triangles, each cut in four at the middles of its edges, which floats hold exactly."""
    whole = polygon_distance(p, q)
    pieces = []
    for k in range(1, len(p) - 1):
        a, b, c = p[0], p[k], p[k + 1]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        pieces += [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    parts = [polygon_distance(np.array(piece), q) for piece in pieces]
    least = min(parts, key=lambda near: near.distance)
    assert whole.contact == any(near.contact for near in parts)
    assert agree(whole, least)


@given(polygon_pairs(), st.lists(st.floats(1e-6, 2.0), min_size=2, max_size=4))
@examples(100)
def test_moving_away_along_the_witness_direction_adds_what_was_moved(pair, moves):
    """Flat convex polygons: the distance grows by the way, to the rounding of the moved corners."""
    p, q = pair
    near = polygon_distance(p, q)
    reach = np.abs(np.concatenate([p, q])).max()
    assume(near.distance > 1e-3 * np.ptp(np.concatenate([p, q]), axis=0).max())
    direction = (near.point_b - near.point_a) / near.distance
    assume(abs(np.linalg.norm(direction) - 1.0) < 1e-9)
    before = near.distance
    for way in sorted(moves):
        step = way * near.distance
        after = polygon_distance(p, q + step * direction).distance
        rounding = 64 * np.spacing(reach + step) + 1e-9 * step
        assert abs(after - (near.distance + step)) <= rounding
        assert after >= before - rounding
        before = after
