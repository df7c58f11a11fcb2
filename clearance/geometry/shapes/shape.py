"""A row of the table of shapes: a maker, and the names and valid values of its dimensions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum

from clearance.geometry.polyhedron import Polyhedron


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
