"""Truncated power series of one variable t in [-1, 1], many at a time, and what their remainders come to.

A series is an array (ORDER + 1, n, ...): the coefficients of t^0 to t^ORDER. The remainder of a function is at
most the coefficient of t^(ORDER + 1) of a majorant of it about every point of [-1, 1] (Lagrange). Not for: what
the series are of (`enclosure`).
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev

ORDER = 6

_TO_CHEBYSHEV = np.array(
    [np.pad(chebyshev.poly2cheb([0.0] * k + [1.0]), (0, ORDER - k)) for k in range(ORDER + 1)]
)


def product(a: np.ndarray, b: np.ndarray, times: np.ufunc = np.multiply) -> np.ndarray:
    """(m, n, ...) the product of two series of m terms, or of two majorants: elementwise, or as `times` says."""
    terms = (sum(times(a[i], b[k - i]) for i in range(k + 1)) for k in range(len(a)))
    return np.stack([*terms])


def matrix_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, 3, m) the product of series of matrices (…, 3, 3) and (…, 3, m)."""
    return product(a, b, np.matmul)


def sine_and_cosine(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The series (ORDER + 1, n) of the sine and the cosine of a series.

    Source: sin' = cos q', cos' = -sin q', coefficient by coefficient.
    """
    sine, cosine = np.empty_like(angle), np.empty_like(angle)
    sine[0], cosine[0] = np.sin(angle[0]), np.cos(angle[0])
    for k in range(1, ORDER + 1):
        parts = range(1, k + 1)
        sine[k] = sum(i * angle[i] * cosine[k - i] for i in parts) / k
        cosine[k] = -sum(i * angle[i] * sine[k - i] for i in parts) / k
    return sine, cosine


def turns_about(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, 3, 3) the series of the rotations about unit axes (3,) or (n, 3) by a series of angles
    (ORDER + 1, n) [rad] (Rodrigues)."""
    cross = np.cross(axis[..., None, :], -np.eye(3))
    sine, cosine = sine_and_cosine(angle)
    versine = -cosine
    versine[0] += 1.0
    found = sine[:, :, None, None] * cross + versine[:, :, None, None] * (cross @ cross)
    found[0] += np.eye(3)
    return np.asarray(found)


def greatest(series: np.ndarray) -> np.ndarray:
    """(n, ...) an upper bound of the absolute value over [-1, 1]: the sum of its Chebyshev coefficients."""
    in_chebyshev = np.tensordot(_TO_CHEBYSHEV, series, axes=(0, 0))
    return np.asarray(np.abs(in_chebyshev).sum(axis=0))


def moved(series: np.ndarray) -> np.ndarray:
    """(ORDER + 2, n, ...) a majorant about any point of [-1, 1] of a polynomial of degree 3, without its value."""
    a1, a2, a3 = (np.abs(series[k]) for k in (1, 2, 3))
    found = np.zeros((ORDER + 2, *series.shape[1:]))
    found[1], found[2], found[3] = a1 + 2.0 * a2 + 3.0 * a3, a2 + 3.0 * a3, a3
    return found


def majorant_of_turns(turned: np.ndarray) -> np.ndarray:
    """(ORDER + 2, n) a majorant of a product of rotations by angles whose majorants sum to `turned`: its
    exponential."""
    found = np.zeros_like(turned)
    found[0] = 1.0
    for k in range(1, ORDER + 2):
        found[k] = sum(i * turned[i] * found[k - i] for i in range(1, k + 1)) / k
    return found
