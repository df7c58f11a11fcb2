"""Faces that a mesh holds more than once, perhaps once for each side: a search needs to look at one of them.

Not for: faces that overlap without having the same corners.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.geometry.edges import Ring


class Copies(NamedTuple):
    """Which faces are the same.

    Attributes:
        first: (f,) the least face with the same corners in the same order, either way round.
        way: (f,) 1 if both run the same way round, else -1.
    """

    first: np.ndarray
    way: np.ndarray

    @property
    def kept(self) -> np.ndarray:
        """(k,) the faces that are no copies of a lesser one."""
        return np.flatnonzero(self.first == np.arange(len(self.first)))


def copies_of(
    corners: np.ndarray, starts: np.ndarray, ring: Ring, twin: np.ndarray, bent: np.ndarray
) -> Copies:
    """The copies among faces with vertices `corners` (c,) that begin at `starts` (f + 1,).

    Two faces that close on each other and share no edge with a third are not taken for copies.

    Args:
        twin: (c,) of `edges.twins`: copies have edges that not just two faces share.
        bent: (f,) faces that are not, since another first corner makes another fan of them.
    """
    n_faces = len(starts) - 1
    first, way = np.arange(n_faces), np.ones(n_faces, dtype=np.int64)
    asked = np.zeros(n_faces, dtype=bool)
    asked[ring.face[twin < 0]] = True
    asked &= ~bent
    for faces, least, same, turned in _same_corners(corners, starts, asked):
        first[faces] = faces[least[same]]
        way[faces] = np.where(turned == turned[least[same]], 1, -1)
    return Copies(first, way)


def two_sided(
    corners: np.ndarray, starts: np.ndarray, component: np.ndarray, asked: np.ndarray
) -> np.ndarray:
    """(k,) True for the components whose faces occur as often one way round as the other: they hold nothing.

    Args:
        corners: (c,) vertices of faces that begin at `starts` (f + 1,). component: (f,) of each face.
        asked: (k,) components for which this may be so.
    """
    asked = asked.copy()
    for faces, _, same, turned in _same_corners(corners, starts, asked[component]):
        unpaired = np.bincount(same, np.where(turned, -1, 1)) != 0
        asked[component[faces[unpaired[same]]]] = False
    return asked


def each_once(
    corners: np.ndarray, starts: np.ndarray, component: np.ndarray, asked: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(f,) 1 for the least of the faces with the same corners in components that are `asked` (k,) for, else 0.

    And (k,) True for the components that hold most faces as often one way round as the other: they have no inside.
    """
    ways = np.zeros(len(starts) - 1, dtype=np.int32)
    balance = np.zeros(len(asked), dtype=np.int64)
    for faces, least, same, turned in _same_corners(corners, starts, asked[component]):
        ways[faces[least]] = 1
        both_ways = np.bincount(same, np.where(turned, -1, 1)) == 0
        np.add.at(balance, component[faces[least]], np.where(both_ways, 1, -1))
    return ways, balance > 0


def _same_corners(
    corners: np.ndarray, starts: np.ndarray, asked: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """The faces that are `asked` (f,) for, those of one length at a time, distinguished by their corners.

    Yields: (the faces, the least of each kind among them, either way round, the kind of each, which are turned).
    """
    length = np.diff(starts)
    for n in np.unique(length[asked]):
        faces = np.flatnonzero(asked & (length == n))
        rows, turned = _from_the_least(corners[starts[faces, None] + np.arange(n)])
        _, least, same = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        yield faces, least, same.reshape(-1), turned


def _from_the_least(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The corners (m, n) of faces from the least on, towards the lesser of its neighbours; which were turned."""
    n = rows.shape[1]
    least = np.argmin(rows, axis=1)[:, None]
    onward = np.take_along_axis(rows, (least + np.arange(n)) % n, axis=1)
    backward = np.take_along_axis(rows, (least - np.arange(n)) % n, axis=1)
    turned = backward[:, 1] < onward[:, 1]
    return np.where(turned[:, None], backward, onward), turned
