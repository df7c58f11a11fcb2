"""What a sketch holds, by name: entities, constraints, parameters; names are checked here.

Not for: what they mean (`constraints`), nor their numbers (`lists`).
"""

from __future__ import annotations

from clearance.errors import DuplicateName, nearest_name
from clearance.sketch.constraints import Constraint
from clearance.sketch.entities import Entity
from clearance.sketch.faults import UnknownEntity
from clearance.sketch.lists import FlatLists


class Register(FlatLists):
    """Entities, constraints and parameters by name, each name used once."""

    def __init__(self) -> None:
        super().__init__()
        self.entities: dict[str, Entity] = {}
        self.constraints: dict[str, Constraint] = {}
        self.parameters: dict[str, float] = {}
        self._counts: dict[str, int] = {}
        self._sides: list[Constraint] = []
        self._solver = None

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

    def sides(self, chosen: set[int] | None = None) -> list[tuple[int, int, int]]:
        """The variables of every `same_side` (of the chosen constraints by index): two points, a line."""
        return [
            tuple(e.variable for e in c.entities)
            for c in self._sides
            if chosen is None or c.index in chosen
        ]

    def _name(self, given: str | None, what: str) -> str:
        if given is None:
            while True:
                self._counts[what] = self._counts.get(what, 0) + 1
                name = f"{what}{self._counts[what]}"
                if name not in self.entities and name not in self.constraints:
                    return name
        if not isinstance(given, str) or not given:
            raise UnknownEntity(f"a name {given!r}", valid="a text")
        self._free(given)
        return given

    def _free(self, name: str) -> None:
        if name in self.entities or name in self.constraints or name in self.parameters:
            raise DuplicateName(f"the name {name!r} is taken", valid="a name used once")

    def _own(self, entity: Entity, kind: type) -> None:
        if not isinstance(entity, kind):
            what = entity.what if isinstance(entity, Entity) else repr(entity)
            raise UnknownEntity(
                f"{what} where a {kind.what} is needed", valid=f"a {kind.what} of this sketch"
            )
        if entity.sketch is not self or self.entities.get(entity.name) is not entity:
            raise UnknownEntity(
                f"{entity.name!r} is of another sketch", valid="an entity of this one"
            )

    def _find(self, entity: Entity | str) -> Entity:
        if isinstance(entity, str):
            return self.entity(entity)
        self._own(entity, Entity)
        return entity

    def _add(self, entity):
        self.entities[entity.name] = entity
        self._solver = None
        return entity
