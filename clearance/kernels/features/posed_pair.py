"""Two parts of two surfaces, one of each, and how the surfaces lie: what most questions of a pair begin with."""

from typing import NamedTuple

from clearance.compile.jit import inline
from clearance.compile.kernel_table import LentArgument
from clearance.kernels.arithmetic.double_double import FRAMES_AT_REST, Frames
from clearance.kernels.mesh.surface import surface_like


class PosedPair(NamedTuple):
    """Two parts of two surfaces: faces, nodes of their trees or bodies, as the argument's name says.

    Attributes:
        surface_a, surface_b: lent (`kernel_table.lend`), so that a call hands over two addresses and no arrays.
        a, b: the part of each.
        frames: of `frames_of`.
    """

    surface_a: object
    a: int
    surface_b: object
    b: int
    frames: Frames


@inline(force=True)
def parts(pair, a, b):
    """Two other parts of the same surfaces."""
    return PosedPair(pair.surface_a, a, pair.surface_b, b, pair.frames)


def posed_pair_like():
    """A pair, by its type."""
    return PosedPair(
        LentArgument(surface_like()), 0, LentArgument(surface_like()), 0, FRAMES_AT_REST
    )
