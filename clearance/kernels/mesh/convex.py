"""Whether polygons are clearly convex: a quick test that most pass.

Not for: refusing a polygon (`geometry.faces` tests the others again).
"""

import numpy as np

from clearance.compile.declared import Floats3
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import Vec3, add, cross, dot, row, sub

FLAT = 1e-12
"""[-] Greatest distance of corners from the plane, relative to the polygon's size."""


@inline
def _seems_convex(corners):
    n = len(corners)
    first, total, size = row(corners, 0), Vec3(0.0, 0.0, 0.0), 0.0
    for i in range(1, n - 1):
        side = sub(row(corners, i), first)
        total = add(total, cross(side, sub(row(corners, i + 1), first)))
        size = max(size, dot(side, side))
    if not 1e-200 < dot(total, total) < 1e200:
        return False
    tolerance = FLAT * np.sqrt(
        max(size, dot(sub(row(corners, n - 1), first), sub(row(corners, n - 1), first)))
    )
    tolerance *= np.sqrt(dot(total, total))
    for i in range(n):
        here, ahead, after = row(corners, i), row(corners, (i + 1) % n), row(corners, (i + 2) % n)
        if not dot(cross(sub(ahead, here), sub(after, ahead)), total) > 0.0:
            return False
        if not abs(dot(sub(here, first), total)) <= tolerance:
            return False
        if 1 <= i < n - 1 and not dot(cross(sub(here, first), sub(ahead, first)), total) > 0.0:
            return False
    return True


@kernel
def seem_convex(polygons: Floats3) -> bool:
    """True if all polygons (k, n, 3) turn one way only, once round, in a plane; False if one is in doubt."""
    for i in range(len(polygons)):
        if not _seems_convex(polygons[i]):
            return False
    return True
