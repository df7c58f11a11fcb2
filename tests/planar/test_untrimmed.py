"""Trimming takes nothing that matters: without it the distances are the same, on families of pairs."""

import numpy as np
import pytest

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff
from tests.examples import some_slow
from tests.planar.untrimmed import untrimmed


def walk(random, n):
    return np.cumsum(random.normal(size=(n, 2)), axis=0)


def apart(random):
    """Two walks of four to eight control points."""
    n = int(random.integers(4, 9))
    return Curve.bspline(walk(random, n)), Curve.bspline(walk(random, n))


def side_by_side(random):
    """Waves side by side, as in the paper's experiment."""
    n = int(random.integers(5, 16))
    c = np.stack([np.arange(n) * 1.0, np.cumsum(random.normal(size=n))], axis=1)
    return Curve.bspline(c), Curve.bspline(c + [0.0, 0.3] + 0.8 * random.normal(size=(n, 2)))


def of_any_degree(random):
    """Degrees 1 to 5, with corners where the degree is 1."""
    d, e = (int(k) for k in random.integers(1, 6, 2))
    return Curve.bspline(walk(random, d + 3), d), Curve.bspline(walk(random, e + 2), e)


def weighted(random):
    """A rational quadratic and a rational cubic."""
    one, two = random.uniform(0.3, 3.0, (2, 5))
    return (
        Curve.bspline(walk(random, 5), 2, weights=one),
        Curve.bspline(walk(random, 5), 3, weights=two),
    )


def round_and_free(random):
    """An arc of any sweep and a spline."""
    start, sweep = random.uniform(0.0, 6.0), random.uniform(0.5, 6.0)
    arc = Curve.arc(random.normal(size=2), random.uniform(0.5, 2.0), start, start + sweep)
    return arc, Curve.bspline(walk(random, 5))


def straight(random):
    """Polylines of two to six vertices."""
    return tuple(Curve.polyline(walk(random, int(random.integers(2, 7)))) for _ in range(2))


def far_off(random):
    """A pair at 1e6 times its own size from the origin, tiny to huge."""
    scale = 10.0 ** int(random.integers(-6, 7))
    matrix = np.array([[scale, 0.0, 1e6 * scale], [0.0, scale, -1e6 * scale]])
    return tuple(curve.transformed(matrix) for curve in apart(random))


FAMILIES = [
    (apart, 30),
    (side_by_side, 20),
    (of_any_degree, 30),
    (weighted, 4),
    (round_and_free, 20),
    (straight, 40),
    (far_off, 25),
]


@pytest.mark.parametrize(("family", "n"), FAMILIES)
def test_trimmed_agrees_with_untrimmed(family, n):
    for seed in range(n):
        a, b = family(np.random.default_rng(seed))
        one, two = hausdorff(a, b), untrimmed(a, b)
        size = max(a.size, b.size)
        for direction in ("a_to_b", "b_to_a"):
            p, q = one.directed[direction], two.directed[direction]
            assert abs(p.distance - q.distance) <= 1e-14 * size, (seed, direction)
            assert p.kind == q.kind, (seed, direction)
        assert one.direction == two.direction, seed


HARD = {
    "the same curve": (Curve.bspline([[0, 0], [1, 2], [3, 1], [4, 4]]),) * 2,
    "one straight and doubled back": (
        Curve.bezier([[0, 0], [2, 0], [-1, 0], [1, 0]]),
        Curve.bezier([[0, 1], [0.3, 0.2], [0.6, 0.3], [1, 1]]),
    ),
    "concentric circles": (Curve.circle([0, 0], 1), Curve.circle([0, 0], 1.25)),
}


@pytest.mark.parametrize("name", some_slow(HARD, {"the same curve", "concentric circles"}))
def test_systems_without_end_stop_with_a_true_bound(name):
    """Infinitely many roots, or too many to tell apart: the budget ends it, and the bound says what is left."""
    a, b = HARD[name]
    one, two = hausdorff(a, b), untrimmed(a, b)
    assert two.lower <= one.upper and one.lower <= two.upper
    assert two.error_bound <= 0.05 * a.size and two.tally.given_up > 0
    assert two.tally.systems <= 40_000 and two.tally.intervals <= 900_000
