"""What is asked of a reader of mesh files. Not for: reading them."""

from __future__ import annotations

from typing import Literal, NamedTuple

from clearance.tolerance import TESSELLATION

UpAxis = Literal["file", "ros"]
"""What becomes of COLLADA's `<up_axis>`: "file" turns as it says, "ros" ignores it as RViz and MoveIt do."""


class MeshRequest(NamedTuple):
    """The content of a file, and how it is to be read.

    Attributes:
        up_axis: of COLLADA. tolerance: [m] how far the facets of a CAD file may be off its surface.
    """

    data: bytes
    up_axis: UpAxis = "file"
    tolerance: float = TESSELLATION
