"""From points or half-spaces to the merged faces of a convex polytope, by Qhull through scipy.

Coordinates are scaled to the unit cube axis by axis first: hulls have the same faces under affine maps, and
flat, needle-like and huge bodies then look alike to Qhull's tolerances. Not for: finding common points.
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadDimension, BadShape, EmptyMesh, NotFinite
from clearance.geometry.edges import rings_of, twins
from clearance.kernels.arithmetic.union_find import joined_labels


class NotSolid(BadDimension):
    """Points in one plane, or half-spaces with nothing strictly inside all of them."""


class Unbounded(BadDimension):
    """Half-spaces that leave a direction open."""


def checked_rows(given: np.ndarray, n_columns: int, what: str) -> np.ndarray:
    """The (n, k) rows as finite float64.

    Raises:
        EmptyMesh: none. BadShape: not (n, k). NotFinite: NaN or infinity.
    """
    rows = np.asarray(given, dtype=np.float64)
    if rows.size == 0:
        raise EmptyMesh(f"there are no {what}", valid="four or more")
    if rows.ndim != 2 or rows.shape[1] != n_columns:
        raise BadShape(f"{what} have shape {rows.shape}", valid=f"(n, {n_columns})")
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise NotFinite(
            f"row {bad[0]} of the {what} is {rows[bad[0]].tolist()}", valid="finite numbers"
        )
    return rows


def hull_faces(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(vertices, face starts, face vertices) of the hull, coplanar triangles merged, outward.

    Vertices are in the order of their coordinates and faces in that of their first vertices, so that what is
    near in space is near in memory.

    Raises:
        NotSolid: the points lie in a plane, to rounding.
    """
    points = np.unique(points, axis=0)
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    if len(points) < 4 or not size.all():
        raise NotSolid(f"{len(points)} different points lie in one plane", valid="points in space")
    hull = _qhull((points - low) / size)
    for group in (_groups(hull), np.arange(len(hull.simplices))):
        rings = sorted(_rings(hull, group), key=min)
        starts = np.concatenate([[0], np.cumsum([len(ring) for ring in rings])])
        flat = np.concatenate(rings)
        if (twins(flat, flat[rings_of(starts).ahead]) >= 0).all():
            used, flat = np.unique(flat, return_inverse=True)
            return points[used], starts, flat
    raise NotSolid("the hull of the points is thinner than rounding", valid="a thicker body")


def _qhull(points: np.ndarray):
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except QhullError:
        raise NotSolid(
            "the points lie in one plane, to rounding", valid="points in space"
        ) from None


def hull_corners(points: np.ndarray) -> np.ndarray:
    """(k, 3) those of points (n, 3) that are corners of their hull; all of them where Qhull finds them flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return points


def _groups(hull) -> np.ndarray:
    """(t,) the merged face of each triangle: neighbours to which Qhull gives one plane."""
    n = len(hull.simplices)
    row, column = np.repeat(np.arange(n), 3), hull.neighbors.ravel().astype(np.int64)
    same = (hull.equations[row] == hull.equations[column]).all(axis=1)
    return joined_labels(n, row[same], column[same])


def _rings(hull, group: np.ndarray) -> list[np.ndarray]:
    """The corners of each merged face in order, counter-clockwise from outside."""
    p = hull.points[hull.simplices]
    turned = np.einsum(
        "ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), hull.equations[:, :3]
    )
    triangles = np.where(turned[:, None] < 0.0, hull.simplices[:, ::-1], hull.simplices)
    members = np.split(np.argsort(group, kind="stable"), np.cumsum(np.bincount(group))[:-1])
    rings = [
        triangles[m[0]] if len(m) == 1 else _around(hull, np.unique(triangles[m]), m[0])
        for m in members
    ]
    valency = np.bincount(np.concatenate(rings), minlength=len(hull.points))
    return [ring[valency[ring] > 2] for ring in rings if (valency[ring] > 2).sum() > 2]


def _around(hull, corners: np.ndarray, i_facet: int) -> np.ndarray:
    """The corners of one flat convex face sorted by angle about its outward normal."""
    normal = hull.equations[i_facet, :3]
    aside = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    off = hull.points[corners] - hull.points[corners].mean(axis=0)
    return corners[np.argsort(np.arctan2(off @ np.cross(normal, aside), off @ aside))]


def corners_of_half_spaces(rows: np.ndarray) -> np.ndarray:
    """(n, 3) [m] the corners of {x: rows[:, :3] x + rows[:, 3] <= 0}.

    Raises:
        Unbounded: a direction is unbounded. NotSolid: nothing is strictly inside.
    """
    from scipy.optimize import linprog
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    sizes = np.linalg.norm(rows[:, :3], axis=1)
    if not sizes.all():
        raise BadDimension(f"half-space {sizes.argmin()} has the normal 0", valid="a normal")
    rows = rows / sizes[:, None]
    try:
        closed = (ConvexHull(rows[:, :3]).equations[:, 3] < -1e-12).all()
    except QhullError:
        closed = False
    if not closed:
        raise Unbounded("the half-spaces leave a direction open", valid="a bounded region")
    columns = np.column_stack([rows[:, :3], np.ones(len(rows))])
    free = [(None, None)] * 3 + [(None, None)]
    best = linprog([0.0, 0.0, 0.0, -1.0], A_ub=columns, b_ub=-rows[:, 3], bounds=free)
    if not best.success or not best.x[3] > 0.0:
        raise NotSolid("no point is strictly inside all half-spaces", valid="a solid region")
    try:
        return HalfspaceIntersection(rows, best.x[:3]).intersections
    except QhullError:
        raise NotSolid("the region is thinner than rounding", valid="a solid region") from None
