"""What all models of a case file's schema are: mappings whose keys are known, numbers that are numbers; what they
object to, as one line of ours: given, where, what is valid; and the table of shapes as models.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from types import UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    WithJsonSchema,
    create_model,
    model_validator,
)

from clearance.errors import (
    BadDimension,
    BadInput,
    BadShape,
    ClearanceError,
    MissingKey,
    NotFinite,
    UnknownKey,
    nearest_name,
)
from clearance.geometry.shapes import SHAPES, Measure, Shape
from clearance.world.names import checked_name

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Name = Annotated[str, Field(min_length=1), AfterValidator(checked_name)]

Level = Annotated[float, Field(ge=0)]
"""[m] A clearance or a padding."""


_DEGREES = r"^([+-]?[0-9]+(?:\.[0-9]*)?) ?deg$"


def _radians(given: Any) -> Any:
    """`-90deg` in radians; all else as it is.

    Raises:
        BadInput: another text.
    """
    if not isinstance(given, str):
        return given
    found = re.fullmatch(_DEGREES, given)
    if not found:
        raise BadInput(f"{given!r:.60} is given", valid="a number, or degrees as in -90deg")
    return math.radians(float(found[1]))


Angle = Annotated[
    float,
    BeforeValidator(_radians),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "pattern": _DEGREES}]}),
]
"""[rad] An angle, or degrees as text."""


class StrictModel(BaseModel):
    """A mapping whose keys are all known; one that may be left out is not there with nothing behind it."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def keys(cls) -> tuple[str, ...]:
        """The keys as they are written in a file."""
        return tuple(field.alias or name for name, field in cls.model_fields.items())

    @classmethod
    def refuse_nothing(cls, data: dict[str, Any]) -> None:
        """Refuses a key with nothing behind it, where that would be the same as no key.

        Raises:
            BadInput: with the key.
        """
        optional = {
            one.alias or name for name, one in cls.model_fields.items() if one.default is None
        }
        for key in data:
            if data[key] is None and key in optional:
                raise BadInput(
                    "nothing is given", where=key, valid="a value; else leave the key out"
                )

    @classmethod
    def _blocks(cls) -> Iterator[tuple[str, type[StrictModel]]]:
        """The keys that hold such a mapping themselves, and what it is."""
        for name, field in cls.model_fields.items():
            given = field.annotation
            for kind in get_args(given) if get_origin(given) in (Union, UnionType) else (given,):
                if isinstance(kind, type) and issubclass(kind, StrictModel):
                    yield field.alias or name, kind

    @classmethod
    def _meant(cls, key: str) -> str:
        """The remedy for an unknown key: a near name, or the key's place in a mapping of this one."""
        blocks = [f"`{one}: {{{key}: …}}`" for one, inner in cls._blocks() if key in inner.keys()]
        near = nearest_name(key, cls.keys())
        if not blocks or near.startswith("did you mean"):
            return near
        return f"did you mean {' or '.join(blocks)}?"

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        keys = cls.keys()
        if not isinstance(data, dict):
            given = "nothing is given" if data is None else f"{data!r:.60} is given"
            raise BadInput(given, valid=f"a mapping is needed, with keys {', '.join(keys)}")
        for key in data:
            if key not in keys:
                raise UnknownKey(f"unknown key {key!r}", valid=cls._meant(str(key)))
        cls.refuse_nothing(data)
        return data


Model = TypeVar("Model", bound=BaseModel)

_FAULT: dict[str, type[BadInput]] = {
    "finite_number": NotFinite,
    "greater_than": BadDimension,
    "too_short": BadShape,
    "too_long": BadShape,
}


def validated(model: type[Model], data: object, shown: str) -> Model:
    """The model made from plain data.

    Args:
        shown: the file's name in errors.

    Raises:
        BadInput: the first fault found, at `shown: path.to[2].field`.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _translated(error.errors()[0], shown) from None


def place(location: tuple[int | str, ...]) -> str:
    """`("scene", "obstacles", 2, "pose")` as `scene.obstacles[2].pose`."""
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".")


def _translated(detail: ErrorDetails, shown: str) -> ClearanceError:
    location = tuple(detail["loc"])
    own = detail.get("ctx", {}).get("error")
    if isinstance(own, ClearanceError):
        inner = ".".join(part for part in (place(location), own.where) if part)
        own.where = f"{shown}: {inner}" if inner else shown
        return own
    if detail["type"] == "missing":
        return MissingKey(f"{location[-1]!r} is missing", where=_joined(shown, location[:-1]))
    fault = _FAULT.get(detail["type"], BadInput)
    return fault(_given(detail["input"]), where=_joined(shown, location), valid=_remedy(detail))


def _joined(shown: str, location: tuple[int | str, ...]) -> str:
    return f"{shown}: {place(location)}" if location else shown


def _given(value: object) -> str:
    if value is None:
        return "nothing is given"
    text = repr(value)
    return f"{text if len(text) <= 60 else text[:57] + '...'} is given"


def _remedy(detail: ErrorDetails) -> str:
    context = detail.get("ctx", {})
    if detail["type"] in ("too_short", "too_long"):
        least, most = context.get("min_length"), context.get("max_length")
        return f"{least or most} values are needed"
    if detail["type"] == "string_too_short":
        return "a text that is not empty is needed"
    text = (
        detail["msg"]
        .replace("Input should be ", "")
        .replace("a valid i", "an i")
        .replace("a valid", "a")
    )
    return f"{text} is needed"


Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
_Length = Annotated[float, Field(gt=0)]

_TYPES: dict[Measure, Any] = {  # to a type checker, an annotated type is no type
    Measure.LENGTH: _Length,
    Measure.LENGTH_OR_ZERO: Annotated[float, Field(ge=0)],
    Measure.SIZES: Annotated[list[_Length], Field(min_length=3, max_length=3)],
    Measure.POINTS: Annotated[list[Triple], Field(min_length=2)],
    Measure.SIDES: Annotated[int, Field(ge=3)],
}

Fields = dict[str, Any]
"""Fields of a model by name, as `create_model` takes them: type and default."""

ShapedModel = TypeVar("ShapedModel", bound=BaseModel)


def with_shapes(base: type[ShapedModel]) -> type[ShapedModel]:
    """`base` with a key for each shape of the table; none of them must be given."""
    models = {name: _model(name, shape) for name, shape in SHAPES.items()}
    return create_model(f"{base.__name__}Shape", __base__=base, **_optional(models))


def _model(name: str, shape: Shape) -> type[StrictModel]:
    needed: Fields = {key: (_TYPES[measure], ...) for key, measure in shape.dimensions.items()}
    may_be = _optional({key: _TYPES[measure] for key, measure in shape.optional.items()})
    return create_model(
        name.capitalize(), __base__=StrictModel, __doc__=shape.about, **needed, **may_be
    )


def _optional(types: Mapping[str, Any]) -> Fields:
    return {key: (given | None, None) for key, given in types.items()}
