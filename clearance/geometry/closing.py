"""Surfaces that are closed but for a few faults: how each face counts, and the caps that would close them.

Faces that are there twice count once, faces that run the other way round than their neighbours are turned in
thought; what is then left open are loops of edges, each closed by triangles between its corners. Faces and caps
together are closed, so that their winding numbers are whole; how little the caps matter is for the asker to prove
(`kernels.search.containment`). Not for: mending what is measured; distances never see any of this.
"""

from __future__ import annotations

import weakref
from typing import NamedTuple

import numpy as np

from clearance.geometry.copies import each_once
from clearance.geometry.edges import distinct_vertices, edge_use, rings_of
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.arithmetic.union_find import joined_labels

FEW = 1.0 / 100.0
"""[-] Of a component's area, what its holes may have for it to have an inside: a hundredth. Of 1 - cos(t) / 2 of
all directions, a hole that is seen under the half angle t; from the middle of a ball one of that size is 4 %."""

SOME = 1.0 / 10.0
"""[-] The same for a component of which it is asked whether something may be inside it: less than a box without a
lid has (a sixth), or a tube 4.5 times as long as it is wide without its ends (a tenth)."""

RIM = 3.0 / 4.0
"""[-] Of a component's edges, those that may be open: beyond that it is loose faces. A tube of four faces without
its ends has two thirds, and sheets have holes as large as they are."""


class Closing(NamedTuple):
    """How components that are not closed would close.

    Attributes:
        turns: (f,) how often each face counts in a winding number, of the components that are taken; else 0.
        caps: (k, 3, 3) [m] triangles that close these, which count once.
    """

    turns: np.ndarray
    caps: np.ndarray


class _OpenComponents(NamedTuple):
    """The components that are not closed, or hold nothing because they have two sides.

    Attributes:
        ways: (f,) how each face counts; 0 where it is a copy, or its component holds something.
        caps: (k, 3, 3) [m] triangles that close them. component: (k,) of each cap.
        share: (c,) of each component's area and its holes', what its holes have; infinite for those that would not
            close, -1 for those that hold something.
    """

    ways: np.ndarray
    caps: np.ndarray
    component: np.ndarray
    share: np.ndarray


_found: weakref.WeakKeyDictionary[Polyhedron, _OpenComponents] = weakref.WeakKeyDictionary()


def closing_of(shape: Polyhedron, least: float = -1.0, most: float = FEW) -> Closing | None:
    """How the components close whose holes have a share above `least` and up to `most`; None if there are none."""
    if shape.component_closed.all():
        return None
    found = _open_of(shape)
    closed = (found.share > least) & (found.share <= most)
    if not closed.any():
        return None
    turns = np.where(closed[shape.face_component], found.ways, 0)
    return Closing(turns, found.caps[closed[found.component]])


def loose_triangles(shape: Polyhedron) -> np.ndarray:
    """(k, 3, 3) [m] the components that hold nothing and do not close by `SOME`, each face once, turned alike.

    Together they may yet have an inside: patches that meet with a crack, or faces that are there for each side.
    """
    if not _hold_nothing(shape).any():
        return np.empty((0, 3, 3))
    found = _open_of(shape)
    way = np.where(found.share[shape.face_component] > SOME, found.ways, 0)[shape.triangle_faces]
    triangles = shape.triangles()
    triangles = np.where(way[:, None] < 0, triangles[:, ::-1], triangles)
    return np.ascontiguousarray(shape.vertices[triangles[way != 0]])


def _hold_nothing(shape: Polyhedron) -> np.ndarray:
    """(c,) True for the components that are not closed, or have two sides."""
    back_to_back = np.bincount(shape.face_component) == 2
    return ~shape.component_closed | shape.component_two_sided | back_to_back


def _open_of(shape: Polyhedron) -> _OpenComponents:
    if shape not in _found:
        _found[shape] = _open_components(shape)
    return _found[shape]


def _open_components(shape: Polyhedron) -> _OpenComponents:
    starts, component = shape.face_starts, shape.face_component
    firsts, kinds = distinct_vertices(shape.vertices)
    corners, ring = kinds[shape.face_vertices], rings_of(starts)
    asked = _hold_nothing(shape)
    ways, two_sided = each_once(corners, starts, component, asked)
    share = np.where(asked, np.inf, -1.0)
    used = np.flatnonzero((ways[ring.face] != 0) & (corners != corners[ring.ahead]))
    caps, n_caps = [np.empty((0, 3, 3))], np.zeros(len(asked), dtype=np.int64)
    if len(used):
        tails, heads, face = corners[used], corners[ring.ahead][used], ring.face[used]
        ways = ways * _alike(tails, heads, face, shape.n_faces)
        rim = _rim(tails, heads, ways[face], component[face], len(asked))
        area, points = _areas(shape, ways, component, len(asked)), shape.vertices[firsts]
        holds = two_sided | shape.component_closed
        closes = (rim.n_open <= RIM * rim.n_edges) & ~holds & (area > 0.0)
        for i in np.flatnonzero(closes):
            mine = rim.component == i
            loops = _loops(rim.tails[mine].tolist(), rim.heads[mine].tolist())
            found = [_cap(points[loop]) for loop in loops]
            holes = sum(float(np.linalg.norm(_normals(cap).sum(axis=0))) for cap in found)
            share[i], n_caps[i] = holes / (holes + area[i]), sum(map(len, found))
            caps += found
    return _OpenComponents(
        ways, np.concatenate(caps), np.repeat(np.arange(len(asked)), n_caps), share
    )


