"""Faults of a sketch, besides the package's common errors."""

from __future__ import annotations

from clearance.errors import BadInput


class UnknownEntity(BadInput):
    """An entity or a constraint that the sketch does not have."""


class BadConstraint(BadInput):
    """A constraint between entities of the wrong kinds, or of an entity with itself."""


class DegenerateSketch(BadInput):
    """An entity without extent: a line through coincident points, a circle of radius 0."""
