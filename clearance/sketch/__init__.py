"""Geometric constraint solving for plane sketches."""

from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Polyline, Segment
from clearance.sketch.faults import BadConstraint, DegenerateSketch, UnknownEntity
from clearance.sketch.result import SketchResult
from clearance.sketch.sketch import Sketch

__all__ = [
    "Arc",
    "BadConstraint",
    "Circle",
    "DegenerateSketch",
    "Entity",
    "Line",
    "Point",
    "Polyline",
    "Segment",
    "Sketch",
    "SketchResult",
    "UnknownEntity",
]
