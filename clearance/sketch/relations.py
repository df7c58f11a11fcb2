"""The constraints of a sketch, one method a kind; each is checked, lowered to rows and named here."""

from __future__ import annotations

import math

from clearance.errors import BadDimension
from clearance.sketch.constraints import Constraint, form_of, measured
from clearance.sketch.dimensions import Dimensions
from clearance.sketch.entities import Entity


class Relations(Dimensions):
    """The part of a sketch that adds constraints."""

    def add(
        self,
        kind: str,
        *entities: Entity | str,
        value: float | str | None = None,
        name: str | None = None,
        driven: bool = False,
        inside: bool | None = None,
    ) -> Constraint:
        """A new constraint of any kind (a key of `clearance.sketch.constraints.KINDS`).

        Args:
            entities: entities of this sketch, or their names.
            value: the dimension, a number or an expression of parameters and dimensions.
            driven: measure only.
            inside: for two tangent circles, one within the other; by default as drawn.
        """
        found = tuple(self._find(e) for e in entities)
        options = {} if inside is None else {"inside": bool(inside)}
        return self._constrain(kind, found, value, name, driven, False, options)

    def fix(self, entity: Entity, *, name: str | None = None) -> Constraint:
        """Holds an entity where it is drawn."""
        return self.add("fix", entity, name=name)

    def distance(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Distance [m] of two points, a point and a line or circle, or two lines (made
        parallel)."""
        return self.add("distance", a, b, value=value, name=name, driven=driven)

    def incident(self, a, b, *, name=None) -> Constraint:
        """A point lies on a line or circle."""
        return self.add("incident", a, b, name=name)

    def coincident(self, a, b, *, name=None) -> Constraint:
        """Two points, or two lines, are one."""
        return self.add("coincident", a, b, name=name)

    def tangent(self, a, b, *, inside: bool | None = None, name=None) -> Constraint:
        """A line touches a circle, or two circles touch (by default as drawn: inside or
        outside)."""
        return self.add("tangent", a, b, inside=inside, name=name)

    def angle(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Angle [rad], 0 to pi, between the directions of two lines; the turn is as drawn."""
        return self.add("angle", a, b, value=value, name=name, driven=driven)

    def parallel(self, a, b, *, name=None) -> Constraint:
        """Two lines are parallel."""
        return self.add("parallel", a, b, name=name)

    def perpendicular(self, a, b, *, name=None) -> Constraint:
        """Two lines are perpendicular."""
        return self.add("perpendicular", a, b, name=name)

    def concentric(self, a, b, *, name=None) -> Constraint:
        """Two circles have one centre, or a point is a circle's centre."""
        return self.add("concentric", a, b, name=name)

    def horizontal(self, *entities, name=None) -> Constraint:
        """A line, or two points, lie along x."""
        return self.add("horizontal", *entities, name=name)

    def vertical(self, *entities, name=None) -> Constraint:
        """A line, or two points, lie along y."""
        return self.add("vertical", *entities, name=name)

    def radius(self, circle, value=None, *, name=None, driven=False) -> Constraint:
        """Radius [m] of a circle."""
        return self.add("radius", circle, value=value, name=name, driven=driven)

    def diameter(self, circle, value=None, *, name=None, driven=False) -> Constraint:
        """Diameter [m] of a circle."""
        return self.add("diameter", circle, value=value, name=name, driven=driven)

    def equal_length(self, a, b, *, name=None) -> Constraint:
        """Two lines with points are equally long."""
        return self.add("equal_length", a, b, name=name)

    def equal_radius(self, a, b, *, name=None) -> Constraint:
        """Two circles have one radius."""
        return self.add("equal_radius", a, b, name=name)

    def ratio(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Length (or radius) of a over that of b."""
        return self.add("ratio", a, b, value=value, name=name, driven=driven)

    def midpoint(self, m, *ends, name=None) -> Constraint:
        """A point is the middle of a line with points, or of two points."""
        return self.add("midpoint", m, *ends, name=name)

    def symmetric(self, a, b, line, *, name=None) -> Constraint:
        """Two points, or two circles, are mirror images in a line."""
        return self.add("symmetric", a, b, line, name=name)

    def same_side(self, a, b, line, *, name=None) -> Constraint:
        """Two points lie on one side of a line."""
        return self.add("same_side", a, b, line, name=name)

    def _constrain(
        self, kind, entities, value=None, name=None, driven=False, built_in=False, options=None
    ):
        form, entities = form_of(kind, entities)
        name = self._name(name, kind)
        constraint = Constraint(
            name,
            kind,
            entities,
            None,
            math.nan,
            driven,
            built_in,
            len(self._ordered),
            0,
            options or {},
        )
        if form.unit:
            given = measured(constraint, self._numbers) if value is None or driven else value
            constraint.number = self._dimension(constraint, given)
            constraint.given = given if isinstance(given, str) else constraint.number
        elif value is not None:
            raise BadDimension(
                f"{kind} {name} with the value {value}", valid=f"{kind} takes no value"
            )
        if not driven:
            self._append(constraint, form.rows(self._numbers, *entities, **constraint.options))
            if kind == "same_side":
                self._sides.append(constraint)
        self._remember(constraint)
        self.constraints[name] = constraint
        self._ordered.append(constraint)
        self._solver = None
        return constraint
