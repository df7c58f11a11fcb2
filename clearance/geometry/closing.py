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

RIM = 1.0 / 4.0
"""[-] Of a component's edges, those that may be open: beyond that it is a sheet or loose faces."""

LONG = 256
"""Corners of a loop beyond which its cap is a fan, which takes less time to find."""


class Closing(NamedTuple):
    """How components that are not closed would close.

    Attributes:
        turns: (f,) how often each face counts in a winding number, of the components that are taken; else 0.
        caps: (k, 3, 3) [m] the triangles between the corners of the loops, which count once.
        loops: (h + 1,) where those of each loop begin in `caps`.
    """

    turns: np.ndarray
    caps: np.ndarray
    loops: np.ndarray


class _OpenComponents(NamedTuple):
    """The components that are not closed.

    Attributes:
        ways: (f,) how each face counts; 0 where it is a copy, or its component is closed.
        component: (h,) of each loop. loops: (n, 3) corners [m] of each.
        share: (c,) of each component's area and its holes', what its holes have; infinite where it is not asked.
    """

    ways: np.ndarray
    component: np.ndarray
    loops: list[np.ndarray]
    share: np.ndarray


_found: weakref.WeakKeyDictionary[Polyhedron, _OpenComponents] = weakref.WeakKeyDictionary()


def closing_of(shape: Polyhedron, least: float = -1.0, most: float = FEW) -> Closing | None:
    """How the components close whose holes have a share above `least` and up to `most`; None if there are none."""
    if shape.component_closed.all():
        return None
    found = _open_of(shape)
    taken = (found.share > least) & (found.share <= most)
    if not taken.any():
        return None
    loops = [loop for loop, i in zip(found.loops, found.component, strict=True) if taken[i]]
    caps = [np.empty((0, 3, 3)), *map(_cap, loops)]
    return Closing(
        np.where(taken[shape.face_component], found.ways, 0),
        np.concatenate(caps),
        np.cumsum([len(cap) for cap in caps]),
    )


def loose_triangles(shape: Polyhedron) -> np.ndarray:
    """(k, 3, 3) [m] the components that hold nothing and do not close by `SOME`, each face once, turned alike.

    Together they may yet have an inside: patches that meet with a crack, or faces that are there for each side.
    """
    loose = ~shape.component_closed
    if loose.any():
        loose &= ~(_open_of(shape).share <= SOME)
    back_to_back = shape.component_closed & (np.bincount(shape.face_component) == 2)
    loose |= shape.component_two_sided | back_to_back
    if not loose.any():
        return np.empty((0, 3, 3))
    starts = shape.face_starts
    corners, ring = distinct_vertices(shape.vertices)[1][shape.face_vertices], rings_of(starts)
    ways = each_once(corners, starts, shape.face_component, loose, also_two_sided=True)
    used = np.flatnonzero((ways[ring.face] != 0) & (corners != corners[ring.ahead]))
    if len(used):
        ways = ways * _alike(
            corners[used], corners[ring.ahead][used], ring.face[used], shape.n_faces
        )
    way = ways[shape.triangle_faces]
    triangles = shape.triangles()
    triangles = np.where(way[:, None] < 0, triangles[:, ::-1], triangles)
    return np.ascontiguousarray(shape.vertices[triangles[way != 0]])


def _open_of(shape: Polyhedron) -> _OpenComponents:
    if shape not in _found:
        _found[shape] = _open_components(shape)
    return _found[shape]


def _open_components(shape: Polyhedron) -> _OpenComponents:
    starts, component = shape.face_starts, shape.face_component
    firsts, kinds = distinct_vertices(shape.vertices)
    corners, ring = kinds[shape.face_vertices], rings_of(starts)
    asked = ~shape.component_closed
    ways = each_once(corners, starts, component, asked)
    used = np.flatnonzero((ways[ring.face] != 0) & (corners != corners[ring.ahead]))
    share = np.full(len(asked), np.inf)
    if not len(used):
        return _OpenComponents(ways, np.empty(0, dtype=np.int64), [], share)
    tails, heads, face = corners[used], corners[ring.ahead][used], ring.face[used]
    ways = ways * _alike(tails, heads, face, shape.n_faces)
    tails, heads, of_edge, n_edges = _rim(tails, heads, ways[face], component[face], len(asked))
    n_open = np.bincount(of_edge, minlength=len(asked))
    points = shape.vertices[firsts]
    area = _areas(shape, ways, component, len(asked))
    of_loop, loops = [], []
    for i in np.flatnonzero((n_edges > 0) & (n_open <= RIM * n_edges)):
        mine = of_edge == i
        found = [points[loop] for loop in _loops(tails[mine].tolist(), heads[mine].tolist())]
        holes = sum(_area(loop) for loop in found)
        share[i] = holes / (holes + area[i]) if area[i] > 0.0 else np.inf
        loops += found
        of_loop += [i] * len(found)
    return _OpenComponents(ways, np.array(of_loop, dtype=np.int64), loops, share)


