"""The nodes of a COLLADA scene: which geometry stands where.

Not for: the geometry itself (`collada_geometry`). Source: Khronos, COLLADA 1.4.1, chapters 4 (transforms are
post-multiplied in their order) and 5 (`node`, `instance_node`, `instance_geometry`).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadDimension, BadSyntax, NotFinite, at
from clearance.formats.mesh.collada_geometry import (
    ElementsById,
    geometry_pieces,
    local_name,
    words_of,
)
from clearance.formats.mesh.placing import MOST_COPIED_NODES, CopyCount, placed
from clearance.formats.mesh.triangles import Triangles
from clearance.formats.text.numbers import floats

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_DEEPEST = 100
"""Nodes below nodes; scenes of real robots have at most a dozen levels."""


def placed_pieces(root: Element) -> Iterator[tuple[Hashable, Triangles]]:
    """Each piece that the document's scene places, in its order, with what it is a copy of.

    Raises:
        BadSyntax: an element that is not supported or not there, or nodes that place each other without end.
        BadDimension, NotFinite: a transform.
    """
    return _Scene(root).pieces()


class _Scene:
    """Walks the nodes of the document's scene; each geometry is made once."""

    def __init__(self, root: Element) -> None:
        self.root = root
        self.ids = ElementsById(root)
        self._made: dict[Element, list[Triangles]] = {}
        self._visits = CopyCount(MOST_COPIED_NODES, "nodes")

    def pieces(self) -> Iterator[tuple[Hashable, Triangles]]:
        for instance in self.root.iterfind("{*}scene/{*}instance_visual_scene"):
            scene = self.ids.one("visual_scene", instance.get("url"))
            for node in scene.iterfind("{*}node"):
                yield from self._below(node, np.eye(4), 0)

    def _below(
        self, node: Element, world_from_parent: np.ndarray, depth: int
    ) -> Iterator[tuple[Hashable, Triangles]]:
        self._visits.count(node)
        if depth > _DEEPEST:
            raise BadSyntax(f"nodes are nested more than {_DEEPEST} deep, or place themselves")
        world_from_node = world_from_parent
        for child in node.iterfind("{*}*"):
            if local_name(child) not in _CHILDREN:
                world_from_node = world_from_node @ _matrix(child)
        for child in node.iterfind("{*}*"):
            kind = local_name(child)
            if kind == "instance_geometry":
                yield from self._geometry(child, world_from_node)
            elif kind == "node":
                yield from self._below(child, world_from_node, depth + 1)
            elif kind == "instance_node":
                yield from self._below(
                    self.ids.one("node", child.get("url")), world_from_node, depth + 1
                )
            elif kind == "instance_controller":
                raise BadSyntax(
                    "skinned geometry is not supported",
                    valid="export the mesh without its armature",
                )

    def _geometry(
        self, instance: Element, world_from_node: np.ndarray
    ) -> Iterator[tuple[Hashable, Triangles]]:
        geometry = self.ids.one("geometry", instance.get("url"))
        if geometry not in self._made:
            self._made[geometry] = geometry_pieces(geometry, self.ids)
        for i, piece in enumerate(self._made[geometry]):
            yield (geometry, i), placed(piece, world_from_node)


_CHILDREN = ("asset", "node", "instance_geometry", "instance_node", "instance_controller")


def _matrix(transform: Element) -> np.ndarray:
    """(4, 4) one transform of a node."""
    kind = local_name(transform)
    if kind not in _TRANSFORMS:
        raise BadSyntax(f"<{kind}> in a <node> is not supported", valid=", ".join(_TRANSFORMS))
    n_numbers, make = _TRANSFORMS[kind]
    with at(f"<{kind}>"):
        values = floats(words_of(transform))
        if len(values) != n_numbers:
            raise BadSyntax(f"{len(values)} numbers", valid=f"{n_numbers}")
        if not np.isfinite(values).all():
            raise NotFinite("a number that is not finite")
        return make(values)


def _whole(values: np.ndarray) -> np.ndarray:
    matrix = values.reshape(4, 4)
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise BadSyntax(f"the last row is {matrix[3].tolist()}", valid="0 0 0 1")
    return matrix


def _translation(values: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = values
    return matrix


def _scaling(values: np.ndarray) -> np.ndarray:
    return np.diag([*values, 1.0])


def _rotation(values: np.ndarray) -> np.ndarray:
    """(4, 4) rotation; multiples of 90 degrees are exact. Source: Rodrigues' formula."""
    axis, degrees = values[:3], values[3]
    with np.errstate(over="ignore"):  # an infinite length is refused
        length = np.linalg.norm(axis)
    if not (length and np.isfinite(length)):
        raise BadDimension(f"the axis is {axis.tolist()}", valid="a direction")
    x, y, z = axis / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    quarters = degrees / 90.0
    if quarters == round(quarters):
        cosine, sine = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][round(quarters) % 4]
    else:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(4)
    matrix[:3, :3] += sine * cross + (1 - cosine) * (cross @ cross)
    return matrix


_TRANSFORMS = {
    "matrix": (16, _whole),
    "translate": (3, _translation),
    "scale": (3, _scaling),
    "rotate": (4, _rotation),
}
