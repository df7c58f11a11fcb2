"""The schema of a scene: obstacles, their shapes, and what moves them. Lengths in metres, angles in radians.

Not for: reading mesh files (`scene.obstacles`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from clearance.errors import BadDimension, BadInput, Contradiction, MissingKey
from clearance.formats.known_formats import CAD
from clearance.formats.schema.pose import Pose
from clearance.formats.schema.strict_model import Level, Name, StrictModel, Triple, with_shapes
from clearance.formats.schema.timed import PoseFile
from clearance.formats.text.numbers import is_double
from clearance.geometry import shapes
from clearance.tolerance import COARSEST_TESSELLATION, FINEST_TESSELLATION, TESSELLATION


class ScaledFile(StrictModel):
    """A file whose coordinates are times `scale`: a number or one for each axis, negative to mirror."""

    file: Name
    scale: Triple = [1.0, 1.0, 1.0]

    @field_validator("scale", mode="before")
    @classmethod
    def _number_or_three(cls, scale: Any) -> Any:
        factors = scale if isinstance(scale, list) else [scale]
        numbers = all(isinstance(f, int | float) and not isinstance(f, bool) for f in factors)
        if not numbers or len(factors) not in (1, 3) or not all(is_double(f) for f in factors):
            raise BadDimension(
                f"{scale!r:.60} is given", valid="a finite number, or three, is needed"
            )
        if 0 in factors:
            raise BadDimension(f"{scale!r:.60} is given", valid="a scale is not zero")
        return [float(f) for f in factors] * (3 if len(factors) == 1 else 1)

    @property
    def factors(self) -> tuple[float, float, float]:
        """The scale of each axis."""
        x, y, z = self.scale
        return x, y, z


class Mesh(ScaledFile):
    """A mesh file; `tolerance` [m] is how far the facets of a CAD file may be off its surface."""

    collada_up_axis: Literal["ros", "file"] = "file"
    tolerance: Annotated[float | None, Field(ge=FINEST_TESSELLATION, le=COARSEST_TESSELLATION)] = (
        None
    )

    @model_validator(mode="after")
    def _tolerance_of_cad(self) -> Mesh:
        if self.tolerance is not None and not self.file.lower().endswith(CAD):
            raise BadInput(
                f"a tolerance of {self.file!r:.60} is given, whose faces are flat",
                valid="of .step or .stp",
            )
        return self

    @property
    def tolerance_or_default(self) -> float:
        """[m]."""
        return TESSELLATION if self.tolerance is None else self.tolerance


class ScanUnit(StrictModel):
    """What the coordinates of a file are written in."""

    length: Literal["m", "mm"] = "m"


class ScannedPoints(ScaledFile):
    """A file of points of a scan, each a ball of `radius` [m]; its coordinates are in `units`, times `scale`."""

    radius: Annotated[float, Field(gt=0)]
    units: ScanUnit | None = None

    @property
    def in_millimetres(self) -> bool:
        """True if the coordinates are."""
        return self.units is not None and self.units.length == "mm"


SHAPES = (*shapes.SHAPES, "mesh", "points")


class NamedPose(StrictModel):
    """A name, and where what has it stands."""

    name: Name
    pose: Pose = Pose()


if TYPE_CHECKING:
    _Shaped = NamedPose
else:  # the keys come from a table, which a type checker cannot follow
    _Shaped = with_shapes(NamedPose)


class Obstacle(_Shaped):
    """A named solid: it stands at `pose`, rides `on` a link or an obstacle at `pose`, or goes where the table of
    `moves` says. Its clearance is lessened by `padding`.
    """

    mesh: Mesh | None = None
    points: ScannedPoints | None = None
    on: Name | None = None
    moves: PoseFile | None = None
    padding: Level = 0.0

    @property
    def kind(self) -> str:
        """Which of `SHAPES` it is."""
        return next(key for key in SHAPES if getattr(self, key) is not None)

    @property
    def dimensions(self) -> dict[str, Any]:
        """What is given of its shape, by name."""
        return getattr(self, self.kind).model_dump(exclude_none=True)

    @model_validator(mode="after")
    def _one_shape(self) -> Obstacle:
        given = [key for key in SHAPES if getattr(self, key) is not None]
        if len(given) != 1:
            what = f"{' and '.join(given)} are given" if given else "it has no shape"
            raise BadInput(what, valid=f"give exactly one of {', '.join(SHAPES)}")
        return self

    @model_validator(mode="after")
    def _one_place(self) -> Obstacle:
        if self.moves is not None and self.on is None and "pose" in self.model_fields_set:
            raise Contradiction(
                "both pose and moves are given",
                valid="the table of `moves` has its poses in the world; or `on: what it moves on`, at `pose`",
            )
        return self


class Scene(StrictModel):
    """What stands around the robots, or moves there. `frame` is what poses are given in: it is taken for the
    world, and suspect where it is a link that stands elsewhere. `warnings` are told by each check, a line each.
    """

    obstacles: list[Obstacle]
    frame: Name | None = None
    warnings: list[Name] = []

    @model_validator(mode="before")
    @classmethod
    def _has_obstacles(cls, data: Any) -> Any:
        if isinstance(data, dict) and "obstacles" not in data and set(data) <= set(cls.keys()):
            valid = "`obstacles: []` for an empty scene"
            raise MissingKey("'obstacles' is missing", valid=valid)
        return data
