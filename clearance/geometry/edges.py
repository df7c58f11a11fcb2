"""Vertices matched bit for bit and edges matched by their ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Ring(NamedTuple):
    """The half-edges of flat faces, one for each entry of the flat list.

    Attributes:
        face: (n,) the face each belongs to.
        ahead, behind: (n,) the next and the previous half-edge of the same face.
    """

    face: np.ndarray
    ahead: np.ndarray
    behind: np.ndarray


def ahead_of(starts: np.ndarray) -> np.ndarray:
    """(n,) the next half-edge of the same face, of faces whose entries begin at `starts` (m + 1,)."""
    ahead = np.arange(1, int(starts[-1]) + 1)
    ahead[starts[1:] - 1] = starts[:-1]
    return ahead


def rings_of(starts: np.ndarray) -> Ring:
    """The links of the faces whose entries begin at `starts` (m + 1,)."""
    n = int(starts[-1])
    face = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    ahead = ahead_of(starts)
    behind = np.arange(-1, n - 1)
    behind[starts[:-1]] = starts[1:] - 1
    return Ring(face, ahead, behind)


def fans_of(starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(t, 3) the entries of the triangles that faces are cut into, from the first entry of each; (t,) their faces.

    Args:
        starts: (m + 1,) where the entries of each face begin.
    """
    ring = rings_of(starts)
    firsts, entries = starts[ring.face], np.arange(len(ring.face))
    middle = (entries > firsts) & (ring.ahead > entries)
    return np.stack([firsts, entries, ring.ahead], axis=1)[middle], ring.face[middle]


def distinct_vertices(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different rows of `vertices` and, for each row, which of them it is.

    Returns:
        (k,) indices of the first of each kind, in order; (n,) the kind of each row.

    Exactness: equal means equal coordinates, bit for bit except that -0.0 is 0.0.
    """
    if not len(vertices):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    order = np.lexsort((vertices[:, 2], vertices[:, 1], vertices[:, 0]))
    ordered = vertices[order]
    starts_new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    firsts = order[starts_new]  # lexsort is stable: the first of its kind comes first
    rank = np.empty(len(firsts), dtype=np.int64)
    rank[np.argsort(firsts)] = np.arange(len(firsts))
    kinds = np.empty(len(vertices), dtype=np.int64)
    kinds[order] = rank[np.cumsum(starts_new) - 1]
    return np.sort(firsts), kinds


class EdgeUse(NamedTuple):
    """Which half-edges run along the same edge.

    Attributes:
        order: (n,) half-edges so that those of one edge are neighbours.
        starts: (k + 1,) where each edge begins in `order`.
        forward: (n,) True, in `order`, where the half-edge runs from the lesser vertex to the greater.
    """

    order: np.ndarray
    starts: np.ndarray
    forward: np.ndarray

    @property
    def n_uses(self) -> np.ndarray:
        """(k,) how many half-edges run along each edge."""
        return np.diff(self.starts)

    @property
    def balance(self) -> np.ndarray:
        """(k,) forward uses less backward uses of each edge."""
        return np.add.reduceat(np.where(self.forward, 1, -1), self.starts[:-1])


def edge_keys(tails: np.ndarray, heads: np.ndarray, n_vertices: int) -> np.ndarray:
    """(n,) the number of the edge under each half-edge from `tails` to `heads` (n,)."""
    return np.minimum(tails, heads) * n_vertices + np.maximum(tails, heads)


def edge_use(tails: np.ndarray, heads: np.ndarray) -> EdgeUse:
    """Groups half-edges from `tails` to `heads` (n,) by the edge they run along."""
    keys = edge_keys(tails, heads, int(max(tails.max(), heads.max())) + 1)
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    new = np.flatnonzero(ordered[1:] != ordered[:-1]) + 1
    starts = np.concatenate([[0], new, [len(keys)]])
    return EdgeUse(order, starts, (tails < heads)[order])


def twins(tails: np.ndarray, heads: np.ndarray) -> np.ndarray:
    """(n,) the one half-edge that runs along the same edge in reverse; -1 where it is not just one."""
    use = edge_use(tails, heads)
    pairs = np.flatnonzero(use.n_uses == 2)
    first = use.starts[pairs]
    first = first[use.forward[first] != use.forward[first + 1]]
    twin = np.full(len(tails), -1)
    twin[use.order[first]] = use.order[first + 1]
    twin[use.order[first + 1]] = use.order[first]
    return twin
