"""Our answers compared with FCL's: the same bodies, in millimetres, at every step and for every
pair.

Nothing here calls our own distance code: the peer measures, numpy bounds what the peer may skip,
and a winding number shows what lies inside a closed body. Not for: measuring (room `simulate`).
"""

from clearance.crosscheck.compare import cross_check
from clearance.crosscheck.pairs import MOST_POINTS, is_too_large

__all__ = ["MOST_POINTS", "cross_check", "is_too_large"]
