"""Ready-made solids about the origin with the axis along z (as in URDF), and the table of them.

Round shapes are faceted from outside: the true solid lies within the faceted one, and `excess` bounds by how
much the faceted one is larger. A new shape is a file in this folder and a row here: case files, URDF files, the
schema and the checks of units follow the table. Not for: shapes from files (room `formats`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes.box import box
from clearance.geometry.shapes.pipe import pipe
from clearance.geometry.shapes.round import capsule, cylinder, ellipsoid, sphere


class Measure(Enum):
    """A dimension of a shape."""

    LENGTH = "a length above 0 [m]"
    LENGTH_OR_ZERO = "a length, 0 or more [m]"
    SIZES = "three lengths above 0, along x, y, z [m]"
    POINTS = "two points or more, each x, y, z [m]"
    SIDES = "a whole number of sides, 3 or more"


@dataclass(frozen=True)
class Shape:
    """A kind of solid that files can name.

    Attributes:
        maker: called with the dimensions by their names; it refuses those that make no solid.
        about: one sentence for the schema of case files.
        dimensions: what must be given.
        optional: what may be given.
        in_urdf: robots' files may have it, its dimensions as attributes of its element.
        radius: the dimension that a wrong unit shows in, if there is one.
    """

    maker: Callable[..., Polyhedron]
    about: str
    dimensions: Mapping[str, Measure]
    optional: Mapping[str, Measure] = field(default_factory=dict)
    in_urdf: bool = False
    radius: str | None = None


_LENGTH, _OR_ZERO = Measure.LENGTH, Measure.LENGTH_OR_ZERO
_BENT = {
    "length": _LENGTH,
    "sections": Measure.SIDES,
    "path": Measure.POINTS,
    "bend_radius": _LENGTH,
}

SHAPES = {
    "box": Shape(box, "A box about its centre.", {"size": Measure.SIZES}, in_urdf=True),
    "pipe": Shape(
        pipe,
        "A pipe: straight along z about its centre (`length`), or bent along a line of points\n(`path`).",
        {"outer_radius": _LENGTH, "inner_radius": _OR_ZERO},
        optional=_BENT,
        radius="outer_radius",
    ),
    "cylinder": Shape(
        cylinder,
        "A cylinder along z about its centre.",
        {"radius": _LENGTH, "length": _LENGTH},
        in_urdf=True,
        radius="radius",
    ),
    "capsule": Shape(
        capsule,
        "A cylinder of that length along z about its centre, with half a ball on either end.",
        {"radius": _LENGTH, "length": _OR_ZERO},
        in_urdf=True,
        radius="radius",
    ),
    "sphere": Shape(
        sphere, "A ball about its centre.", {"radius": _LENGTH}, in_urdf=True, radius="radius"
    ),
    "ellipsoid": Shape(
        ellipsoid,
        "An ellipsoid about its centre, by its three semi-axes.",
        {"radii": Measure.SIZES},
    ),
}
"""Every shape that files can name, by its name."""

__all__ = [
    "SHAPES",
    "Measure",
    "Shape",
    "box",
    "capsule",
    "cylinder",
    "ellipsoid",
    "pipe",
    "sphere",
]
