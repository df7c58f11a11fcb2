"""Thin regions in a frame of their own: planes from the given corners in 106 bits, cut in round coordinates.

In the world's axes the rounding of a normal, over the region's width, is an error of its thickness. In a
frame stretched to make the region round, planes that are rounded last have errors of the region's own size.
Not for: choosing the frame or the faces (`query.thin`).
"""

from __future__ import annotations

import numpy as np

from clearance.compile.declared import Floats2, Floats3, Integers2
from clearance.compile.decorators import kernel
from clearance.kernels.arithmetic.double_double import Wide3, cross3, difference, dot3, wide
from clearance.kernels.arithmetic.expansion import N_TERMS, orient3d
from clearance.kernels.arithmetic.vec3 import row


@kernel
def supporting_triples(points: Floats2) -> Integers2:
    """(t, 3) corners i < j < l of a face, counter-clockwise, whose plane no other corner is above, exactly."""
    n = len(points)
    terms = np.empty(N_TERMS)
    found = np.empty((n * (n - 1) * (n - 2) // 6, 3), dtype=np.int64)
    n_found = 0
    for i in range(n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                holds = True
                for m in range(n):
                    if m != i and m != j and m != k and holds:
                        holds = orient3d(points[i], points[j], points[k], points[m], terms) >= 0
                if holds:
                    found[n_found, 0] = i
                    found[n_found, 1] = j
                    found[n_found, 2] = k
                    n_found += 1
    return found[:n_found]


@kernel
def stretched_planes(corners: Floats3, origin: Floats2, frame: Floats2) -> Floats2:
    """(k, 4) rows (n, d): the planes n.y <= d through three corners each, where x = origin + frame y.

    Args:
        corners: (k, 3, 3) [m], counter-clockwise from outside; frame: (3, 3) columns [m].

    Exactness: each number to a few roundings, however small it is against the corners' coordinates.
    """
    planes = np.empty((len(corners), 4))
    o = row(origin, 0)
    for i in range(len(corners)):
        a = row(corners[i], 0)
        normal = cross3(difference(row(corners[i], 1), a), difference(row(corners[i], 2), a))
        most = 0.0
        for c in range(3):
            column = Wide3(wide(frame[0, c]), wide(frame[1, c]), wide(frame[2, c]))
            planes[i, c] = dot3(normal, column).hi
            most = max(most, abs(planes[i, c]))
        planes[i, 3] = dot3(normal, difference(a, o)).hi
        for c in range(4):
            planes[i, c] /= most
    return planes
