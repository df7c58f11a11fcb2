"""Curves that nearly coincide under unlike parametrisations: few intervals, tight bounds, and the bounds hold.

What holds is shown in 80-bit floats: feet of many points by the golden section from dense samples, sharing nothing
with the package.
"""

import numpy as np
import pytest

from clearance.planar.hausdorff import hausdorff, within
from tests.oracle import planar_hausdorff as oracle
from tests.planar.unlike import CASES, warped

pytestmark = pytest.mark.skipif(not oracle.PRECISE, reason="no extended floats on this machine")


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_near_coincident_curves_are_closed_in_on(name):
    """As many intervals as some milliseconds hold, a bound of a millionth of what was asked, and it is true."""
    a, b = CASES[name]()
    found, size = hausdorff(a, b), max(a.size, b.size)
    assert found.error_bound <= 1e-12 * size
    assert (
        found.tally.intervals <= 1100 + 3 * (a.n_pieces + b.n_pieces) and found.tally.given_up == 0
    )
    exact_a, exact_b = (extended(curve) for curve in (a, b))
    worst = max(farthest(exact_a, exact_b, 200), farthest(exact_b, exact_a, 200))
    slack = a.rounding + b.rounding
    assert worst <= found.upper + slack
    at_witness = feet(
        exact_b if found.direction == "a_to_b" else exact_a,
        np.array([found.point_a if found.direction == "a_to_b" else found.point_b], oracle.REAL),
    )
    assert at_witness.max() >= found.lower - slack


@pytest.mark.parametrize("exponent", [3, 6, 9, 12])
def test_the_limit_decides_near_coincident_curves(exponent):
    """Above and below the distance by a thousandth of it: True and False."""
    a, b = warped([0, 0.3, 1], 10.0**-exponent, exponent)
    distance = hausdorff(a, b).distance
    assert within(a, b, 1.001 * distance + 1e-13) and not within(a, b, 0.999 * distance - 1e-13)


def extended(curve):
    """The pieces as (control (n, degree + 1, 3)) in extended floats, in the plane's coordinates."""
    first, out = curve.pieces.first, []
    for i in range(curve.n_pieces):
        rows = curve.pieces.control[first[i] : first[i + 1]].astype(oracle.REAL)
        rows[:, :2] += curve.origin.astype(oracle.REAL) * rows[:, 2:]
        out.append(rows)
    return out


def position(rows, t):
    """Points (k, 2) at the parameters `t` (k,), by de Casteljau.

    `rows` is one piece (degree + 1, 3), or as many as there are parameters (k, degree + 1, 3).
    """
    row = np.broadcast_to(rows, (len(t), *rows.shape[-2:]))
    t = t[:, None, None]
    while row.shape[1] > 1:
        row = row[:, :-1] + t * (row[:, 1:] - row[:, :-1])
    return row[:, 0, :2] / row[:, 0, 2:]


def farthest(one, two, n):
    t = (np.arange(max(3, n // len(one) + 1)) / oracle.REAL(max(2, n // len(one)))).astype(
        oracle.REAL
    )
    points = np.concatenate([position(rows, t) for rows in one])
    return feet(two, points).max()


def feet(parts, points):
    """Distances of points to the nearest of the parts: dense samples, then the golden section about the best.

    Of one part the four deepest dips are followed, of many parts the nearest sample, on the parts beside as well.
    """
    step = max(8, 4000 // len(parts))
    t = np.arange(step + 1) / oracle.REAL(step)
    gaps = np.stack([_gaps_sq(points, position(rows, t)) for rows in parts])
    best, n_rows = (
        np.full(len(points), oracle.REAL(np.inf)),
        np.array([len(rows) for rows in parts]),
    )
    around = np.pad(gaps, ((0, 0), (0, 0), (1, 1)), constant_values=np.inf)
    dips = np.where((gaps <= around[:, :, :-2]) & (gaps <= around[:, :, 2:]), gaps, np.inf)
    flat = dips.transpose(1, 0, 2).reshape(len(points), -1)
    for k in np.argpartition(flat, range(4), axis=1)[:, :4].T:
        part, start = k // (step + 1), t[k % (step + 1)]
        is_dip = flat[np.arange(len(points)), k] < np.inf
        for degree in set(n_rows):
            mine = is_dip & (n_rows[part] == degree)
            if mine.any():
                rows = np.array([parts[i] for i in part[mine]])
                found = slid(rows, points[mine], start[mine], 1.0 / step)
                best[mine] = np.minimum(best[mine], found)
    return np.sqrt(best)


def _gaps_sq(points, grid):
    return ((points[:, None] - grid).astype(float) ** 2).sum(-1)


GOLDEN = (np.sqrt(oracle.REAL(5)) - 1) / 2
SHRINKS = 76
"""How often a bracket of two steps of the grid shrinks: to less than the spacing of extended floats below 1."""


def slid(rows, points, t, reach):
    """The least squared distance near `t`: a bracket shrunk by the golden section, ends included."""

    def gap_sq(at):
        return ((position(rows, at) - points) ** 2).sum(-1)

    low, high = np.maximum(t - reach, 0), np.minimum(t + reach, 1)
    one, two = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    left, right = gap_sq(one), gap_sq(two)
    for _ in range(SHRINKS):
        is_left = left <= right
        low, high = np.where(is_left, low, one), np.where(is_left, two, high)
        width = GOLDEN * (high - low)
        new = np.where(is_left, high - width, low + width)
        there = gap_sq(new)
        one, two = np.where(is_left, new, two), np.where(is_left, one, new)
        left, right = np.where(is_left, there, right), np.where(is_left, left, there)
    return np.minimum(left, right)
