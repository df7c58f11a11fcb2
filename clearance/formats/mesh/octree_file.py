"""Octomaps (`.bt`, `.ot`, and the data of messages) to the outside of their occupied cells.

A cell is a cube, exactly; squares that two cells of one size share are left out, which leaves the surface closed.
Free and unknown cells are not there. Own decoder, bounded by the bytes that are there. Not for: other kinds of
tree, as those with colours. Source: OctoMap's file format, Hornung et al. 2013, and its OcTreeBaseImpl.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clearance.errors import BadDimension, BadShape, BadSyntax, EmptyMesh, MissingKey
from clearance.formats.mesh.triangles import MeshRequest, Triangles
from clearance.formats.text.numbers import floats, integers

DEPTH = 16
"""Levels of a tree; the whole has 2^16 cells along each axis."""

MOST_CELLS = 500_000
"""Occupied cells."""

_BINARY, _FULL = "# Octomap OcTree binary file", "# Octomap OcTree file"
_KIND = "OcTree"
LONGEST_HEADER = 1 << 12
"""Bytes in which a header ends."""

_FREE, _OCCUPIED, _INNER = 1, 2, 3
"""Two bits of a child, the first the lower one."""


class Octree(NamedTuple):
    """The occupied cells of an octomap.

    Attributes:
        corners: (n, 3) the least corner of each, in finest cells from the middle.
        sizes: (n,) edges in finest cells. resolution: [m] of the finest cells.
    """

    corners: np.ndarray
    sizes: np.ndarray
    resolution: float


def file_of_message(data: bytes, kind: str, resolution: float, *, is_binary: bool) -> bytes:
    """The file that holds what a message does.

    Raises:
        BadSyntax: another kind of tree. BadDimension: a resolution that is not above 0.
    """
    first = _BINARY if is_binary else _FULL
    _require_kind(kind)
    _require_resolution(resolution)
    return f"{first}\nid {kind}\nres {resolution!r}\ndata\n".encode() + data


def read_octree(asked: MeshRequest) -> Triangles:
    """The outside of the occupied cells.

    Raises:
        BadSyntax, MissingKey, BadShape: no octomap, another kind, cut off, or longer than its tree. EmptyMesh: no
        cell is occupied. BadDimension: a resolution that is not above 0.
    """
    tree = octree_of(asked.data)
    if not len(tree.sizes):
        raise EmptyMesh("no cell of the octomap is occupied", valid="at least one")
    note = (
        f"{len(tree.sizes):,} occupied cells, the finest of {1e3 * tree.resolution:.4g} mm; "
        "unknown space is taken for free"
    )
    return _outside(tree)._replace(notes=(note,))


def octree_of(data: bytes) -> Octree:
    """The occupied cells of a file; with logarithmic odds those of 0 and more.

    Raises:
        as `read_octree`, but for a map without occupied cells.
    """
    header, is_binary, body = _header(data)
    resolution = float(floats(header["res"])[0])
    _require_resolution(resolution)
    cells, n_nodes, used = _binary_cells(body) if is_binary else _full_cells(body)
    if body[used:].strip(b" \t\r\n\0"):
        raise BadSyntax(f"{len(body) - used} bytes follow the tree", valid="nothing after it")
    if "size" in header and n_nodes != int(integers(header["size"])[0]):
        raise BadShape(f"{n_nodes} nodes are there", valid=f"{header['size'][0]}, as its size says")
    table = np.array(cells, dtype=np.int64).reshape(-1, 4)
    return Octree(table[:, :3] - (1 << (DEPTH - 1)), table[:, 3], resolution)


def _header(data: bytes) -> tuple[dict[str, list[str]], bool, bytes]:
    head, end, body = data.partition(b"\ndata\n")
    lines = head[:LONGEST_HEADER].decode("utf-8", errors="replace").splitlines()
    if not end or len(head) > LONGEST_HEADER or not lines or lines[0] not in (_BINARY, _FULL):
        raise BadSyntax("not an octomap that can be read", valid=f"{_BINARY!r} or {_FULL!r}")
    words = [line.split() for line in lines[1:] if line.strip() and not line.startswith("#")]
    found = {row[0]: row[1:] for row in words}
    for key in ("id", "res"):
        if len(found.get(key, ())) != 1:
            raise MissingKey(f"the header has no one {key}", valid="lines id, size, res, data")
    if len(found.get("size", "1")) != 1 or len(found) < len(words):
        raise BadSyntax("a line of the header is not one word and one value")
    _require_kind(found["id"][0])
    return found, lines[0] == _BINARY, body


def _require_kind(kind: str) -> None:
    if kind != _KIND:
        raise BadSyntax(f"an octomap of kind {kind!r:.40} is not read", valid=_KIND)


def _require_resolution(resolution: float) -> None:
    if not 0.0 < resolution < math.inf:
        raise BadDimension(f"the resolution is {resolution}", valid="above 0 m")


Cell = tuple[int, int, int, int]
"""Least corner and edge in finest cells, from the tree's least corner."""


