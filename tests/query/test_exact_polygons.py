"""Polygon pairs against rational arithmetic, family by family: contact, distance, bound and witness points."""

import functools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import polygon_distance, polygon_distances
from tests import oracle
from tests.examples import examples, share_of
from tests.strategies import FAMILIES, polygon_pairs


def from_least_corner(polygon):
    """The polygon read from its least corner: the fan that is measured (see clearance/query/NOTES.md)."""
    n = len(polygon)
    first = min(range(n), key=lambda i: [tuple(polygon[(i + k) % n]) for k in range(n)])
    return np.roll(polygon, -first, axis=0)


def exact_sq(p, q):
    return oracle.polygon_distance_sq(from_least_corner(p), from_least_corner(q))


def draws(name):
    """100 pairs of a family or the profile's share; of polygons with many corners those the oracle is quick on."""
    if name != "many_sided":
        return zip(*FAMILIES[name](np.random.default_rng(101), share_of(100)), strict=True)
    batches = (FAMILIES[name](np.random.default_rng(seed), 12) for seed in range(share_of(40)))
    small = ((p, q) for p, q in batches if p.shape[1] + q.shape[1] < 50)
    return [pair for p, q in small for pair in zip(p, q, strict=True)]


@functools.cache
def measured(name):
    return [(p, q, polygon_distance(p, q), exact_sq(p, q)) for p, q in draws(name)]


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_contact_is_decided_like_the_oracle(name):
    wrong = [i for i, (_, _, near, sq) in enumerate(measured(name)) if near.contact != (sq == 0)]
    assert not wrong


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_the_error_bound_is_never_violated(name):
    for _, _, near, sq in measured(name):
        assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_every_digit_is_right_where_the_distance_is_a_number(name):
    """To an ulp, or to 2^-96 of the polygons' size; a plain kernel loses six digits at a millionth of it."""
    for p, q, near, sq in measured(name):
        if sq > Fraction(2) ** -900:
            noise = Fraction(2) ** -96 * Fraction(np.ptp(np.concatenate([p, q]), axis=0).max())
            assert oracle.error(near.distance, sq) <= Fraction(2) ** -52 * oracle.root(sq) + noise


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_witness_points_are_on_their_polygons_and_realise_the_distance(name):
    for p, q, near, _ in measured(name):
        ulp = 8 * np.spacing(max(np.abs(p).max(), np.abs(q).max()))
        gap = np.linalg.norm(near.point_a - near.point_b)
        assert abs(gap - near.distance) <= near.error_bound + ulp
        for point, polygon in ((near.point_a, p), (near.point_b, q)):
            off_sq = oracle.point_polygon_distance_sq(point, from_least_corner(polygon))
            assert off_sq <= Fraction(ulp + near.error_bound) ** 2


def test_the_bound_is_tight_for_triangles():
    for name in ("anywhere", "scaled", "needles", "near_parallel_edges"):
        errors = [
            (near.error_bound, float(oracle.error(near.distance, sq)))
            for p, q, near, sq in measured(name)
        ]
        ratios = [bound / error for bound, error in errors if error > 0.0]
        assert np.median(ratios) <= 100.0


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_batches_and_single_calls_agree_bit_for_bit(name):
    p, q = FAMILIES[name](np.random.default_rng(5), 20)
    single = [polygon_distance(*pair).distance for pair in zip(p, q, strict=True)]
    assert np.array_equal(polygon_distances(p, q), single)


def same(one, other, factor=1.0):
    return (
        factor * one.distance == other.distance
        and factor * one.error_bound == other.error_bound
        and np.array_equal(factor * one.point_a, other.point_a)
        and np.array_equal(factor * one.point_b, other.point_b)
    )


@given(polygon_pairs())
@examples(100)
def test_swapping_the_polygons_swaps_the_answer_bit_for_bit(pair):
    p, q = pair
    near, swapped = polygon_distance(p, q), polygon_distance(q, p)
    assert near.distance == swapped.distance and near.error_bound == swapped.error_bound
    if not np.array_equal(from_least_corner(p), from_least_corner(q)):
        assert np.array_equal(near.point_a, swapped.point_b)
        assert np.array_equal(near.point_b, swapped.point_a)


@given(polygon_pairs(), st.integers(0, 70), st.integers(0, 70))
@examples(100)
def test_rotating_the_corners_changes_no_bit(pair, i, j):
    p, q = pair
    turned = polygon_distance(np.roll(p, i, axis=0), np.roll(q, j, axis=0))
    assert same(polygon_distance(p, q), turned)


@given(polygon_pairs(), st.integers(-300, 300))
@examples(100)
def test_scaling_by_a_power_of_two_scales_the_answer_exactly(pair, k):
    p, q = pair
    if np.abs(np.concatenate([p, q]))[np.concatenate([p, q]) != 0.0].min(initial=1.0) < 1e-100:
        return  # such coordinates lose digits below the least double
    factor = 2.0**k
    assert same(polygon_distance(p, q), polygon_distance(factor * p, factor * q), factor)


@pytest.mark.slow
@given(polygon_pairs())
@examples(80)
def test_any_pair_of_polygons(pair):
    p, q = pair
    near, sq = polygon_distance(p, q), exact_sq(p, q)
    assert near.contact == (sq == 0)
    assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)


def test_near_parallel_segments_of_the_field():
    """Edges for which PQP's formula loses 1e-2; a degenerate triangle stands for each segment."""
    p = np.array([[0.012711, -0.000688, -0.001097], [0.012895, -0.000686, -0.001133]])
    q = np.array([[0.012676, -0.000689, -0.000999], [0.012859, -0.000687, -0.001034]])
    near = polygon_distance(p[[0, 1, 1]], q[[0, 1, 1]])
    assert near.distance == pytest.approx(8.968156938e-5, rel=1e-9)
    assert oracle.error(near.distance, oracle.segment_distance_sq(*p, *q)) <= Fraction(
        near.error_bound
    )
