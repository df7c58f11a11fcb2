"""Two parts of two surfaces, one of each, and the poses of the surfaces: the start of most questions of a pair."""

from typing import Annotated, NamedTuple

from clearance.compile.declared import LentTo
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import Frames
from clearance.kernels.mesh.surface import Surface


class PosedPair(NamedTuple):
    """Two parts of two surfaces: faces, nodes of their trees or bodies, as the argument's name says.

    Attributes:
        surface_a, surface_b: lent, so that a call passes two addresses and no arrays.
        a, b: the part of each.
        frames: of `frames_of`.
    """

    surface_a: Annotated[Surface, LentTo]
    a: int
    surface_b: Annotated[Surface, LentTo]
    b: int
    frames: Frames


@inline(force=True)
def parts(pair, a, b):
    """Two other parts of the same surfaces."""
    return PosedPair(pair.surface_a, a, pair.surface_b, b, pair.frames)