def _alike(tails: np.ndarray, heads: np.ndarray, face: np.ndarray, n_faces: int) -> np.ndarray:
    """(f,) 1 or -1: turned so, faces run along each edge that just two share in opposite directions.

    The half-edges run from `tails` to `heads` (n,) of `face` (n,). Of faces that hang together so, most stay as
    they are; where they cannot all agree (a Moebius strip), all do.
    """
    use = edge_use(tails, heads)
    first = use.starts[np.flatnonzero(use.n_uses == 2)]
    one, two = face[use.order[first]], face[use.order[first + 1]]
    apart = (use.forward[first] == use.forward[first + 1]) * n_faces
    other = (two + apart) % (2 * n_faces)
    opposite = (other + n_faces) % (2 * n_faces)
    labels = joined_labels(
        2 * n_faces, np.concatenate([one, one + n_faces]), np.concatenate([other, opposite])
    )
    kept, turned = labels[:n_faces], labels[n_faces:]
    ways = np.where(kept <= turned, 1, -1)
    piece = np.minimum(kept, turned)
    there = np.unique(face)
    most = np.bincount(piece[there], ways[there], minlength=2 * n_faces)
    return np.where(most[piece] < 0, -ways, ways)


def _rim(
    tails: np.ndarray, heads: np.ndarray, ways: np.ndarray, component: np.ndarray, n_components: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What closes: (tails, heads, component) of edges, as often as they lack; how many edges components have."""
    use = edge_use(tails, heads)
    lacking = np.add.reduceat(np.where(use.forward, 1, -1) * ways[use.order], use.starts[:-1])
    first = use.order[use.starts[:-1]]
    n_edges = np.bincount(component[first], minlength=n_components)
    low, high = np.minimum(tails, heads)[first], np.maximum(tails, heads)[first]
    open_edges = np.repeat(np.arange(len(first)), np.abs(lacking))
    back = lacking[open_edges] > 0
    low, high = low[open_edges], high[open_edges]
    return (
        np.where(back, high, low),
        np.where(back, low, high),
        component[first[open_edges]],
        n_edges,
    )


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
    """(n - 2, 3, 3) triangles that close a loop (n, 3): the least corner is cut off, again and again.

    So a crack is sewn up along itself, where a fan from one end would be as large as what the crack goes round.
    """
    if len(loop) > LONG:
        return _fan(loop)
    cut = []
    while len(loop) > 3:
        before, after = np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0)
        least = int(np.argmin((np.cross(loop - before, after - before) ** 2).sum(axis=1)))
        cut.append([before[least], loop[least], after[least]])
        loop = np.delete(loop, least, axis=0)
    return np.array([*cut, loop])


def _fan(loop: np.ndarray) -> np.ndarray:
    """(n - 2, 3, 3) the triangles from the first corner of a loop (n, 3)."""
    return np.stack([np.broadcast_to(loop[0], (len(loop) - 2, 3)), loop[1:-1], loop[2:]], axis=1)


def _area(loop: np.ndarray) -> float:
    """[m^2] the greatest area that a loop (n, 3) has in any projection: no surface that closes it has less."""
    fan = _fan(loop)
    return 0.5 * float(
        np.linalg.norm(np.cross(fan[:, 1] - fan[:, 0], fan[:, 2] - fan[:, 0]).sum(axis=0))
    )


def _areas(
    shape: Polyhedron, ways: np.ndarray, component: np.ndarray, n_components: int
) -> np.ndarray:
    """(c,) [m^2] of the faces that count, of each component."""
    counts = ways[shape.triangle_faces] != 0
    a, b, c = (shape.vertices[shape.triangles()[counts, k]] for k in range(3))
    doubled = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return 0.5 * np.bincount(
        component[shape.triangle_faces[counts]], doubled, minlength=n_components
    )
