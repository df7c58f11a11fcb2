"""Normal cones of a tree's nodes: directions of the faces that could have the nearest point to another body.

`kernels.mesh.normal_cones` says which directions a cone must contain, and why.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.geometry.edges import Ring
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.normal_cones import CONE_ROWS, MARGIN, NO_CONE, WIDEST

LEAST_TURN = 1e-12
"""Sine of an angle that rounding does not turn into its opposite."""

OUTWARD = 1.0 + 2.0**-20
"""Covers the rounding of a radius, and of the box's axes, to single precision; half sizes are no less than
`tree_build.LEAST_HALF`, where that has its usual precision."""

NARROW = 0.25
"""[rad] Cones no wider than this to either side stay about the mean."""

FEW = 128
"""Cones of nodes over more faces than that stay about the mean: hardly one of them has a cone in the end."""

STEPS = 8
"""Times that the axis of a cone is moved towards what is farthest from it."""


def node_cones(
    children: np.ndarray, boxes: np.ndarray, axes: np.ndarray, angles: np.ndarray
) -> np.ndarray:
    """(6 g, 4) `Surface.cones` from the axes (3, f) and half angles (f,) [rad] of the faces' cones.

    A cone stands for itself and its opposite, so that both sides of a thin wall have one in common. That of a node
    is about the mean of the axes below it, each turned towards the others, or better.
    """
    n_nodes = len(children)
    axis = _unit(_aligned_sums(children, axes))
    angle, n_below = np.zeros(n_nodes), np.zeros(n_nodes, dtype=np.int64)
    above = list(_nodes_above_faces(children))
    for node, face in above:
        np.maximum.at(
            angle, node, np.arccos(np.abs(_cosines(axis, node, axes, face))) + angles[face]
        )
        n_below += np.bincount(node, minlength=n_nodes)
    few = (n_below > 1) & (n_below <= FEW)
    pairs = [np.stack([node, face])[:, few[node]] for node, face in above]
    nodes, faces = np.concatenate(pairs, axis=1)
    _narrow(axis, angle, nodes, faces, axes, angles, either_way=True)
    wide = ~(angle <= WIDEST) | ~axis.any(axis=0)  # the latter are lanes without a node
    axis[:, wide] = 0.0
    cosine = np.cos(angle, where=~wide, out=np.zeros(n_nodes))
    sine = np.sin(angle, where=~wide, out=np.full(n_nodes, NO_CONE))
    return _rows(axis, cosine, sine, boxes)


def no_cones(boxes: np.ndarray) -> np.ndarray:
    """(6 g, 4) `Surface.cones` of nodes that may have the nearest point from any direction."""
    n = len(boxes) // 12 * WIDTH
    return _rows(np.zeros((3, n)), np.zeros(n), np.full(n, NO_CONE), boxes)


def _rows(axis: np.ndarray, cosine: np.ndarray, sine: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """(6 g, 4) `Surface.cones` of axes (3, n), cosines and sines of half angles (n,)."""
    half = boxes.reshape(-1, 12, WIDTH)[:, 9:].astype(np.float64)
    radius = OUTWARD * np.sqrt((half**2).sum(axis=1)).reshape(-1)
    with np.errstate(over="ignore"):  # an infinite radius says nothing of any direction
        rows = np.stack([*axis, cosine, sine, radius]).astype(np.float32)
    return rows.reshape(CONE_ROWS, -1, WIDTH).swapaxes(0, 1).reshape(-1, WIDTH)


def _aligned_sums(children: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """(3, n) for each node the sum of the axes below it, those of a child reversed where they point away."""
    total = np.zeros((3, len(children)))
    leaf = children[:, 1] == 0
    total[:, leaf] = axes[:, children[leaf, 0]]
    for inner in reversed(list(_levels(children))):
        for k in range(WIDTH):
            node = inner[children[inner, 1] > k]
            child = WIDTH * children[node, 0] + k
            away = (total[:, node] * total[:, child]).sum(axis=0) < 0.0
            total[:, node] += np.where(away, -total[:, child], total[:, child])
    return total


def _levels(children: np.ndarray) -> Iterator[np.ndarray]:
    """The nodes that are no leaves, level by level from the root down."""
    inner = np.flatnonzero(children[:1, 1] > 0)
    while len(inner):
        yield inner
        below = np.concatenate(
            [WIDTH * children[inner[children[inner, 1] > k], 0] + k for k in range(WIDTH)]
        )
        inner = below[children[below, 1] > 0]


def _nodes_above_faces(children: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """(k,) nodes and a face that lies below each: first all leaves, then the nodes above those, up to the root."""
    parent = np.full(len(children), -1)
    inner = np.flatnonzero(children[:, 1] > 0)
    for k in range(WIDTH):
        has = inner[children[inner, 1] > k]
        parent[WIDTH * children[has, 0] + k] = has
    node = np.flatnonzero(children[:, 1] == 0)
    face = children[node, 0]
    while len(node):
        yield node, face
        node = parent[node]
        has_parent = node >= 0
        node, face = node[has_parent], face[has_parent]


def face_cones(
    ring: Ring,
    twin: np.ndarray,
    vertices: np.ndarray,
    corners: np.ndarray,
    normals: np.ndarray,
    bent: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Axis (3, f) and half angle (f,) [rad] of the cone of each face, infinite where it has none.

    Args:
        twin: (c,) of `edges.twins`. vertices: (v, 3) [m]. corners: (c,) the vertex at which each half-edge starts.
        normals: (f, 3) unit, or zeros. bent: (f,) as in `Surface`.
    """
    n_faces = len(normals)
    ends = corners[ring.ahead]
    owner_of_vertex = np.full(corners.max() + 1, n_faces)
    np.minimum.at(owner_of_vertex, corners, ring.face)
    owner_of_edge = np.minimum(ring.face, np.where(twin >= 0, ring.face[twin], n_faces))
    owner = np.concatenate([np.arange(n_faces), owner_of_vertex[corners], owner_of_edge])
    around = np.concatenate([np.arange(n_faces), ring.face, ring.face])
    across = np.ascontiguousarray(normals.T)
    axes = _unit(_sums(across[:, around], owner, n_faces))
    least = np.ones(n_faces)
    np.minimum.at(least, owner, _cosines(across, around, axes, owner))
    angles = np.arccos(least)
    _narrow(axes, angles, owner, around, across, np.zeros(n_faces), either_way=False)
    angles += MARGIN
    flawed = bent | ~normals.any(axis=1) | ~_surely_convex(vertices[corners], ring, normals)
    angles[owner[flawed[around]]] = np.inf
    loose = twin < 0  # not between two faces that go along it in opposite directions
    for faces in (ring.face, owner_of_vertex[corners], owner_of_vertex[ends]):
        angles[faces[loose]] = np.inf
    return axes, angles


