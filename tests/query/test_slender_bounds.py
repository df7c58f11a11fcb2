"""The error bound where the normal of a slender triangle is the least certain of all numbers."""

from fractions import Fraction

import numpy as np
import pytest

import clearance as cl
from tests.oracle.polygons import polygon_distance_sq
from tests.oracle.rationals import root

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
