"""Hulls of what edges sweep: all points inside, no more corners than points, however slender they are."""

from __future__ import annotations

import numpy as np

from clearance.kernels.profile.swept_hulls import MOST, fattened_hull, hull_of


def slender(rng: np.random.Generator) -> np.ndarray:
    """(4, 2) points on a line, but for rounding."""
    a, b = rng.normal(size=(2, 2))
    points = a + rng.random(4)[:, None] * (b - a)
    if rng.random() < 0.5:
        points[:, 1] = points[0, 1] * (1.0 + rng.integers(-2, 3, 4) * np.finfo(float).eps)
    return points


def test_the_hull_of_points_on_a_line_has_each_once_and_widened_holds_them_all():
    rng = np.random.default_rng(0)
    for _ in range(300):
        points, width = slender(rng), float(10.0 ** rng.uniform(-7, -2))
        out, widened = np.empty((40, 2)), np.empty((16, 2))
        assert hull_of(points.copy(), 4, out) <= 4
        n = fattened_hull(points.copy(), 4, width, widened, out)
        assert 4 <= n <= MOST
        corners = out[:n]
        sides = np.roll(corners, -1, axis=0) - corners
        for point in points:
            away = point - corners
            assert (sides[:, 0] * away[:, 1] - sides[:, 1] * away[:, 0] >= -1e-15).all()