def _alike(tails: np.ndarray, heads: np.ndarray, face: np.ndarray, n_faces: int) -> np.ndarray:
    """(f,) 1 or -1: turned so, faces run along each edge that just two share in opposite directions.

    The half-edges run from `tails` to `heads` (n,) of `face` (n,). Of faces that hang together so, most stay as
    they are; where they cannot all agree (a Moebius strip), all do.
    """
    use = edge_use(tails, heads)
    first = use.starts[np.flatnonzero(use.n_uses == 2)]
    one, two = face[use.order[first]], face[use.order[first + 1]]
    crossing = (use.forward[first] == use.forward[first + 1]) * n_faces
    other = (two + crossing) % (2 * n_faces)
    opposite = (other + n_faces) % (2 * n_faces)
    labels = joined_labels(
        2 * n_faces, np.concatenate([one, one + n_faces]), np.concatenate([other, opposite])
    )
    as_given, turned = labels[:n_faces], labels[n_faces:]
    ways = np.where(as_given <= turned, 1, -1)
    piece = np.minimum(as_given, turned)
    there = np.unique(face)
    most = np.bincount(piece[there], ways[there], minlength=2 * n_faces)
    return np.where(most[piece] < 0, -ways, ways)


class _Rim(NamedTuple):
    """What components lack to be closed.

    Attributes:
        tails, heads, component: (k,) of edges, as often as they lack.
        n_open, n_edges: (c,) how many of these, and edges, each component has.
    """

    tails: np.ndarray
    heads: np.ndarray
    component: np.ndarray
    n_open: np.ndarray
    n_edges: np.ndarray


def _rim(
    tails: np.ndarray, heads: np.ndarray, ways: np.ndarray, component: np.ndarray, n_components: int
) -> _Rim:
    use = edge_use(tails, heads)
    lacking = np.add.reduceat(np.where(use.forward, 1, -1) * ways[use.order], use.starts[:-1])
    first = use.order[use.starts[:-1]]
    n_edges = np.bincount(component[first], minlength=n_components)
    open_edges = first[np.repeat(np.arange(len(first)), np.abs(lacking))]
    back = np.repeat(lacking > 0, np.abs(lacking))
    low, high = np.minimum(tails, heads)[open_edges], np.maximum(tails, heads)[open_edges]
    component = component[open_edges]
    n_open = np.bincount(component, minlength=n_components)
    return _Rim(np.where(back, high, low), np.where(back, low, high), component, n_open, n_edges)


def _loops(tails: list[int], heads: list[int]) -> list[list[int]]:
    """The simple loops that edges from `tails` to `heads` make up, each of which goes on at its end."""
    ahead: dict[int, list[int]] = {}
    for tail, head in zip(reversed(tails), reversed(heads), strict=True):
        ahead.setdefault(tail, []).append(head)
    loops = []
    for start in tails:
        path, place = [start], {start: 0}
        while ahead[path[-1]]:
            head = ahead[path[-1]].pop()
            if head in place:
                first = place[head]
                loops.append(path[first:])
                for corner in path[first + 1 :]:
                    del place[corner]
                del path[first + 1 :]
            else:
                place[head] = len(path)
                path.append(head)
    return loops


def _cap(loop: np.ndarray) -> np.ndarray:
    """(n - 2, 3, 3) triangles that close a loop (n, 3): a strip between its sides, from the farthest corner on.

    So a crack is sewn up along itself, where a fan would be as large as what the crack goes round.
    """
    n = len(loop)
    loop = np.roll(loop, -int(((loop - loop.mean(axis=0)) ** 2).sum(axis=1).argmax()), axis=0)
    k = np.arange(n)
    strip = np.where(k % 2, (k + 1) // 2, (n - k // 2) % n)
    triangles = strip[np.arange(n - 2)[:, None] + [0, 1, 2]]
    triangles[1::2] = triangles[1::2, ::-1]
    return loop[triangles]


def _normals(triangles: np.ndarray) -> np.ndarray:
    """(n, 3) [m^2] as long as the areas of triangles (n, 3, 3): their sum is the least that has their rim."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return 0.5 * np.cross(b - a, c - a)


def _areas(
    shape: Polyhedron, ways: np.ndarray, component: np.ndarray, n_components: int
) -> np.ndarray:
    """(c,) [m^2] of the faces that count, of each component."""
    counts = ways[shape.triangle_faces] != 0
    area = np.linalg.norm(_normals(shape.vertices[shape.triangles()[counts]]), axis=1)
    return np.bincount(component[shape.triangle_faces[counts]], area, minlength=n_components)
