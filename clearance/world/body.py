"""Whatever can be near something: a rigid shape with a name. Links, obstacles and carried parts are bodies."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.errors import BadShape, at
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import validated_pose


@dataclass(frozen=True, eq=False)
class Body:
    """A named rigid shape.

    Attributes:
        name: unique among the bodies of its kind (links of one robot, obstacles of a scene).
        shape: in the body frame [m]; anything with `vertices` and `faces` (a `trimesh.Trimesh`) becomes one.
        origin: where the shape came from, for the report: file names or `box`, `pipe`, …
    """

    name: str
    shape: Polyhedron
    origin: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Polyhedron):
            with at(f"body {self.name!r}"):
                object.__setattr__(self, "shape", Polyhedron.from_trimesh(self.shape).outward())


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A body that stands in the scene.

    Attributes:
        world_from_body: (4, 4) pose [m].
    """

    body: Body
    world_from_body: np.ndarray = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        if not isinstance(self.body, Body):
            raise BadShape(
                f"an obstacle of a {type(self.body).__name__}",
                valid="Obstacle(Body(name, shape), pose)",
            )
        with at(f"obstacle {self.name!r}"):
            object.__setattr__(self, "world_from_body", validated_pose(self.world_from_body))

    @property
    def name(self) -> str:
        """The body's name."""
        return self.body.name
