"""`method="paper"`: what Kim, Oh, Kim (2010) publish, where it is wrong, and that its bounds hold."""

import numpy as np
import pytest

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff


def waves(n, seed):
    random = np.random.default_rng(seed)
    c = np.stack([np.arange(n) * 1.0, np.cumsum(random.normal(size=n))], axis=1)
    return Curve.bspline(c), Curve.bspline(c + [0.0, 0.3] + 0.8 * random.normal(size=(n, 2)))


PAIRS = [(n, seed) for n in (5, 10, 15, 30) for seed in range(4)]


@pytest.mark.parametrize(("n", "seed"), PAIRS)
def test_the_papers_answer_is_never_below_and_its_bounds_hold(n, seed):
    a, b = waves(n, seed)
    true, published = hausdorff(a, b), hausdorff(a, b, method="paper")
    assert published.distance >= true.distance - true.error_bound - 1e-13 * a.size
    assert published.lower <= true.upper and true.lower <= published.upper
    assert abs(published.distance - true.distance) <= published.error_bound + true.error_bound
    assert np.hypot(*(published.point_a - published.point_b)) == pytest.approx(published.distance)


def test_the_greatest_of_all_roots_is_not_the_distance():
    """A bump beside one leg of an arch: its tip has a common normal with the other leg, three times as long."""
    arch = Curve.polyline([[-1, 0], [-1, 4], [1, 4], [1, 0]])
    bump = Curve.bezier([[-0.9, 1], [-0.4, 1.2], [-0.4, 1.8], [-0.9, 2]])
    true = hausdorff(bump, arch).directed["a_to_b"]
    published = hausdorff(bump, arch, method="paper").directed["a_to_b"]
    tip = bump.point(0.5)[0]
    assert true.distance == pytest.approx(tip + 1.0) and published.distance >= 1.0 - tip - 1e-12
    assert published.lower <= true.distance <= published.upper < 0.5