def _child(cell: Cell, i: int) -> Cell:
    """Child `i` of a cell: bit 0 of it is along x, 1 along y, 2 along z."""
    x, y, z, size = cell
    half = size // 2
    return x + half * (i & 1), y + half * (i >> 1 & 1), z + half * (i >> 2 & 1), half


def _binary_cells(body: bytes) -> tuple[list[Cell], int, int]:
    """The occupied cells, the number of nodes, and of bytes that they take: two for each that has children."""
    occupied: list[Cell] = []
    waiting: list[Cell] = [(0, 0, 0, 1 << DEPTH)] if body else []
    place, n_nodes = 0, len(waiting)
    while waiting:
        cell = waiting.pop()
        if place + 2 > len(body):
            raise BadSyntax("the tree of the octomap is cut off")
        bits = body[place] | body[place + 1] << 8
        place += 2
        inner = []
        for i in range(8):
            state = bits >> 2 * i & 3
            n_nodes += state > 0
            if state == _OCCUPIED:
                occupied.append(_child(cell, i))
            elif state == _INNER:
                inner.append(_child(cell, i))
        _require_bounded(occupied, inner)
        waiting += reversed(inner)
    return occupied, n_nodes, place


def _full_cells(body: bytes) -> tuple[list[Cell], int, int]:
    """The same where each node has its logarithmic odds and a bit for each child."""
    occupied: list[Cell] = []
    waiting: list[Cell] = [(0, 0, 0, 1 << DEPTH)] if body else []
    place = n_nodes = 0
    n_whole = len(body) // 5
    odds = np.frombuffer(body, np.dtype([("odds", "<f4"), ("children", "u1")]), n_whole)
    while waiting:
        cell = waiting.pop()
        if n_nodes >= n_whole:
            raise BadSyntax("the tree of the octomap is cut off")
        value, children = float(odds["odds"][n_nodes]), int(odds["children"][n_nodes])
        n_nodes += 1
        place += 5
        if not math.isfinite(value):
            raise BadSyntax(f"node {n_nodes - 1} of the octomap has the value {value}")
        inner = [_child(cell, i) for i in range(8) if children >> i & 1]
        if not inner and value >= 0.0:
            occupied.append(cell)
        _require_bounded(occupied, inner)
        waiting += reversed(inner)
    return occupied, n_nodes, place


def _require_bounded(occupied: list[Cell], inner: list[Cell]) -> None:
    if inner and inner[0][3] < 1:
        raise BadSyntax(f"the tree of the octomap is more than {DEPTH} levels deep")
    if len(occupied) > MOST_CELLS:
        raise BadShape(f"more than {MOST_CELLS:,} occupied cells", valid="a coarser or smaller map")


_FACES = np.array(
    [
        [[0, 0, 1], [0, 1, 1], [0, 1, 0], [0, 0, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
        [[1, 0, 0], [1, 0, 1], [0, 0, 1], [0, 0, 0]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ],
    dtype=np.int32,
)
"""(6, 4, 3) the corners of a cube's squares across x, y and z, outward."""


def _outside(tree: Octree) -> Triangles:
    """The squares of all cells but those that two cells of one size share, outward."""
    corners, sizes = tree.corners.astype(np.int32), tree.sizes.astype(np.int32)
    squares = corners[:, None] + sizes[:, None, None] * _FACES[:, None]  # (6, n, 4, 3)
    axes = np.repeat([0, 0, 1, 1, 2, 2], len(sizes))
    least = squares.min(axis=2).reshape(-1, 3)
    alike = np.column_stack([axes, least, np.tile(sizes, len(_FACES))])
    _, kind, count = np.unique(alike, axis=0, return_inverse=True, return_counts=True)
    outer = squares.reshape(-1, 4, 3)[count[kind.reshape(-1)] == 1]
    places, index = np.unique(outer.reshape(-1, 3), axis=0, return_inverse=True)
    quads = index.reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
    return Triangles(places * tree.resolution, triangles)