def _narrow(
    axes: np.ndarray, angles: np.ndarray, cone: np.ndarray, item: np.ndarray, items: np.ndarray,
    widths: np.ndarray, *, either_way: bool,
) -> None:  # fmt: skip
    """Moves axes (3, n) towards what is farthest from them, where that makes the half angles (n,) [rad] less.

    Source: Bădoiu & Clarkson 2003, smaller core-sets for balls.

    Args:
        cone, item: (k,) which cone contains which item.
        items, widths: (3, m) unit vectors and (m,) [rad] how far to all sides each reaches.
        either_way: True if an item or its opposite will do.
    """
    asked = np.flatnonzero(((angles > NARROW) & np.isfinite(angles))[cone])
    if not len(asked):
        return
    asked = asked[np.argsort(cone[asked], kind="stable")]
    cone, items, widths = cone[asked], items[:, item[asked]], widths[item[asked]]
    is_first = np.concatenate([[True], cone[1:] != cone[:-1]])
    starts, number = np.flatnonzero(is_first), np.cumsum(is_first) - 1
    cones = cone[starts]
    here = axes[:, cones]
    for step in range(STEPS):
        cosine = _cosines(here, number, items, slice(None))
        away = np.arccos(np.abs(cosine) if either_way else cosine) + widths
        most = np.maximum.reduceat(away, starts)
        less = most < angles[cones]
        axes[:, cones[less]], angles[cones[less]] = here[:, less], most[less]
        far = np.flatnonzero(away == most[number])
        to = items[:, far]
        if either_way:
            to = np.where(cosine[far] < 0.0, -to, to)
        here[:, number[far]] += (to - here[:, number[far]]) / (
            step + 3.0
        )  # if there are several, the last
        here = _unit(here)


def _surely_convex(points: np.ndarray, ring: Ring, normals: np.ndarray) -> np.ndarray:
    """(f,) True where the boundary turns at each corner (c, 3) [m]; else diagonals may stand out of the face."""
    at = np.flatnonzero(np.bincount(ring.face)[ring.face] > 3)  # triangles do
    arriving, leaving = points[at] - points[ring.behind[at]], points[ring.ahead[at]] - points[at]
    bends = (np.cross(arriving, leaving) * normals[ring.face[at]]).sum(axis=1)
    # a body far beyond reach is refused later; here it is not convex
    with np.errstate(over="ignore"):
        turns = bends > LEAST_TURN * np.sqrt((arriving**2).sum(axis=1) * (leaving**2).sum(axis=1))
    convex = np.ones(len(normals), dtype=bool)
    convex[ring.face[at[~turns]]] = False
    return convex


def _sums(vectors: np.ndarray, places: np.ndarray, n: int) -> np.ndarray:
    """(3, n) the sums of the vectors (3, k) at each of the `places` (k,)."""
    return np.stack([np.bincount(places, row, n) for row in vectors])


def _cosines(us: np.ndarray, i: np.ndarray, vs: np.ndarray, j: np.ndarray | slice) -> np.ndarray:
    """(k,) of the angles between the unit vectors `us[:, i]` and `vs[:, j]`."""
    cosine = us[0][i] * vs[0][j]
    cosine += us[1][i] * vs[1][j]
    cosine += us[2][i] * vs[2][j]
    return np.clip(cosine, -1.0, 1.0, out=cosine)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """The vectors (3, k) at length 1; those that are next to nothing are zero."""
    length = np.sqrt((vectors**2).sum(axis=0))
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 2.0**-20)
