"""Octomaps made cell by cell, after the format's description and by no reader of the package."""

from __future__ import annotations

import struct
from collections.abc import Mapping

Cell = tuple[int, int, int]
"""Place of a finest cell, from the middle of the tree."""

DEPTH = 16


def octree(
    cells: Mapping[Cell, bool], resolution: float = 0.1, *, full: bool = False, pruned: bool = False
) -> bytes:
    """A file of cells, True for those that are occupied; `pruned` where eight of one kind become one."""
    root = _node(
        {tuple(c + 2 ** (DEPTH - 1) for c in cell): told for cell, told in cells.items()},
        DEPTH,
        pruned,
    )
    kind = "file" if full else "binary file"
    body = b"" if root is None else (_full(root) if full else _binary(root))
    n = 0 if root is None else _count(root)
    header = f"# Octomap OcTree {kind}\n# (feel free to add / change comments)\n#\n"
    return f"{header}id OcTree\nsize {n}\nres {resolution!r}\ndata\n".encode() + body


def data_of(file: bytes) -> list[int]:
    """The body as the bytes of a message, which are signed."""
    body = file.partition(b"\ndata\n")[2]
    return [byte - 256 if byte > 127 else byte for byte in body]


def _node(cells: dict, level: int, pruned: bool):
    """True or False for a leaf, a list of eight for a node, None for what is unknown."""
    if not cells:
        return None
    if level == 0:
        (told,) = cells.values()
        return told
    parts: list[dict] = [{} for _ in range(8)]
    half = 2 ** (level - 1)
    for (x, y, z), told in cells.items():
        i = (x >= half) + 2 * (y >= half) + 4 * (z >= half)
        parts[i][x % half, y % half, z % half] = told
    children = [_node(part, level - 1, pruned) for part in parts]
    if pruned and level < DEPTH and (children == [True] * 8 or children == [False] * 8):
        return children[0]
    return children


def _count(node) -> int:
    return 0 if node is None else 1 + (sum(map(_count, node)) if isinstance(node, list) else 0)


def _binary(node: list) -> bytes:
    bits = 0
    for i, child in enumerate(node):
        told = 0 if child is None else 3 if isinstance(child, list) else 2 if child else 1
        bits |= told << 2 * i
    return struct.pack("<H", bits) + b"".join(
        _binary(child) for child in node if isinstance(child, list)
    )


def _full(node) -> bytes:
    if not isinstance(node, list):
        return struct.pack("<fB", 0.85 if node else -0.4, 0)
    children = sum(1 << i for i, child in enumerate(node) if child is not None)
    return struct.pack("<fB", 0.85, children) + b"".join(
        _full(child) for child in node if child is not None
    )
