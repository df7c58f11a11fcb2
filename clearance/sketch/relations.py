"""The constraints of a sketch and their dimensions: numbers or expressions, and what follows when one changes."""

from __future__ import annotations

import math

from clearance.errors import BadDimension, BadInput, UnknownKey, at, nearest_name
from clearance.sketch.constraints import Constraint, form_of, measured
from clearance.sketch.entities import Entity, Point
from clearance.sketch.expression import evaluated, names_in
from clearance.sketch.faults import UnknownEntity
from clearance.sketch.lists import FlatLists
from clearance.sketch.register import Register, number


class Relations(Register):
    """Constraints and parameters of a sketch, and which of them are expressions of others."""

    def __init__(self) -> None:
        super().__init__()
        self._lists = FlatLists()
        self._users: dict[str, list[Constraint]] = {}

    def _relate(
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
        """A new constraint between entities of this sketch; see `Sketch.add`.

        Raises:
            BadDimension: a value for a kind that has none.
        """
        form, entities = form_of(kind, entities)
        name = self._new_name(name, kind)
        options = {} if inside is None else {"inside": bool(inside)}
        index = len(self._lists.constraints)
        constraint = Constraint(name, kind, entities, driven, built_in, index, options)
        numbers = self._lists.numbers
        if form.unit:
            given = measured(constraint, numbers) if value is None or driven else value
            self._give(constraint, given)
        elif value is not None:
            raise BadDimension(
                f"{kind} {name} with the value {value}", valid=f"{kind} takes no value"
            )
        if not driven:
            self._lists.append_rows(constraint, form.rows(numbers, *entities, **options))
        self.constraints[name] = constraint
        self._lists.constraints.append(constraint)
        return constraint

    def parameter(self, name: str, value: float) -> None:
        """A new named number for expressions."""
        if not name.isidentifier():
            raise UnknownKey(f"a parameter named {name!r}", valid="letters, digits and _")
        self._check_free(name)
        self.parameters[name] = number(value, name)

    def set(self, name: str, value: float | str) -> None:
        """Changes a parameter or a dimension, and every dimension that is an expression of it, or nothing.

        Raises:
            UnknownEntity: no parameter or dimension has this name. BadDimension: a value that it, or one that
                follows, may not have.
        """
        parameters, users = dict(self.parameters), {k: [*v] for k, v in self._users.items()}
        dimensions = [(c, c.given, c.number) for c in self.constraints.values()]
        try:
            self._set(name, value)
        except BadInput:
            self.parameters.clear()
            self.parameters.update(parameters)
            self._users = users
            for constraint, given, now in dimensions:
                constraint.given, constraint.number = given, now
            raise

    def _set(self, name: str, value: float | str) -> None:
        parameters, constraints = self.parameters, self.constraints
        if name in parameters:
            parameters[name] = number(value, name)
        elif self._is_dimension(name):
            self._give(constraints[name], value)
        else:
            known = [*parameters, *filter(self._is_dimension, constraints)]
            raise UnknownEntity(f"no dimension named {name!r}", valid=nearest_name(name, known))
        self._propagate(name)

    def value(self, name: str) -> float:
        """The value of a parameter or dimension; a driven one is measured now."""
        if name in self.parameters:
            return self.parameters[name]
        constraint = self.constraint(name)
        return measured(constraint, self._lists.numbers) if constraint.driven else constraint.number

    def _is_dimension(self, name: str) -> bool:
        """Whether a constraint of that name has a dimension."""
        constraints = self.constraints
        return name in constraints and constraints[name].given is not None

    def _give(self, constraint: Constraint, given: float | str) -> None:
        """Gives a constraint its dimension, and notes which names it is an expression of."""
        now, before = self._checked(constraint, given), constraint.given
        for name in names_in(before) if isinstance(before, str) else ():
            self._users[name].remove(constraint)
        constraint.given, constraint.number = (given if isinstance(given, str) else now), now
        for name in names_in(given) if isinstance(given, str) else ():
            self._users.setdefault(name, []).append(constraint)

    def _checked(self, constraint: Constraint, given: float | str) -> float:
        """The value of a dimension, checked for its kind."""
        with at(f"{constraint.kind} {constraint.name}"):
            value = self._evaluated(given) if isinstance(given, str) else number(given, "value")
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

    def _evaluated(self, expression: str) -> float:
        """The value of an expression of parameters and dimensions."""
        known = {n: self.value(n) for n in names_in(expression) if self._is_dimension(n)}
        return evaluated(expression, self.parameters | known)

    def _propagate(self, name: str, depth: int = 0) -> None:
        """Works out again the dimensions that are expressions of a changed one."""
        if depth > 100:
            raise BadDimension(f"{name} depends on itself", valid="expressions without a circle")
        for user in self._users.get(name, []):
            assert isinstance(user.given, str), "only expressions use names"
            user.number = self._checked(user, user.given)
            self._propagate(user.name, depth + 1)
