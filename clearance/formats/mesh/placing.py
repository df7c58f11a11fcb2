"""Pieces of a scene joined into one surface, and the bound on how much a small file can ask for.

A scene may place one piece many times, and nodes that place each other make ten times more of it a
level: copies are counted. Not for: what a piece is (`collada_geometry`, `gltf_file`).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh
from clearance.formats.mesh.triangles import Triangles

Z_FROM_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""(3, 3) turns y up, z towards the viewer into z up, -y towards the viewer; x stays."""

MOST_COPIED_TRIANGLES = 1_000_000
"""Triangles that instances may add to those that the file holds: 0.2 GB, and about as many as a whole cell has."""

MOST_COPIED_NODES = 20_000
"""Nodes that instances may add to those that the file holds."""


class CopyCount:
    """Counts how often things come again, and refuses too many.

    Args:
        most: how many may come again, in all.
        what: what they are called in the message.
    """

    def __init__(self, most: int, what: str) -> None:
        self.most = most
        self.what = what
        self._seen: set[Hashable] = set()
        self._n_copied = 0

    def count(self, key: Hashable, n: int = 1) -> None:
        """Takes note of `n` things called `key`.

        Raises:
            BadSyntax: more than `most` came again.
        """
        if key not in self._seen:
            self._seen.add(key)
            return
        self._n_copied += n
        if self._n_copied > self.most:
            raise BadSyntax(
                f"its instances place more than {self.most:,} copies of {self.what}",
                valid="fewer instances, or a mesh with each part written once",
            )


def placed(piece: Triangles, world_from_piece: np.ndarray) -> Triangles:
    """The piece moved by a (4, 4) affine matrix; a mirrored one keeps its faces counter-clockwise from outside.

    Exactness: at most 4 u (|R||v| + |t|) a coordinate, u = 2^-53.
    """
    with np.errstate(all="ignore"):  # what overflows is refused when the whole is checked
        vertices = piece.vertices @ world_from_piece[:3, :3].T + world_from_piece[:3, 3]
        mirrored = np.linalg.det(world_from_piece[:3, :3]) < 0
        sums = np.abs(world_from_piece[:3, :3])
        # it makes no way longer than by the root of the greatest row sum times the greatest column sum
        rounded = piece.rounded * float(np.sqrt(sums.sum(axis=0).max() * sums.sum(axis=1).max()))
    corners = piece.corners[:, ::-1] if mirrored else piece.corners
    return Triangles(vertices, corners, rounded=rounded)


def joined(pieces: Iterable[tuple[Hashable, Triangles]]) -> Triangles:
    """All pieces as one surface, in their order.

    Args:
        pieces: each with what it is called; one that comes again is a copy.

    Raises:
        EmptyMesh: there is no triangle. BadSyntax: copies of too many triangles.
    """
    copies = CopyCount(MOST_COPIED_TRIANGLES, "triangles")
    of_triangles = []
    for key, piece in pieces:
        copies.count(key, len(piece.corners))
        if len(piece.corners):
            of_triangles.append(piece)
    if not of_triangles:
        raise EmptyMesh("the mesh has no faces", valid="a scene that places at least one polygon")
    starts = np.cumsum([0, *(len(piece.vertices) for piece in of_triangles)])
    return Triangles(
        np.concatenate([piece.vertices for piece in of_triangles]),
        np.concatenate([p.corners + start for p, start in zip(of_triangles, starts, strict=False)]),
        rounded=max(piece.rounded for piece in of_triangles),
    )
