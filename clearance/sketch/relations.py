"""The constraints of a sketch as they are made: checked, measured, lowered to rows and named.

Not for: what a kind means (`constraints`), nor its equations (`rows`).
"""

from __future__ import annotations

import math

from clearance.errors import BadDimension
from clearance.sketch.constraints import Constraint, form_of, measured
from clearance.sketch.dimensions import Dimensions
from clearance.sketch.entities import Entity
from clearance.sketch.lists import FlatLists
from clearance.sketch.register import Register


class Relations:
    """Adds constraints to a sketch's register and lists."""

    def __init__(self, register: Register, lists: FlatLists, dimensions: Dimensions) -> None:
        self._register = register
        self._lists = lists
        self._dimensions = dimensions

    def add(
        self,
        kind: str,
        entities: tuple[Entity, ...],
        *,
        value: float | str | None = None,
        name: str | None = None,
        driven: bool = False,
        inside: bool | None = None,
        built_in: bool = False,
    ) -> Constraint:
        """A new constraint between entities of this sketch; see `Sketch.add`."""
        form, entities = form_of(kind, entities)
        name = self._register.new_name(name, kind)
        constraint = Constraint(
            name=name,
            kind=kind,
            entities=entities,
            given=None,
            number=math.nan,
            driven=driven,
            built_in=built_in,
            index=len(self._lists.constraints),
            n_rows=0,
            options={} if inside is None else {"inside": bool(inside)},
        )
        self._set_dimension(constraint, bool(form.unit), value)
        numbers = self._lists.numbers
        if not driven:
            rows = form.rows(numbers, *entities, **constraint.options)
            self._lists.append_rows(constraint, rows)
        self._dimensions.remember(constraint)
        self._register.constraints[name] = constraint
        self._lists.append_constraint(constraint)
        return constraint

    def _set_dimension(
        self, constraint: Constraint, measurable: bool, value: float | str | None
    ) -> None:
        """Gives a new constraint its dimension: as asked, or as it is drawn.

        Raises:
            BadDimension: a value for a kind that has none.
        """
        if measurable:
            given = value
            if given is None or constraint.driven:
                given = measured(constraint, self._lists.numbers)
            constraint.number = self._dimensions.checked(constraint, given)
            constraint.given = given if isinstance(given, str) else constraint.number
        elif value is not None:
            raise BadDimension(
                f"{constraint.kind} {constraint.name} with the value {value}",
                valid=f"{constraint.kind} takes no value",
            )
