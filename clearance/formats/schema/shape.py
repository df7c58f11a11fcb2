"""The table of shapes as models of a case file's schema. Not for: meshes, which are files (`case`)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, Field, create_model

from clearance.geometry.shapes import SHAPES, Measure, Shape

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

Model = TypeVar("Model", bound=BaseModel)


def with_shapes(base: type[Model], strict: type[BaseModel]) -> type[Model]:
    """`base` with a key for each shape of the table; none of them must be given.

    Args:
        strict: what the models of the shapes themselves are made from.
    """
    models = {name: _model(name, shape, strict) for name, shape in SHAPES.items()}
    return create_model(f"{base.__name__}Shape", __base__=base, **_optional(models))


def _model(name: str, shape: Shape, strict: type[BaseModel]) -> type[BaseModel]:
    needed: Fields = {key: (_TYPES[measure], ...) for key, measure in shape.dimensions.items()}
    may_be = _optional({key: _TYPES[measure] for key, measure in shape.optional.items()})
    return create_model(name.capitalize(), __base__=strict, __doc__=shape.about, **needed, **may_be)


def _optional(types: Mapping[str, Any]) -> Fields:
    return {key: (given | None, None) for key, given in types.items()}
