"""Pipes, straight or bent along a line of points, faceted so that no material is lost.

The outer surface is circumscribed and the bore inscribed. A bend is a run of mitred straight pieces that
touch the arc of the centre line. Not for: pipes that cross themselves (their surface then does too).
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes.centre_line import CentreLine, mitred
from clearance.geometry.shapes.dimension import at_least_zero, positive, sections_for
from clearance.geometry.shapes.rings import corner_factor, ring_around, ring_within, stacked
from clearance.tolerance import TESSELLATION, UNIT_ROUNDOFF


def pipe(
    *,
    inner_radius: float,
    outer_radius: float,
    length: float | None = None,
    path: np.ndarray | None = None,
    bend_radius: float | None = None,
    sections: int | None = None,
    tolerance: float = TESSELLATION,
) -> Polyhedron:
    """A pipe of `length` along z about the origin, or along `path`; with inner radius 0 a solid rod.

    Args:
        length: [m] of a straight pipe.
        path: (n, 3) [m] corners of the centre line, which runs round each on an arc of `bend_radius` [m].
        sections: number of sides; as many as the tolerance [m] needs if not given.

    Raises:
        BadDimension: a radius or length that is negative, not finite or 0 (but `inner_radius`), inner not
            below outer, both or neither of `length` and `path`, a bend radius without a path, equal neighbours
            in the path, a bend radius not above the outer radius, bends that do not fit between the corners.

    Exactness: the pipe lies inside the faceted one, and no facet of it, of the bore neither, is farther than
        `excess` from the true surface. Faces of straight pipes are flat to the last bit.
    """
    inner = at_least_zero(inner_radius, "inner_radius")
    outer = positive(outer_radius, "outer_radius")
    if inner >= outer:
        raise BadDimension(
            f"inner_radius {inner:.9g} is not below outer_radius {outer:.9g}",
            where="inner_radius",
            valid="less than outer_radius",
        )
    if path is None and length is not None:
        if bend_radius is not None:
            raise BadDimension(
                "bend_radius is given without path", valid="a straight pipe has no bends"
            )
        return _straight(
            inner, outer, positive(length, "length"), sections_for(outer, tolerance, sections)
        )
    if path is None or length is not None:
        given = "both" if path is not None else "neither"
        raise BadDimension(f"{given} of length and path given", valid="one of them is needed")
    return _bent(
        inner,
        outer,
        mitred(path, bend_radius, outer, positive(tolerance, "tolerance")),
        sections,
        tolerance,
    )


def _straight(inner: float, outer: float, length: float, n: int) -> Polyhedron:
    heights = np.array([-0.5, 0.5]) * length
    outside = ring_around(outer, n)
    excess = outer * (corner_factor(n) - 1.0) + 64.0 * UNIT_ROUNDOFF * outer
    if inner == 0.0:
        vertices, faces = stacked(np.stack([outside, outside]), heights)
        return Polyhedron(vertices, faces, excess)
    rings = [outside, ring_within(inner, n)]
    vertices = np.concatenate(
        [np.column_stack([ring, np.full(n, height)]) for ring in rings for height in heights]
    )
    return Polyhedron(vertices, np.concatenate(_tube_quads(n, 2)), excess)


def _tube_quads(n: int, n_rings: int) -> tuple[np.ndarray, ...]:
    """Quadrilaterals of a pipe whose vertices are n_rings outer rings of n corners, then as many inner ones."""
    here = np.arange(n)
    ahead = np.roll(here, -1)
    level = n * np.arange(n_rings - 1)[:, None]
    bore = n * n_rings
    sides = np.stack([level + here, level + ahead, level + n + ahead, level + n + here], axis=2)
    last = n * (n_rings - 1)
    first_end = np.stack([ahead, here, bore + here, bore + ahead], axis=1)
    last_end = last + np.stack([here, ahead, bore + ahead, bore + here], axis=1)
    return sides.reshape(-1, 4), (bore + sides[:, :, ::-1]).reshape(-1, 4), first_end, last_end


def _bent(
    inner: float, outer: float, line: CentreLine, sections: int | None, tolerance: float
) -> Polyhedron:
    """A section of constant shape swept along the mitred line; the bounds are derived in NOTES.md."""
    n = sections_for(outer, tolerance if line.step == 0.0 else 0.5 * tolerance, sections)
    reach = np.abs(line.points).max() + 2.0 * outer + line.bend_radius
    margin = 64.0 * UNIT_ROUNDOFF * (len(line.points) + 4) * reach
    stretch = 1.0 / np.cos(0.5 * line.step) - 1.0
    outside_radius = outer + (line.bend_radius + outer) * (1.0 - np.cos(0.5 * line.step)) + margin
    corner_radius = outside_radius * corner_factor(n)
    if line.step > 0.0 and corner_radius + margin >= line.bend_radius:
        raise BadDimension(
            f"bend_radius {line.bend_radius:.9g} is too near outer_radius {outer:.9g} for {n} sides",
            where="bend_radius",
            valid=f"more than {corner_radius:.9g}, or a finer tolerance",
        )
    excess = corner_radius - outer + (line.bend_radius + corner_radius) * stretch + 2.0 * margin
    ends = line.extended(margin)
    rings = [ends.swept(ring_around(outside_radius, n))]
    if inner > 0.0:
        shift = (line.bend_radius + inner) * stretch if line.step > 0.0 else 0.0
        bore_radius = inner - shift - margin
        if bore_radius <= 0.0:
            raise BadDimension(
                f"inner_radius {inner:.9g} is too small for the tolerance {tolerance:.9g}",
                where="inner_radius",
                valid=f"0, or more than {shift + margin:.9g}, or a finer tolerance",
            )
        rings.append(ends.swept(ring_within(bore_radius, n)))
        excess = max(excess, inner - bore_radius / corner_factor(n) + shift + 2.0 * margin)
    triangles = _tube_triangles(n, len(line.points), inner > 0.0)
    vertices = np.concatenate(rings).reshape(-1, 3)
    return Polyhedron.from_triangles(vertices, triangles, float(excess))


def _tube_triangles(n: int, n_rings: int, has_bore: bool) -> np.ndarray:
    sides, bore, first_end, last_end = _tube_quads(n, n_rings)
    if has_bore:
        quads = np.concatenate([sides, bore, first_end, last_end])
        return np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    middle = np.arange(1, n - 1)
    fan = np.stack([np.zeros(n - 2, dtype=np.int64), middle, middle + 1], axis=1)
    ends = [fan[:, ::-1], n * (n_rings - 1) + fan]
    return np.concatenate([sides[:, :3], sides[:, [0, 2, 3]], *ends])
