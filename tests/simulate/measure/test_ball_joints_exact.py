"""The certified bound of two bodies that float and tumble, against distances in fractions."""

from fractions import Fraction

import numpy as np
import pytest

import clearance as cl
from tests import oracle
from tests.made_cases import faces_of
from tests.oracle.kinematics import rotation_of
from tests.oracle.rationals import exact_points
from tests.simulate.measure import floating
from tests.simulate.measure.floating import two_floating

GRID = 1 << 150


def of_length_one(q):
    """Fractions on a grid of 2^-150."""
    length = oracle.root(sum(x * x for x in q))
    return [Fraction(round(x / length * GRID), GRID) for x in q]


def bisected(before, after, share):
    """The orientation at a share k / 2^n of an arc, by halving: in the middle of p and q is p + q."""
    p, q = (of_length_one([Fraction(x) for x in ends]) for ends in (before, after))
    if sum(a * b for a, b in zip(p, q, strict=True)) < 0:
        q = [-x for x in q]
    low, high = Fraction(0), Fraction(1)
    while low < share < high:
        between, half = of_length_one([a + b for a, b in zip(p, q, strict=True)]), (low + high) / 2
        if share < half:
            q, high = between, half
        else:
            p, low = between, half
    return p if share == low else q


def placed_exactly(points, base, before, after, share):
    """Corners, at a share of the way from one row (x, y, z, quaternion) to the next, in fractions."""
    rows = rotation_of(bisected(before[3:], after[3:], share))
    there = [
        Fraction(base[i]) + Fraction(before[i]) + share * (Fraction(after[i]) - Fraction(before[i]))
        for i in range(3)
    ]
    return [
        tuple(sum(r * x for r, x in zip(rows[i], point, strict=True)) + there[i] for i in range(3))
        for point in points
    ]


@pytest.mark.parametrize("turn", [2.5, np.pi, 1e-9])
@pytest.mark.parametrize("seed", range(1))
def test_no_bound_is_above_exact_distances(seed, turn):
    """At 65 places of an interval, in fractions; the bound is within its gap of what they see."""
    scene = two_floating(np.random.default_rng(seed), 2, turn, far=0.3)
    shapes = [cl.box((0.3, 0.2, 0.1)), cl.box((0.2, 0.2, 0.3))]
    scene = scene._replace(shapes=shapes, frames=[4, 8], pairs=[(0, 1)])
    bounds = floating.certified(scene)
    corners, faces = (
        [of(s) for s in shapes] for of in (lambda s: exact_points(s.vertices), faces_of)
    )
    before, after = scene.positions.tolist()
    found = []
    for k in range(65):
        share = Fraction(k, 64)
        a = placed_exactly(corners[0], (0.0, 0.0, 0.0), before[:7], after[:7], share)
        b = placed_exactly(corners[1], (0.1, -0.2, 0.3), before[7:], after[7:], share)
        found.append(oracle.polyhedron_distance_sq(a, faces[0], b, faces[1]))
    assert 0.0 < bounds.lower[0]
    assert Fraction(float(bounds.lower[0])) ** 2 <= min(found)
    assert float(min(found)) ** 0.5 - bounds.lower[0] < 0.01
