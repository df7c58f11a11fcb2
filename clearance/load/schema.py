"""The case file's schema: which keys there are, and what each may hold. Lengths in metres, angles
in radians.

Every model refuses keys it does not have and names the nearest valid one; numbers are numbers (no
text, no `true`, no NaN). Not for: reading files, or names that must exist in the robot
(`case_file`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from clearance.errors import BadDimension, BadInput, UnknownKey, nearest_name
from clearance.geometry import shapes
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.load.shape_schema import Triple, with_shapes
from clearance.world.names import checked_name
from clearance.world.notice import KINDS

Quadruple = Annotated[list[float], Field(min_length=4, max_length=4)]


Name = Annotated[str, Field(min_length=1), AfterValidator(checked_name)]


class StrictModel(BaseModel):
    """A mapping whose keys are all known."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            given = "nothing is given" if data is None else f"{data!r:.60} is given"
            raise BadInput(
                given, valid=f"a mapping is needed, with keys {', '.join(cls.model_fields)}"
            )
        for key in data:
            if key not in cls.model_fields:
                raise UnknownKey(
                    f"unknown key {key!r}", valid=nearest_name(str(key), cls.model_fields)
                )
        return data


class Pose(StrictModel):
    """Where something stands: a point and a rotation (quaternion xyzw, or roll, pitch, yaw about
    fixed axes).
    """

    xyz: Triple = [0.0, 0.0, 0.0]
    quat_xyzw: Quadruple | None = None
    rpy: Triple | None = None

    @model_validator(mode="after")
    def _is_rotation(self) -> Pose:
        if self.quat_xyzw is not None and self.rpy is not None:
            raise BadInput("both quat_xyzw and rpy are given", valid="give one of them")
        self.matrix()
        return self

    def matrix(self) -> np.ndarray:
        """The (4, 4) pose [m].

        Raises:
            BadPose: the quaternion is not of length one.
        """
        if self.quat_xyzw is not None:
            return pose_from_quaternion(self.xyz, self.quat_xyzw)
        return pose_from_rpy(self.xyz, self.rpy or [0.0, 0.0, 0.0])


def _is_double(number: int | float) -> bool:
    """True for a finite number that doubles can hold; whole numbers in a file may be longer."""
    try:
        return math.isfinite(number)
    except OverflowError:
        return False


class Mesh(StrictModel):
    """A mesh file; `scale` is a number or one for each axis, negative to mirror."""

    file: Name
    scale: Triple = [1.0, 1.0, 1.0]

    @field_validator("scale", mode="before")
    @classmethod
    def _number_or_three(cls, scale: Any) -> Any:
        factors = scale if isinstance(scale, list) else [scale]
        numbers = all(isinstance(f, int | float) and not isinstance(f, bool) for f in factors)
        if not numbers or len(factors) not in (1, 3) or not all(_is_double(f) for f in factors):
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


SHAPES = (*shapes.SHAPES, "mesh")


class NamedPose(StrictModel):
    """A name, and where what has it stands."""

    name: Name
    pose: Pose = Pose()


if TYPE_CHECKING:
    _Shaped = NamedPose
else:  # the keys come from a table, which a type checker cannot follow
    _Shaped = with_shapes(NamedPose, StrictModel)


class Obstacle(_Shaped):
    """A named solid that stands somewhere."""

    mesh: Mesh | None = None

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


class Scene(StrictModel):
    """What stands around the robot."""

    obstacles: list[Obstacle]


class Robot(StrictModel):
    """The robot, and what of it is measured."""

    urdf: Name
    package_dirs: list[Name] = []
    base: Pose = Pose()
    exclude_links: list[Name] = []
    joints: dict[str, float] = {}
    geometry: Literal["collision", "visual", "collision_or_visual"] = "collision"
    collada_up_axis: Literal["ros", "file"] = "ros"
    self_clearance: bool = False
    srdf: Name | None = None
    trust_never: bool = False


class TrajectoryFile(StrictModel):
    """Where the trajectory is: `{file: t.csv}`, or the path alone."""

    file: Name

    @model_validator(mode="before")
    @classmethod
    def _path_alone(cls, data: Any) -> Any:
        return {"file": data} if isinstance(data, str) else data


class Limits(StrictModel):
    """Least clearances [m]: below `fail` the case is violated, below `warn` it is a near miss; and what a
    joint beyond its limits is.
    """

    fail: Annotated[float, Field(ge=0)] = 0.0
    warn: Annotated[float, Field(ge=0)] | None = None
    joints: Literal["warn", "fail"] = "warn"

    @model_validator(mode="after")
    def _ordered(self) -> Limits:
        if self.warn is not None and self.warn < self.fail:
            raise BadInput(
                f"warn {self.warn:g} is below fail {self.fail:g}", valid="warn is at least fail"
            )
        return self


class Profile(StrictModel):
    """A sketched outline that what the robot sweeps in a plane must keep to; lengths in metres."""

    name: Name
    sketch: Name
    plane: Name = "xy"
    section: float | None = None
    mode: Literal["outside", "inside", "nearest"] = "outside"
    limit: Annotated[float, Field(ge=0)] = 0.0
    links: list[Name] = []


def _known_kind(kind: str) -> str:
    if kind not in KINDS:
        raise BadInput(
            f"{kind!r:.60} is given", valid=f"kinds of suspect input: {', '.join(KINDS)}"
        )
    return kind


Kind = Annotated[str, AfterValidator(_known_kind)]


class Report(StrictModel):
    """What the report is signed with."""

    author: Name | None = None
    revision: Name | None = None


class Case(StrictModel):
    """A whole case file; `scene` may be a path, which is followed before this is checked."""

    name: Name | None = None
    robot: Robot
    scene: Scene
    trajectory: TrajectoryFile
    limits: Limits = Limits()
    allow: list[Annotated[list[Name], Field(min_length=2, max_length=2)]] = []
    contact_response: bool = False
    profiles: list[Profile] = []
    accept: list[Kind] = []
    report: Report | None = None
