"""A body as convex parts from both sides: `outer` parts whose union contains it, `inner` parts that it contains.

A translation that separates the outer parts separates the body; a depth in an inner part is a depth in the
into the body. A convex body is its own only part on both sides; then every depth is exact. Otherwise the two
bound it, and `note` says in one line what they are. Not for: measuring distance, which never uses parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from clearance.errors import BadPolygon, ClearanceError, Unavailable
from clearance.extras import install
from clearance.geometry import boolean, decompose
from clearance.geometry.envelope import envelope, is_clearly_concave
from clearance.geometry.nesting import is_wound_round
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.tolerance import TESSELLATION

FLAT = 1e-9
"""[-] Relative to the volume: as much may a body lack of its hull and count as convex (`Polytope`)."""

MUCH_MORE = 1.1
"""[-] A hull of more than this times the body's volume should have been cut."""

MISSED = 1e-12
"""[-] Relative to the volume: parts that miss no more of a body contain it."""

MOST_HULL = 20_000
"""Corners of which a hull is made: a second or two. With more, the envelope is taken, a hull of that reach."""

LITTLE_HULL = 500
"""Corners of which a hull needs 5 ms; with so few it is always made, since only it shows small dents."""

MOST_CUT = 30_000
"""Triangles that CoACD is given: with more it was never done within `decompose.MOST_WORK`."""

MOST_COMPARED = 200_000_000
"""Faces of a hull times triangles whose depth below it is measured: about 2 s."""

VOLUMES = "volumes shared with a closed body come from its own mesh"
"""The note on bodies that are solids for manifold3d: only their depth comes from a substitute."""

SAMPLED = 64
"""Triangles that are tested before all others."""


@dataclass(frozen=True, eq=False)
class ConvexParts:
    """A body between two sets of convex bodies.

    Attributes:
        outer: the body lies in their union. inner: each lies in the body; may be none.
        convex: the one outer part is the body itself; without facets it is the inner part as well.
        tight: the one outer part stands out of the body by no more than `tolerance.TESSELLATION`.
        solid: manifold3d's solid of the body; None where it has none or is not needed.
        closed: the body has an inside.
        rough: it was not cut: the region with another body bounds a depth better than the outer part.
        note: how the parts stand for the body; empty where it is convex and not faceted.
    """

    outer: tuple[Polytope, ...]
    inner: tuple[Polytope, ...]
    solid: Any
    closed: bool
    note: str
    convex: bool = False
    tight: bool = False
    rough: bool = False


_known: dict[bool, WeakKeyDictionary[Polyhedron, ConvexParts]] = {
    rough: WeakKeyDictionary() for rough in (False, True)
}


def convex_parts(body: Polyhedron, *, rough: bool = False) -> ConvexParts:
    """The convex parts of a body in its own frame, found at the first call.

    Closed concave bodies are cut by CoACD; surfaces that are not closed, or where a library is missing, are
    contained in their hull alone.

    Args:
        rough: concave bodies are not cut, and of those that are clearly concave no hull is made: milliseconds.

    Raises:
        NotSolid: the body is flat: it has no hull with a volume.

    Exactness: CoACD's parts are widened until they miss nothing of the body (1e-12 of its volume); how far a
        part stands out of the body is measured on the mesh of what stands out, and `inner` is the part drawn
        in by that much. Faceted bodies are drawn in by their `excess` as well.
    """
    known = _known[rough]
    if body not in known:
        known[body] = _found(body, rough)
    return known[body]


def _found(body: Polyhedron, rough: bool) -> ConvexParts:
    is_used = np.zeros(len(body.vertices), dtype=bool)
    is_used[body.face_vertices] = True
    points = body.vertices[is_used]
    volume, solids = body.volume, [] if body.volume is None else body.solids()
    solid, missing = _solid(body, solids) if len(solids) > 1 else (None, "")
    if solid is not None:
        volume = solid.volume()
    if volume is not None and len(points) > (LITTLE_HULL if rough else MOST_HULL):
        made = _clearly_concave(body, points, volume, solids)
        if made is not None:
            return made
    hull = Polytope(points) if len(points) <= MOST_HULL else envelope(points)
    if volume is None:
        return _by_hull(hull, None, False, "its surface is not closed")
    if not volume > FLAT * hull.volume:
        return _by_hull(hull, None, False, "its surface holds no volume")
    if hull.volume - volume <= FLAT * hull.volume and not missing:
        return _of_convex(hull, body.excess)
    if len(solids) == 1:
        solid, missing = _solid(body, solids)
    dented = _dented(body, hull, solid)
    if dented is not None:
        return dented
    if rough and solid is not None:
        return _uncut(hull, solid)
    if not missing:
        missing = _uncuttable(body)
    if missing:
        return _by_hull(hull, solid, True, f"concave, {missing}")
    return _of_concave(body, hull, solid)


