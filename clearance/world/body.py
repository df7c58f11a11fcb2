"""Whatever can be near something: a rigid shape with a name. Links, obstacles and carried parts are bodies."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.geometry.polyhedron import Polyhedron


@dataclass(frozen=True, eq=False)
class Body:
    """A named rigid shape.

    Attributes:
        name: unique among the bodies of its kind (links of one robot, obstacles of a scene).
        shape: in the body frame [m].
        origin: where the shape came from, for the report: file names or `box`, `pipe`, …
    """

    name: str
    shape: Polyhedron
    origin: str = ""


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A body that stands in the scene.

    Attributes:
        world_from_body: (4, 4) pose [m].
    """

    body: Body
    world_from_body: np.ndarray = field(default_factory=lambda: np.eye(4))

    @property
    def name(self) -> str:
        """The body's name."""
        return self.body.name
