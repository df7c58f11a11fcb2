"""Nesting of the closed components of a surface: which are inside out, and which make a solid together.

A part is a connected component. Not for: whether a body lies in another one (`kernels.search.containment`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.topology import component_volumes

SAMPLES = 16
"""Corners of a part to test against another part, besides its six outermost."""

ON = 1e-9
"""[-] Rounding error for a point on a triangle, relative to the product of the distances of its corners."""


_ASKEW = np.array([[2.0, -3.0, 6.0], [6.0, -2.0, -3.0], [3.0, 6.0, 2.0]]) / 7.0
"""A rotation after which few edges of CAD parts are parallel to an axis, so that few rays hit one."""


class _Part(NamedTuple):
    """The triangles of a part: corners (m, 3, 3), and the least and greatest coordinates (3, m) of each."""

    corners: np.ndarray
    low: np.ndarray
    high: np.ndarray


def inside_out_components(
    vertices: np.ndarray, triangles: np.ndarray, component: np.ndarray, closed: np.ndarray
) -> np.ndarray:
    """(n_components,) True for closed components that are inside out and not the wall of a cavity.

    If an outermost component is inside out, components in it are solid at even depth and cavities at odd depth,
    whichever way they face. Else a component of negative volume is a cavity if a solid surrounds it, and one of
    positive volume is solid. A component without volume, up to rounding, is never inside out.

    Args:
        vertices: (n, 3) [m]. triangles: (m, 3). component: (m,) of each triangle. closed: (n_components,).
    """
    volumes = component_volumes(vertices, triangles, component, len(closed))
    if not (closed & (volumes < 0.0)).any():
        return np.zeros(len(closed), dtype=bool)
    rows = {i: row for i, row in enumerate(_rows_of(component, len(closed))) if closed[i]}
    parts = _parts(vertices @ _ASKEW.T, triangles, rows, volumes)
    holders = _holders(parts)
    wrong = np.zeros(len(closed), dtype=bool)
    for i in sorted(parts, key=lambda part: len(holders[part])):
        wrong[i] = _is_wrong(i, holders, volumes, wrong)
    return wrong


def solids(
    vertices: np.ndarray, triangles: np.ndarray, component: np.ndarray, n_components: int
) -> list[np.ndarray]:
    """The triangles (k, 3) of each solid: an outer component with the cavities in it, outward.

    Where no boxes of outer components meet, all triangles are one solid. The body is the union of its solids.

    Args:
        vertices: (n, 3) [m]. triangles: (m, 3) of closed components. component: (m,) of each triangle.
    """
    volumes = component_volumes(vertices, triangles, component, n_components)
    if (volumes > 0.0).sum() < 2:
        return [triangles]
    rows = dict(enumerate(_rows_of(component, n_components)))
    parts = _parts(vertices, triangles, rows, volumes)
    outer = [i for i in parts if volumes[i] > 0.0]
    if not _any_boxes_meet([parts[i] for i in outer]):
        return [triangles]
    holders, found = _holders(parts), {i: [triangles[rows[i]]] for i in outer}
    for i in parts.keys() - outer:
        about = [j for j in holders[i] if volumes[j] > 0.0]
        if about:
            found[min(about, key=lambda j: volumes[j])].append(triangles[rows[i]])
        else:
            found[i] = [triangles[rows[i]][:, ::-1]]
    return [np.concatenate(one) for one in found.values()]


def _any_boxes_meet(parts: list[_Part]) -> bool:
    low = np.array([part.low.min(axis=1) for part in parts])
    high = np.array([part.high.max(axis=1) for part in parts])
    return any(
        ((low[i + 1 :] <= high[i]) & (low[i] <= high[i + 1 :])).all(axis=1).any()
        for i in range(len(parts) - 1)
    )


def _rows_of(component: np.ndarray, n_components: int) -> list[np.ndarray]:
    """The rows of each component, by (m,) the component of each row."""
    order = np.argsort(component, kind="stable")
    ends = np.searchsorted(component[order], np.arange(1, n_components))
    return np.split(order, ends)


def _parts(
    vertices: np.ndarray, triangles: np.ndarray, rows: dict[int, np.ndarray], volumes: np.ndarray
) -> dict[int, _Part]:
    """The components, by their rows, that have a volume."""
    found = {i: vertices[triangles[row]] for i, row in rows.items()}
    return {
        i: _Part(corners, corners.min(axis=1).T.copy(), corners.max(axis=1).T.copy())
        for i, corners in found.items()
        if abs(volumes[i]) > _rounding_of_volume(corners)
    }


def _is_wrong(
    i: int, holders: dict[int, list[int]], volumes: np.ndarray, wrong: np.ndarray
) -> bool:
    """Whether a part is inside out, once that is known of all parts around it."""
    about = holders[i]
    is_cavity = bool(volumes[i] < 0.0)
    if any(not holders[j] and volumes[j] < 0.0 for j in [*about, i]):
        return is_cavity != (len(about) % 2 == 1)
    solid_about = sum(1 if (volumes[j] > 0.0) != wrong[j] else -1 for j in about)
    return is_cavity and solid_about == 0


def _holders(parts: dict[int, _Part]) -> dict[int, list[int]]:
    """The parts that each part lies in; none where it reaches out of them."""
    names = list(parts)
    low = np.array([part.low.min(axis=1) for part in parts.values()])
    high = np.array([part.high.max(axis=1) for part in parts.values()])
    found: dict[int, list[int]] = {}
    for place, name in enumerate(names):
        about = (low <= low[place]).all(axis=1) & (high >= high[place]).all(axis=1)
        about[place] = False
        others = [names[j] for j in np.flatnonzero(about)]
        found[name] = [other for other in others if _lies_in(parts[name], parts[other])]
    return found


def _lies_in(part: _Part, other: _Part) -> bool:
    """True if some of a part's corners are in another part and none is outside it.

    One corner is enough if no triangle of the other part is near this part's box.
    """
    low, high = part.low.min(axis=1), part.high.max(axis=1)
    near = ((other.low.T <= high) & (other.high.T >= low)).T.all(axis=0).any()
    points = _points_of(part.corners) if near else part.corners[0, :1]
    inside = [_is_inside(other, point) for point in points]
    return True in inside and False not in inside


def _points_of(corners: np.ndarray) -> np.ndarray:
    """(k, 3) some corners of a part, its outermost along the axes among them."""
    corners = corners.reshape(-1, 3)
    some = np.linspace(0, len(corners) - 1, min(len(corners), SAMPLES)).astype(np.int64)
    return corners[np.unique([*corners.argmin(axis=0), *corners.argmax(axis=0), *some])]


def _is_inside(part: _Part, point: np.ndarray) -> bool | None:
    """True if a part encloses a point, by the triangles on a ray along z; None if it may be on the surface.

    If the ray hits an edge, up to rounding, all solid angles are added up instead.
    """
    x, y, z = point
    met = (part.low[0] <= x) & (part.high[0] >= x) & (part.low[1] <= y) & (part.high[1] >= y)
    a, b, c = np.moveaxis(part.corners[met & (part.high[2] >= z)] - point, 1, 0)
    sides = np.stack([_turn(a, b), _turn(b, c), _turn(c, a)])
    near = ON * np.stack([_size(a) * _size(b), _size(b) * _size(c), _size(c) * _size(a)])
    volume = (a * np.cross(b, c)).sum(axis=1)
    if (np.abs(sides) <= near).any() or (np.abs(volume) <= _size(a) * near[1]).any():
        return is_wound_round(part.corners - point)
    ways = np.sign(sides)
    hit = (ways[0] == ways[1]) & (ways[1] == ways[2]) & (np.sign(volume) == ways[0])
    return bool(ways[0][hit].sum() != 0)


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(m,) how corners a and b (m, 3) turn round the z axis."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _size(a: np.ndarray) -> np.ndarray:
    return np.linalg.norm(a, axis=1)


def is_wound_round(corners: np.ndarray) -> bool | None:
    """True if a closed surface (m, 3, 3) encloses the origin; None if the origin is on it.

    Source: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983, equation 8.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    la, lb, lc = _size(a), _size(b), _size(c)
    top = (a * np.cross(b, c)).sum(axis=1)
    bottom = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    least = ON * la * lb * lc
    if ((np.abs(top) <= least) & (bottom <= least)).any():
        return None
    return bool(abs(np.arctan2(top, bottom).sum()) > np.pi)  # half of 4 pi / 2


def _rounding_of_volume(corners: np.ndarray) -> float:
    """[m^3] the largest volume that rounding alone can give (m, 3, 3) triangles of a flat surface."""
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    return 1e-15 * len(corners) * size**3