def _clearly_concave(
    body: Polyhedron, points: np.ndarray, volume: float, solids: list[np.ndarray]
) -> ConvexParts | None:
    """A body that is concave at a glance, without its hull; None if it may be convex or has no solid."""
    if not is_clearly_concave(body, points):
        return None
    outer = envelope(points)
    solid = _solid(body, solids)[0] if volume > FLAT * outer.volume else None
    return None if solid is None else _uncut(outer, solid)


def _uncut(outer: Polytope, solid: Any) -> ConvexParts:
    """A closed concave body between its outer part and its own mesh."""
    note = f"concave: depth is bounded by the region shared and by the distance after a separation; {VOLUMES}"
    return ConvexParts((outer,), (), solid, True, note, rough=True)


def _dented(body: Polyhedron, hull: Polytope, solid: Any) -> ConvexParts | None:
    """A body that is its hull but for small dents; None if it is not."""
    corners = body.vertices[body.triangles()]
    dent = _dent(hull, corners)
    if not (dent <= TESSELLATION and _proves(hull, dent, corners)):
        return None
    note = f"its hull stands for it, its dents are at most {dent * 1e3:.2g} mm deep"
    return ConvexParts((hull,), _drawn_in(hull, dent + body.excess), solid, True, note, tight=True)


def _dent(hull: Polytope, triangles: np.ndarray) -> float:
    """[m] as `_depth_in`; infinite where a few are deeper than facets may be, or all would need too long."""
    few = triangles[:: max(1, len(triangles) // SAMPLED)]
    if _depth_in(hull, few) > TESSELLATION or hull.n_faces * len(triangles) > MOST_COMPARED:
        return np.inf
    return _depth_in(hull, triangles)


def hull_drawn_in(surface: np.ndarray, only_convex: bool) -> tuple[Polytope, ...]:
    """A convex part inside the closed surface (t, 3, 3) [m]: its hull less the depth of its dents, or none.

    Args:
        only_convex: none where there are dents; that is quick.

    Raises:
        NotSolid: the surface is flat.
    """
    hull = Polytope(surface.reshape(-1, 3))
    dent = _depth_in(hull, surface)
    if dent <= 1e-12 * hull.size:
        return (hull,) if _proves(hull, 0.0, surface) else ()
    if only_convex or not _proves(hull, dent, surface):
        return ()
    return _drawn_in(hull, dent)


def _by_hull(hull: Polytope, solid: Any, closed: bool, why: str) -> ConvexParts:
    if solid is None:
        note = f"{why}: its hull stands for it, from which depth and volume are upper bounds"
    else:
        note = f"{why}: its hull stands for it in the depth, an upper bound; {VOLUMES}"
    return ConvexParts((hull,), (), solid, closed, note)


def _of_convex(hull: Polytope, excess: float) -> ConvexParts:
    if excess == 0.0:
        return ConvexParts((hull,), (hull,), None, True, "", convex=True, tight=True)
    note = f"its facets stand out up to {excess * 1e3:.2g} mm"
    return ConvexParts((hull,), _drawn_in(hull, excess), None, True, note, convex=True, tight=True)


def _solid(body: Polyhedron, solids: list[np.ndarray]) -> tuple[Any, str]:
    """manifold3d's solid, the union of some; None where there is none, and in a few words why."""
    try:
        made = [boolean.solid(body.vertices, triangles) for triangles in solids]
        return made[0] if len(made) == 1 else boolean.evaluated(boolean.union(made)), ""
    except Unavailable as error:
        return None, f"{error.problem} ({error.valid})"
    except BadPolygon:
        return None, "not a manifold surface"


def _uncuttable(body: Polyhedron) -> str:
    """Why CoACD cannot cut a body, in a few words; nothing where it can."""
    if not decompose.available():
        return f"CoACD is not installed ({install('contact')})"
    return (
        ""
        if body.n_triangles <= MOST_CUT
        else f"of more than {MOST_CUT} triangles, which are not cut"
    )


def _of_concave(body: Polyhedron, hull: Polytope, solid: Any) -> ConvexParts:
    try:
        parts = _grown_to_contain(solid, _cut(body, hull, solid))
    except ClearanceError as error:
        return _by_hull(hull, solid, True, f"concave, not cut into convex parts ({error.problem})")
    surface = body.vertices[body.triangles()]
    inner: list[Polytope] = []
    greatest = 0.0
    for part in parts:
        out = boolean.mesh_of(solid_of(part) - solid)
        stands_out = 0.0 if out.is_empty else _depth_in(part, out.vertices[out.triangles])
        greatest = max(greatest, stands_out)
        if _proves(part, stands_out, surface):
            inner += _drawn_in(part, stands_out + body.excess)
    extra = max(0.0, _union(parts).volume() / solid.volume() - 1.0)
    who = "its hull holds it and stands"
    if len(parts) > 1:
        who = f"{len(parts)} convex parts by CoACD hold it and stand"
    note = f"{who} out by at most {greatest * 1e3:.2g} mm in the depth, with {100.0 * extra:.2g} % more volume; "
    note += VOLUMES
    return ConvexParts(tuple(parts), tuple(inner), solid, True, note)


def _cut(body: Polyhedron, hull: Polytope, solid: Any) -> list[Polytope]:
    """CoACD's parts; finer ones where it finds nothing to cut though the hull is much more than the body."""
    vertices, triangles = body.vertices, body.triangles()
    if len(body.solids()) > 1:  # CoACD takes no surfaces that go through each other
        union = boolean.mesh_of(solid)
        vertices, triangles = union.vertices, union.triangles
    for threshold in decompose.THRESHOLDS:
        corners = decompose.cut_into_hulls(vertices, triangles, threshold)
        if len(corners) > 1:
            return [Polytope(points) for points in corners]
        if hull.volume <= MUCH_MORE * solid.volume():
            break
    return [hull]


def _grown_to_contain(solid: Any, parts: list[Polytope]) -> list[Polytope]:
    """The parts made larger until the solid lies in their union: first by a film, then by the rest.

    Raises:
        BadPolygon: a few rounds are not enough.
    """
    for widen in (_by_a_film, _by_the_rest, _by_the_rest):
        missed = solid - _union(parts)
        if missed.volume() <= MISSED * solid.volume():
            return parts
        parts = widen(missed, parts)
    if (solid - _union(parts)).volume() > MISSED * solid.volume():
        raise BadPolygon("its parts do not hold it")
    return parts


def _by_a_film(missed: Any, parts: list[Polytope]) -> list[Polytope]:
    """All faces moved outwards, so that each corner of what is missed is in the part nearest to it."""
    corners = boolean.mesh_of(missed).vertices
    step = float(np.min([_above(part, corners) for part in parts], axis=0).max())
    shift = [0.0, 0.0, 0.0, 1.01 * step]
    return [Polytope.from_half_spaces(part.half_spaces - shift) for part in parts]


def _by_the_rest(missed: Any, parts: list[Polytope]) -> list[Polytope]:
    """Each part as the hull of itself and of the missed pieces that are nearest to it."""
    grown = [[part.vertices] for part in parts]
    for piece in missed.decompose():
        corners = boolean.mesh_of(piece).vertices
        grown[int(np.argmin([_above(part, corners).max() for part in parts]))].append(corners)
    return [Polytope(np.concatenate(points)) for points in grown]


def _above(part: Polytope, points: np.ndarray) -> np.ndarray:
    """(n,) [m] how far each point stands above the faces of the part, at most; below 0 inside."""
    return (points @ part.normals.T + part.half_spaces[:, 3]).max(axis=1)


def _union(parts: list[Polytope]) -> Any:
    return boolean.union([solid_of(part) for part in parts])


def solid_of(part: Polytope) -> Any:
    """manifold3d's solid of a convex part."""
    return boolean.solid(part.vertices, part.triangles())


def _depth_in(part: Polytope, triangles: np.ndarray) -> float:
    """[m] no point of the triangles (t, 3, 3) is deeper below all faces of the part than this.

    The depth below one face is linear, so over a triangle it is greatest at a corner; the depth below all
    faces is their least, so at most the least of those.
    """
    deepest = 0.0
    for rows in np.array_split(triangles, max(1, len(triangles) * part.n_faces // 2_000_000)):
        below = -(rows @ part.normals.T + part.half_spaces[:, 3])
        deepest = max(deepest, float(below.max(axis=1).min(axis=1).max(initial=0.0)))
    return deepest


def _drawn_in(part: Polytope, depth: float) -> tuple[Polytope, ...]:
    """The part with all faces moved inwards by `depth` [m]; none where nothing remains.

    For what that proves see `_proves`.
    """
    if depth == 0.0:
        return (part,)
    try:
        rows = part.half_spaces + [0.0, 0.0, 0.0, depth * (1.0 + 1e-9)]
        return (Polytope.from_half_spaces(rows),)
    except ClearanceError:
        return ()


def _proves(part: Polytope, stands_out: float, surface: np.ndarray) -> bool:
    """True if the part drawn in by `stands_out` lies in the body within the closed surface (t, 3, 3).

    The depth below all faces is concave. On the line from a point of the part outside the body to the
    centroid it is at least the less of the two ends; if the centroid is in the body, the line meets the
    body's surface, where the depth is at most `stands_out`; if the centroid is deeper than that, the point is
    not.
    """
    return bool(part.face_widths.min() > stands_out and is_wound_round(surface - part.centroid))
