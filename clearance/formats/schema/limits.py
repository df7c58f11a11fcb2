"""The schema of how close what may come to what, and when: limits, their rules, and pairs that may touch."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from clearance.errors import BadInput, BadShape
from clearance.formats.schema.pose import WindowedEntry
from clearance.formats.schema.strict_model import Level, Name, StrictModel

TwoPatterns = Annotated[list[Name], Field(min_length=2, max_length=2)]


class PairRow(WindowedEntry):
    """Pairs of bodies by two patterns, and when they are meant."""

    between: TwoPatterns
    while_carried: Name | None = None

    @property
    def patterns(self) -> tuple[str, str]:
        """The two patterns."""
        one, other = self.between
        return one, other


class AllowedPair(PairRow):
    """Pairs that are not measured: two patterns, or a mapping that says when as well."""

    @model_validator(mode="before")
    @classmethod
    def _patterns_alone(cls, data: Any) -> Any:
        if isinstance(data, str):
            raise BadShape(
                f"{data!r:.60} is given", valid="rows of two patterns: [[link, obstacle]]"
            )
        if not isinstance(data, list):
            return data
        if len(data) != 2:
            raise BadShape(f"{data!r:.60} is given", valid="2 values are needed")
        return {"between": data}


class Rule(PairRow):
    """Limits of some pairs [m]; of several rules for a pair the last counts."""

    name: Name | None = None
    fail: Level | None = None
    warn: Level | None = None

    @model_validator(mode="after")
    def _says_something(self) -> Rule:
        if self.fail is None and self.warn is None:
            raise BadInput("neither fail nor warn is given", valid="one of them, or both")
        return self


class Limits(StrictModel):
    """Least clearances [m]: below `fail` the case is violated, below `warn` it is a near miss; and what a
    joint beyond its limits is.
    """

    fail: Level = 0.0
    warn: Level | None = None
    joints: Literal["warn", "fail"] = "warn"
    rules: list[Rule] = []
