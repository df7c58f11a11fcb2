"""A convex body as the kernels take it: two flat arrays, and a name for everything that stands in them.

`numbers`: centroid (3), the linear map into the round frame (9), greatest width, size, the square of the radius of
a ball of the round frame that is wholly inside, one spare; a row a face; a bound for each cell; the corners, three
each. A face's row: outward unit normal n, 1/w, a corner, the plane's distance w from the centroid.

`indices`: number of faces, cells along a side of the cube, where the faces' starts begin, how much later than
their corners their neighbours stand (the neighbour over an edge stands with the corner it leaves), where the
corners begin in `numbers`, three spare; the cells' starts and faces; the faces' starts, corners, neighbours. An
edge is the place of the corner that it leaves. Not for: the map of directions (`polytope.exits`).
"""

from __future__ import annotations

from typing import NamedTuple

from clearance.compile.declared import Floats, Shorts
from clearance.compile.decorators import inline

CENTROID, ROUND_FROM_BODY, GREATEST_WIDTH, SIZE, INNER_SQ = 0, 3, 12, 13, 14
HEAD, ROW = 16, 8
NORMAL, INVERSE_WIDTH, ANCHOR, WIDTH = 0, 3, 4, 7
N_FACES, N_CELLS, FIRST_START, TO_NEIGHBOURS, FIRST_PLACE = range(5)
LEAD = 8


class PackedBody(NamedTuple):
    """A convex body.

    Attributes:
        numbers: (p,) float64; indices: (q,) int32.
    """

    numbers: Floats
    indices: Shorts


@inline(force=True)
def face_number(numbers, face, what):
    """One of the numbers of a face's row: `INVERSE_WIDTH` or `WIDTH`."""
    return numbers[HEAD + ROW * face + what]


@inline(force=True)
def face_vector(numbers, face, what):
    """One of the vectors of a face's row: `NORMAL` or `ANCHOR`."""
    at = HEAD + ROW * face + what
    return numbers[at], numbers[at + 1], numbers[at + 2]


@inline(force=True)
def centroid_of(numbers):
    """The centroid [m]."""
    return numbers[CENTROID], numbers[CENTROID + 1], numbers[CENTROID + 2]


@inline(force=True)
def into_round(numbers, x, y, z):
    """A vector in the round frame."""
    m = ROUND_FROM_BODY
    return (
        numbers[m] * x + numbers[m + 1] * y + numbers[m + 2] * z,
        numbers[m + 3] * x + numbers[m + 4] * y + numbers[m + 5] * z,
        numbers[m + 6] * x + numbers[m + 7] * y + numbers[m + 8] * z,
    )


@inline(force=True)
def bound_at(indices, cell):
    """Where in `numbers` the bound of a cell stands."""
    return HEAD + ROW * indices[N_FACES] + cell


@inline(force=True)
def cell_entries(indices, cell):
    """Begin and end of a cell's faces in `indices`."""
    return indices[LEAD + cell], indices[LEAD + cell + 1]


@inline(force=True)
def face_edges(indices, face):
    """Begin and end of a face's edges: at each in `indices` the corner that it leaves."""
    at = indices[FIRST_START] + face
    return indices[at], indices[at + 1]


@inline(force=True)
def face_over(indices, edge):
    """The face on the other side of an edge."""
    return indices[edge + indices[TO_NEIGHBOURS]]


@inline(force=True)
def place_of(body, corner):
    """A corner's place [m]."""
    at = body.indices[FIRST_PLACE] + 3 * corner
    return body.numbers[at], body.numbers[at + 1], body.numbers[at + 2]


@inline(force=True)
def plane_about(numbers, face, origin):
    """(normal, offset [m]) of a face's plane about `origin`."""
    x, y, z = face_vector(numbers, face, NORMAL)
    ax, ay, az = face_vector(numbers, face, ANCHOR)
    offset = x * (ax - origin[0])
    offset += y * (ay - origin[1])
    offset += z * (az - origin[2])
    return x, y, z, offset
