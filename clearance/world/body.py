"""Whatever can be near something: a rigid shape with a name. Links, obstacles and carried parts are bodies."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from clearance.errors import BadDimension, BadInput, BadShape, Contradiction, at
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import validated_pose
from clearance.world.carrier_error import CarrierError
from clearance.world.field_types import owned, require_types
from clearance.world.pose_table import PoseTable


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
        require_types(self, name=str)
        if not isinstance(self.shape, Polyhedron):
            with at(f"body {self.name!r}"):
                object.__setattr__(self, "shape", Polyhedron.from_trimesh(self.shape).outward())

    @property
    def is_cloud(self) -> bool:
        """True if it is points of a scan and has no surface."""
        return isinstance(self.shape, PointCloud)


def require_no_shortfall(bodies: Iterable[Body], purpose: str) -> None:
    """Refuses bodies whose surfaces may not contain the true shape: their clearance would be overstated.

    Raises:
        BadInput: with the first body that may stand outside its surface, as one from a CAD file may.
    """
    for body in bodies:
        if body.shape.shortfall:
            raise BadInput(
                f"{body.name!r} may stand {body.shape.shortfall * 1e3:.3g} mm outside its facets, which "
                f"{purpose} does not count",
                valid="a mesh file in place of a CAD file, double precision in place of single, or a check of "
                "the case, which counts it",
            )


@dataclass(frozen=True, eq=False)
class Mount:
    """A place on a body.

    Attributes:
        on: its name as in tables: an obstacle, `robot/link`, or the link alone where there is one robot.
        pose: (4, 4) `on_from_base` [m] of what stands there.
    """

    on: str
    pose: np.ndarray = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        require_types(self, on=str)
        with at("pose"):
            object.__setattr__(self, "pose", owned(validated_pose(self.pose)))


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A body of the scene: it stands in the world, rides on another body, or moves by itself.

    Attributes:
        world_from_body: (4, 4) pose [m] where it stands in the world; else the identity.
        mount: what it rides on, and where.
        moves: how it moves: in the world, or as seen from the pose of its mount.
        padding: [m] by how much its clearance is lessened.
        past: of a part that has changed hands in a case with tolerances, the errors of what gripped it, and let it
            go, at those moments, the first first.

    Raises:
        BadInput: a pose in the world of what has none. BadDimension: a padding that is not 0 or more.
    """

    body: Body
    world_from_body: np.ndarray = field(default_factory=lambda: np.eye(4))
    mount: Mount | None = None
    moves: PoseTable | None = None
    padding: float = 0.0
    past: tuple[CarrierError, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.body, Body):
            raise BadShape(
                f"an obstacle of a {type(self.body).__name__}",
                valid="Obstacle(Body(name, shape), pose)",
            )
        require_types(self, mount=(Mount, None), moves=(PoseTable, None))
        with at(f"obstacle {self.name!r}"):
            object.__setattr__(self, "world_from_body", owned(validated_pose(self.world_from_body)))
            checked_padding(self.padding)
            if not self.stands and not np.array_equal(self.world_from_body, np.eye(4)):
                raise Contradiction(
                    "both a pose in the world and what moves it are given",
                    valid="the pose in Mount(on, pose), or the poses in `moves`",
                )

    @property
    def stands(self) -> bool:
        """True if nothing moves it."""
        return self.mount is None and self.moves is None

    @property
    def name(self) -> str:
        """The body's name."""
        return self.body.name


def checked_padding(padding: float) -> float:
    """The padding [m]: by how much a clearance is lessened, as a distance, not by moving a surface.

    Raises:
        BadDimension: it is not a number, or below 0.
    """
    if not (isinstance(padding, int | float) and 0.0 <= padding < math.inf):
        raise BadDimension(f"padding is {padding!r:.60}", valid="0 m or more")
    return float(padding)
