"""Dimensions and named parameters: numbers or expressions, and what follows when one changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from clearance.errors import BadDimension, UnknownKey, at, nearest_name
from clearance.sketch.checked_numbers import number
from clearance.sketch.constraints import Constraint, measured
from clearance.sketch.entities import Point
from clearance.sketch.expression import evaluated, names_in
from clearance.sketch.faults import UnknownEntity
from clearance.sketch.lists import FlatLists
from clearance.sketch.register import Register


class Dimensions:
    """The dimensions and parameters of a sketch, and which of them are expressions of others.

    Args:
        register: where parameters and constraints are found by name.
        lists: the numbers by which driven dimensions are measured.
        on_change: called with every constraint whose dimension has changed.
    """

    def __init__(
        self, register: Register, lists: FlatLists, on_change: Callable[[Constraint], None]
    ) -> None:
        self._register = register
        self._lists = lists
        self._on_change = on_change
        self._users: dict[str, list[Constraint]] = {}

    def parameter(self, name: str, value: float) -> None:
        """A new named number for expressions."""
        if not name.isidentifier():
            raise UnknownKey(f"a parameter named {name!r}", valid="letters, digits and _")
        self._register.check_free(name)
        self._register.parameters[name] = number(value, name)

    def set(self, name: str, value: float | str) -> None:
        """Changes a parameter or a dimension, and every dimension that is an expression of it.

        Raises:
            UnknownEntity: no parameter or dimension has this name.
        """
        if name in self._register.parameters:
            self._register.parameters[name] = number(value, name)
        elif (
            name in self._register.constraints
            and self._register.constraints[name].given is not None
        ):
            constraint = self._register.constraints[name]
            now = self.checked(constraint, value)
            self._forget(constraint)
            constraint.given, constraint.number = (value if isinstance(value, str) else now), now
            self.remember(constraint)
        else:
            known = [
                *self._register.parameters,
                *(c.name for c in self._lists.constraints if c.given is not None),
            ]
            raise UnknownEntity(f"no dimension named {name!r}", valid=nearest_name(name, known))
        self._propagate(name)

    def value(self, name: str) -> float:
        """The value of a parameter or dimension; a driven one is measured now."""
        if name in self._register.parameters:
            return self._register.parameters[name]
        constraint = self._register.constraint(name)
        return measured(constraint, self._lists.numbers) if constraint.driven else constraint.number

    def checked(self, constraint: Constraint, given: float | str) -> float:
        """The value of a dimension, checked for its kind."""
        with at(f"{constraint.kind} {constraint.name}"):
            if isinstance(given, str):
                value = evaluated(given, self._values_of(names_in(given)))
            else:
                value = number(given, "value")
            points = all(isinstance(e, Point) for e in constraint.entities)
            if constraint.kind == "angle":
                if not 0.0 <= value <= math.pi:
                    raise BadDimension(f"an angle of {value} rad", valid="0 to pi")
            elif value < 0.0 or (value == 0.0 and (constraint.kind != "distance" or points)):
                valid = "above 0" if constraint.kind != "distance" or points else "0 or above"
                if constraint.kind == "distance" and points:
                    valid += " (coincident joins two points)"
                raise BadDimension(f"a {constraint.kind} of {value}", valid=valid)
        return value

    def _values_of(self, names: Iterable[str]) -> dict[str, float]:
        """The parameters, and the dimensions of these names."""
        scope = dict(self._register.parameters)
        for name in names:
            if (
                name in self._register.constraints
                and self._register.constraints[name].given is not None
            ):
                scope[name] = self.value(name)
        return scope

    def remember(self, constraint: Constraint) -> None:
        """Notes which names a constraint's dimension is an expression of."""
        if isinstance(constraint.given, str):
            for name in names_in(constraint.given):
                self._users.setdefault(name, []).append(constraint)

    def _forget(self, constraint: Constraint) -> None:
        if isinstance(constraint.given, str):
            for name in names_in(constraint.given):
                self._users[name].remove(constraint)

    def _propagate(self, name: str, depth: int = 0) -> None:
        """Writes a changed dimension into its rows and follows the expressions that use it."""
        if depth > 100:
            raise BadDimension(f"{name} depends on itself", valid="expressions without a circle")
        if name in self._register.constraints:
            constraint = self._register.constraints[name]
            if isinstance(constraint.given, str):
                constraint.number = self.checked(constraint, constraint.given)
            self._on_change(constraint)
        for user in self._users.get(name, []):
            self._propagate(user.name, depth + 1)
