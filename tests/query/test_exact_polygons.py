"""Polygon pairs against rational arithmetic, family by family; faces that pierce one another, and needles."""

import functools
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance import polygon_distance, polygon_distances
from scripts.makers.polygon_pairs import from_least_corner
from tests import oracle
from tests.examples import examples, share_of
from tests.oracle.polygons import polygon_distance_sq
from tests.oracle.rationals import root
from tests.strategies import FAMILIES, polygon_pairs


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
def test_contact_every_digit_its_bound_and_the_witness_points_are_like_the_oracle(name):
    """To an ulp, or to 2^-96 of the polygons' size; a plain kernel loses six digits at a millionth of it."""
    for p, q, near, sq in measured(name):
        assert near.contact == (sq == 0)
        assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)
        if sq > Fraction(2) ** -900:
            noise = Fraction(2) ** -96 * Fraction(np.ptp(np.concatenate([p, q]), axis=0).max())
            assert oracle.error(near.distance, sq) <= Fraction(2) ** -52 * oracle.root(sq) + noise
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


@given(polygon_pairs(), st.integers(0, 70), st.integers(0, 70), st.integers(-300, 300))
@examples(100)
def test_swapped_or_turned_nothing_changes_and_all_scales_with_a_power_of_two(pair, i, j, k):
    """Bit for bit; of two equal polygons the points are not those of either."""
    p, q = pair
    near, swapped = polygon_distance(p, q), polygon_distance(q, p)
    if np.array_equal(from_least_corner(p), from_least_corner(q)):
        assert (near.distance, near.error_bound) == (swapped.distance, swapped.error_bound)
    else:
        assert same(near, replace(swapped, point_a=swapped.point_b, point_b=swapped.point_a))
    assert same(near, polygon_distance(np.roll(p, i, axis=0), np.roll(q, j, axis=0)))
    corners = np.abs(np.concatenate([p, q]))
    if corners[corners > 0.0].min(initial=1.0) >= 1e-100:  # less lose digits below the least double
        assert same(near, polygon_distance(2.0**k * p, 2.0**k * q), 2.0**k)


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


BESIDE = (0.0, 1e-300, 1e-17, 1e-16, 1e-14, 1e-11, 1e-6, 1e-2, 0.5)


def convex(rng: np.random.Generator, n_corners: int, slenderness: float) -> np.ndarray:
    """(n, 3) a convex polygon in a coordinate plane, exactly flat."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, n_corners))
    corners = np.column_stack([np.cos(angles), slenderness * np.sin(angles), np.zeros(n_corners)])
    return corners[:, rng.permutation(3)]


@examples(300)
@given(
    st.integers(0, 2**32 - 1), st.integers(3, 7), st.sampled_from(BESIDE), st.booleans(),
    st.sampled_from([1.0, 1e-3, 1e-7]), st.sampled_from([0.0, 1.0, 1e4]),
)  # fmt: skip
def test_contact_of_a_piercing_face_is_exact(seed, n_corners, beside, outside, slenderness, away):
    """A triangle goes through the plane of a face beside a point of an edge, its corners far from the face."""
    rng = np.random.default_rng(seed)
    face = convex(rng, n_corners, slenderness)
    i = rng.integers(n_corners)
    corner, following = face[i], face[(i + 1) % n_corners]
    at = corner + rng.uniform(-0.1, 1.1) * (following - corner)
    out = at - face.mean(axis=0)
    at = at + (1.0 if outside else -1.0) * beside * out / max(np.linalg.norm(out), 1e-300)
    direction = rng.normal(size=3)
    piercing = np.array(
        [at - direction, at + rng.uniform(0.5, 2.0) * direction, at + 3.0 * rng.normal(size=3)]
    )
    shift = away * rng.integers(-4, 5, 3)
    face, piercing = face + shift, piercing + shift
    found = polygon_distance(face, piercing), polygon_distance(piercing, face)
    truth = polygon_distance_sq(face, piercing)
    for answer in found:
        assert answer.contact == (truth == 0)
        assert answer.distance == pytest.approx(
            float(truth) ** 0.5, rel=1e-12, abs=1e-15 * (1.0 + 4.0 * away)
        )


NEARLY_TOUCHING = [
    (
        [[-1.382616204177022, 0.19321875160259425, 0.4524802510839217],
         [-1.3945506843426108, -1.4288736304505336, 1.0828683963389525],
         [-1.3839569494050161, 0.010990216382078921, 0.5232990940055253]],
        [[-1.3932807543344152, -1.2562691336749507, 1.015789708275826],
         [-2.3932807543344152, 4.743730866325049, 3.0157897082758263],
         [-2.3932807543344152, -0.25626913367495074, 3.0157897082758263]],
    ),
    (
        [[0.0420194719450008, -0.17551645199409543, 0.8012928872505272],
         [-0.5105623469439452, -0.8166631234553791, -2.8778638394402525],
         [-0.33810111681757543, -0.684415232835813, -1.653702894154667]],
        [[-0.1305638617616431, -0.5752223406368394, -0.12469587432396158],
         [0.16070942116269363, 0.0993714921154576, 1.43811901353772],
         [-0.05228155381433528, -0.3939191841820066, 0.2953246344274365]],
    ),
    (
        [[0.7001662121893211, -0.5867323946702635, -1.6141242993134088e-09],
         [-0.7798667078120805, 3.388621482660107, -5.554496122519355e-10],
         [-0.11449539329571876, -0.41981100404052507, -7.374183959082534e-10]],
        [[-0.8816547085836236, 3.5798768403937817, -0.015086949163100863],
         [-0.11144646638529676, 2.132688058070693, 0.09907279539971088],
         [-0.555591149920125, 2.967217174388166, 0.03324197089699118]],
    ),
]  # fmt: skip


def off_by(p, q):
    """(|distance - truth|, error bound), both exact."""
    near = cl.polygon_distance(p, q)
    truth = root(polygon_distance_sq(p.tolist(), q.tolist()), 80)
    return abs(Fraction(near.distance) - truth), Fraction(near.error_bound)


@pytest.mark.parametrize("pair", NEARLY_TOUCHING, ids=["needle", "coplanar", "flat"])
@pytest.mark.parametrize("swapped", [False, True])
def test_the_bound_holds_over_a_slender_triangle(pair, swapped):
    p, q = (np.array(side) for side in (reversed(pair) if swapped else pair))
    error, bound = off_by(p, q)
    assert 0 < error <= bound


def test_the_bound_holds_under_corners_a_hair_over_needles():
    random = np.random.default_rng(71)
    for _ in range(60):
        a, b = random.normal(size=(2, 3))
        off = 10.0 ** random.uniform(-9, -3) * random.normal(size=3)
        needle = np.array([a, b, a + random.uniform(0.2, 0.8) * (b - a) + off])
        over = needle.mean(axis=0) + 10.0 ** random.uniform(-17, -8) * random.normal(size=3)
        other = np.array([over, over + random.normal(size=3), over + random.normal(size=3)])
        error, bound = off_by(needle, other)
        assert error <= bound
