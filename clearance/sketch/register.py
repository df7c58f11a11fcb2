"""The contents of a sketch by name: entities, constraints, parameters; names and numbers are checked here."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

from clearance.errors import BadShape, DuplicateName, NotFinite, nearest_name
from clearance.sketch.constraints import Constraint
from clearance.sketch.entities import Entity
from clearance.sketch.faults import UnknownEntity

E = TypeVar("E", bound=Entity)


class Register:
    """Entities, constraints and parameters by name, each name used once."""

    def __init__(self) -> None:
        self.entities: dict[str, Entity] = {}
        self.constraints: dict[str, Constraint] = {}
        self.parameters: dict[str, float] = {}
        self._counts: dict[str, int] = {}

    def constraint(self, name: str) -> Constraint:
        """The constraint of that name."""
        if name not in self.constraints:
            raise UnknownEntity(
                f"no constraint named {name!r}", valid=nearest_name(name, self.constraints)
            )
        return self.constraints[name]

    def entity(self, name: str) -> Entity:
        """The entity of that name."""
        if name not in self.entities:
            raise UnknownEntity(
                f"no entity named {name!r}", valid=nearest_name(name, self.entities)
            )
        return self.entities[name]

    def _own(self, entity: Entity | str) -> Entity:
        """An entity of this sketch, given as itself or by its name."""
        if isinstance(entity, str):
            return self.entity(entity)
        return self._of_kind(entity, Entity)

    def _new_name(self, given: str | None, what: str) -> str:
        """The name that is given, or the next one that is free for `what`."""
        if given is None:
            while True:
                self._counts[what] = self._counts.get(what, 0) + 1
                name = f"{what}{self._counts[what]}"
                if name not in self.entities and name not in self.constraints:
                    return name
        if not isinstance(given, str) or not given:
            raise UnknownEntity(f"a name {given!r}", valid="a text")
        self._check_free(given)
        return given

    def _check_free(self, name: str) -> None:
        """Refuses a name that is in use."""
        if name in self.entities or name in self.constraints or name in self.parameters:
            raise DuplicateName(f"the name {name!r} is taken", valid="a name used once")

    def _of_kind(self, entity: object, kind: type[E]) -> E:
        """The entity itself, if it is of this kind and of this sketch."""
        if not isinstance(entity, kind):
            what = entity.what if isinstance(entity, Entity) else repr(entity)
            raise UnknownEntity(
                f"{what} where a {kind.what} is needed", valid=f"a {kind.what} of this sketch"
            )
        if entity.sketch is not self or self.entities.get(entity.name) is not entity:
            raise UnknownEntity(
                f"{entity.name!r} belongs to another sketch", valid="an entity of this one"
            )
        return entity

    def _enter(self, entity: E) -> E:
        """Enters an entity under its name."""
        self.entities[entity.name] = entity
        return entity


def number(value: object, where: str) -> float:
    """The value as a finite float.

    Raises:
        NotFinite: it is not a number, or not finite.
    """
    try:
        out = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise NotFinite(
            f"{value!r:.60} is not a number", where=where, valid="a finite number"
        ) from None
    if not math.isfinite(out):
        raise NotFinite(f"the value is {out}", where=where, valid="a finite number")
    return out


def two(position: Sequence[float], where: str) -> tuple[float, float]:
    """A position as two finite floats.

    Raises:
        BadShape: it is not a pair.
        NotFinite: one is not a finite number.
    """
    try:
        x, y = position
    except (TypeError, ValueError):
        raise BadShape(
            f"{position!r} is not a position", where=where, valid="two numbers"
        ) from None
    return number(x, where), number(y, where)
