"""The schema of tolerances: what a real machine may differ from what a case says. Metres, radians, seconds.

Rows go by names or patterns of them. Not for: which names there are, and which number holds where several rows
are of one thing (`tolerance.block`).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    model_validator,
)
from pydantic.fields import FieldInfo

from clearance.errors import BadDimension, BadTolerance, nearest_name
from clearance.formats.schema.strict_model import Name, StrictModel
from clearance.world.budget import COVERAGE

MOST = {"m": 0.5, "rad": 0.2, "s": 60.0}
"""By unit the greatest error that is taken for one: more is in millimetres or degrees, or of clocks that are not
tied, which `clock` says."""

_REMEDIES = {"m": "in metres", "rad": "in radians", "s": "or clock: unsynchronised"}

CONTROLLERS = "controllers"
"""The word for the controllers that the case's robots name."""


def checked_error(given: float, unit: str) -> float:
    """An error [m, rad or s] of a believable size.

    Raises:
        BadDimension: it is greater than `MOST`.
    """
    most = f"{MOST[unit]:g} {unit}"
    if given > MOST[unit]:
        raise BadDimension(f"{given:g} {unit} is given", valid=f"at most {most}, {_REMEDIES[unit]}")
    return given


def _up_to(most: float) -> FieldInfo:
    """From 0 to a number, which is checked elsewhere and stands in the printed schema."""
    info = Field(ge=0, json_schema_extra={"maximum": most})
    assert isinstance(info, FieldInfo)
    return info


def _known_preset(name: str) -> str:
    if name not in preset_names():
        raise BadTolerance(f"unknown preset {name!r}", valid=nearest_name(name, preset_names()))
    return name


Magnitude = Annotated[float, Field(ge=0)]
Offset = Annotated[float, _up_to(MOST["m"]), AfterValidator(partial(checked_error, unit="m"))]
Angle = Annotated[float, _up_to(MOST["rad"]), AfterValidator(partial(checked_error, unit="rad"))]
Seconds = Annotated[float, _up_to(MOST["s"]), AfterValidator(partial(checked_error, unit="s"))]


class NumberRow(StrictModel):
    """Some numbers of one thing, one at least; those that are left out stay as they are."""

    @model_validator(mode="before")
    @classmethod
    def _says_something(cls, data: Any) -> Any:
        if data == {}:
            raise BadTolerance("nothing is given", valid=f"one of {', '.join(cls.keys())}")
        return data


class Placement(NumberRow):
    """How far a frame may be off: the length of its offset [m], and a turn about any axis [rad]."""

    xyz: Offset | None = None
    angle: Angle | None = None


class ObstacleRow(Placement):
    """Of an obstacle; and how far its surface may stand out [m]."""

    surface: Offset | None = None


class LinkRow(NumberRow):
    """How far the surface of a link may stand out [m]."""

    surface: Offset


class _NamedRows(StrictModel):
    """A mapping whose keys are its own, and beside them names."""

    model_config = ConfigDict(extra="allow")

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not data:
            given = f"{data!r:.60} is given" if data else "nothing is given"
            raise BadTolerance(given, valid="a mapping is needed")
        cls.refuse_nothing(data)
        return data


class BaseTolerance(_NamedRows, Placement):
    """How far bases may be off: of all robots, or of each by its name."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Placement] = Field(init=False)

    @property
    def rows(self) -> dict[str, Placement]:
        """By name or pattern."""
        own = self.model_dump(include={"xyz", "angle"}, exclude_none=True)
        return {**({"all": Placement(**own)} if own else {}), **(self.__pydantic_extra__ or {})}


class Tracking(_NamedRows):
    """What controllers leave of joints [rad] or [m]: numbers by joint, or those of a controllers file."""

    __pydantic_extra__: dict[str, Magnitude] = Field(init=False)

    file: Name | None = None
    _of_case: bool = PrivateAttr(default=False)

    @model_validator(mode="wrap")
    @classmethod
    def _word(cls, data: Any, handler: ModelWrapValidatorHandler[Tracking]) -> Tracking:
        if not isinstance(data, str):
            return handler(data)
        if data != CONTROLLERS:
            raise BadTolerance(f"{data!r:.60} is given", valid=nearest_name(data, [CONTROLLERS]))
        made = cls.model_construct()
        made._of_case = True
        return made

    @property
    def of_case(self) -> bool:
        """True if the controllers of the case's own robots are meant."""
        return self._of_case

    @property
    def rows(self) -> Mapping[str, float]:
        """Numbers by name or pattern."""
        return self.__pydantic_extra__ or {}


ERRORS = ("joints", "tracking", "kinematics", "base", "obstacles", "links", "timing", "presets")
"""Keys of a block of which it needs one."""


class Tolerance(StrictModel):
    """How far all that a case speaks of may be off."""

    joints: dict[Name, Magnitude] | None = None
    tracking: Tracking | None = None
    kinematics: dict[Name, Placement] | None = None
    base: BaseTolerance | None = None
    obstacles: dict[Name, ObstacleRow] | None = None
    links: dict[Name, LinkRow] | None = None
    timing: dict[Name, Seconds] | None = None
    presets: (
        Annotated[list[Annotated[Name, AfterValidator(_known_preset)]], Field(min_length=1)] | None
    ) = None
    coverage: Annotated[float, Field(gt=0, le=10)] = COVERAGE
    distributions: Literal["uniform", "normal"] = "uniform"
    unproven_ok: bool = False

    @model_validator(mode="after")
    def _says_something(self) -> Tolerance:
        if not any(getattr(self, key) for key in ERRORS):
            raise BadTolerance("no error is given", valid=f"one of {', '.join(ERRORS)}")
        return self


FOLDER = Path(__file__).parents[1] / "presets"


def preset_names() -> tuple[str, ...]:
    """The names of all presets."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))
