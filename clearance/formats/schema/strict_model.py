"""What all models of a case file's schema are: mappings whose keys are known, numbers that are numbers."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from clearance.errors import BadInput, UnknownKey, nearest_name
from clearance.world.names import checked_name

Name = Annotated[str, Field(min_length=1), AfterValidator(checked_name)]

Level = Annotated[float, Field(ge=0)]
"""[m] A clearance or a padding."""


class StrictModel(BaseModel):
    """A mapping whose keys are all known."""

    FILLED: ClassVar[frozenset[str]] = frozenset()
    """Keys that may be left out, but not be there with nothing behind them."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def keys(cls) -> tuple[str, ...]:
        """The keys as they are written in a file."""
        return tuple(field.alias or name for name, field in cls.model_fields.items())

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        keys = cls.keys()
        if not isinstance(data, dict):
            given = "nothing is given" if data is None else f"{data!r:.60} is given"
            raise BadInput(given, valid=f"a mapping is needed, with keys {', '.join(keys)}")
        for key in data:
            if key not in keys:
                raise UnknownKey(f"unknown key {key!r}", valid=nearest_name(str(key), keys))
            if key in cls.FILLED and data[key] is None:
                raise BadInput("nothing is given", where=key, valid="a value, or no such key")
        return data
