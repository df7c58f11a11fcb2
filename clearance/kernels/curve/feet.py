"""Compiled nearest points of a curve to many points, certified. Not for: one point (`curve.nearest`)."""

import numpy as np

from clearance.compile.declared import Floats2
from clearance.compile.decorators import kernel
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import Pieces
from clearance.kernels.curve.nearest import nearest
from clearance.kernels.curve.scratch import new_scratch, widest


@kernel
def feet(pieces: Pieces, leaves: Leaves, points: Floats2, out: Floats2):
    """Writes distance, proven lower bound, piece and local parameter (n, 4) of each of `points` (n, 2)."""
    work = new_scratch(widest(pieces), 0)
    hint = 0
    for k in range(points.shape[0]):
        foot = nearest(pieces, leaves, points[k, 0], points[k, 1], hint, np.inf, work)
        hint = foot.leaf
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = (
            foot.distance,
            foot.lower,
            foot.piece,
            foot.local,
        )
