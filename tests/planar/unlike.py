"""The same curves under unlike parametrisations, made exactly enough to be told from each other's rounding."""

import math
from fractions import Fraction
from math import comb

import numpy as np

from clearance.planar.curve import Curve

CUBIC = np.array([[0, 0], [1, 2], [2, -1], [3, 0.0]])


def reparametrised(control, through):
    """Bézier control points of B(q(u)), q by its Bernstein coefficients; rational arithmetic, rounded at last."""
    control = [[Fraction(x) for x in point] for point in np.asarray(control, float).tolist()]
    through = [Fraction(str(q)) for q in through]
    rows = [[[x] for x in point] for point in control]
    while len(rows) > 1:
        rows = [
            [
                _sum(_product(p, [1 - q for q in through]), _product(r, through))
                for p, r in zip(one, two, strict=True)
            ]
            for one, two in zip(rows, rows[1:], strict=False)
        ]
    return np.array([[float(x) for x in column] for column in rows[0]]).T


def _product(one, two):
    n, m = len(one) - 1, len(two) - 1
    return [
        sum(
            comb(n, i) * comb(m, k - i) * one[i] * two[k - i]
            for i in range(max(0, k - m), min(n, k) + 1)
        )
        / comb(n + m, k)
        for k in range(n + m + 1)
    ]


def _sum(one, two):
    return [x + y for x, y in zip(one, two, strict=True)]


def semicircle(control=((1, 0), (1, 2), (-1, 2), (-1, 0))):
    """The half of the unit circle as one rational cubic."""
    return Curve.bezier(control, [1, 1 / 3, 1 / 3, 1])


def periodic_circle(n):
    """The closed cubic spline through `n` points of the unit circle."""
    angle = 2.0 * np.pi * np.arange(n + 3) / n
    reach = 6.0 / (4.0 + 2.0 * np.cos(2.0 * np.pi / n))
    points = reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Curve.bspline(points, 3, np.arange(n + 7.0))


def quintic_circle():
    """The whole unit circle as one rational quintic: z = p^2 / |p|^2, p quadratic, raised by one degree."""
    p = np.array([1.0, 1.0j, -1.0])
    above, below = (_times(_times(p, q), np.ones(2)) for q in (p, p.conj()))
    points = above / below.real
    return Curve.bezier(np.stack([points.real, points.imag], axis=1), below.real)


def _times(one, two):
    return np.array(_product(list(one.astype(complex)), list(two.astype(complex))))


HALF = np.array([[1, 0], [1, 2], [-1, 2], [-1, 0.0]])
TURN = 2.0 * math.pi


def noise(shape, seed, size):
    return size * np.random.default_rng(seed).normal(size=shape)


def warped(through, size=0.0, seed=0):
    raised = reparametrised(CUBIC, through)
    return Curve.bezier(CUBIC), Curve.bezier(raised + noise(raised.shape, seed, size))


CASES = {
    "rational cubic semicircle, arc": lambda: (semicircle(), Curve.arc([0, 0], 1, 0, math.pi)),
    "circle, periodic cubic of 1000 points": lambda: (
        Curve.circle([0, 0], 1), periodic_circle(1000),
    ),
    "circle, periodic cubic of 100 points": lambda: (
        Curve.circle([0, 0], 1), periodic_circle(100),
    ),
    "circle, rational quintic": lambda: (Curve.circle([0, 0], 1), quintic_circle()),
    "quadratic q": lambda: warped([0, 0.2, 1]),
    "cubic q": lambda: warped([0, 0.6, 0.4, 1]),
    "q = u^2, at rest at its start": lambda: warped([0, 0, 1]),
    "q = u^3": lambda: warped([0, 0, 0, 1]),
    "q beyond 1 and back": lambda: warped([0, 1.2, 1]),
    "weights 1 to 1e3": lambda: (
        Curve.bezier(CUBIC, [1, 10.0, 100.0, 1000.0]), Curve.bezier(CUBIC),
    ),
    "weights 1, 1e6, 1, the two chords": lambda: (
        Curve.bezier([[0, 0], [1, 1], [2, 0]], [1, 1e6, 1]),
        Curve.polyline([[0, 0], [1, 1], [2, 0]]),
    ),
    "weights 1 to 1e6, quadratic q": lambda: (
        Curve.bezier(CUBIC, [1, 1e2, 1e4, 1e6]), Curve.bezier(reparametrised(CUBIC, [0, 0.3, 1])),
    ),
}  # fmt: skip
for exponent in range(1, 15, 2):
    CASES[f"cubic, degree 6 copy 1e-{exponent} off"] = lambda e=exponent: warped(
        [0, 0.3, 1], 10.0**-e, e
    )
    CASES[f"semicircle 1e-{exponent} off, arc"] = lambda e=exponent: (
        semicircle(HALF + noise(HALF.shape, e, 10.0**-e)), Curve.arc([0, 0], 1, 0, math.pi),
    )  # fmt: skip
