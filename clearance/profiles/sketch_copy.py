"""A sketch again as a new one, some driven dimensions driving or the reverse, moved on request."""

from __future__ import annotations

import numpy as np

from clearance.sketch import Sketch
from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Segment


def copied(
    sketch: Sketch,
    *,
    driving: frozenset | set = frozenset(),
    released: frozenset | set = frozenset(),
    motion: np.ndarray | None = None,
) -> Sketch:
    """The same sketch again, some driven dimensions made driving or driving ones driven, all moved.

    Args:
        driving, released: names of constraints.
        motion: (2, 3) a rigid motion of the plane; only for sketches that nothing fixes.
    """
    motion = np.eye(2, 3) if motion is None else motion
    made = Sketch()
    made.most_seconds = sketch.most_seconds
    for name, value in sketch.parameters.items():
        made.parameter(name, value)
    points: dict[str, Point] = {}
    for entity in sketch.entities.values():
        _copy_entity(made, points, entity, motion)
    for c in sketch.constraints.values():
        if c.built_in:
            continue
        driven = (c.driven and c.name not in driving) or c.name in released
        given = c.given
        if given is not None and not isinstance(given, str):
            given = float(sketch.value(c.name))
        again = made.add(
            c.kind,
            *(entity.name for entity in c.entities),
            value=given,
            name=c.name,
            driven=driven,
            **c.options,
        )
        if driven:
            again.given = float(again.number)  # plain numbers, for files
    return made


def _copy_entity(
    made: Sketch, points: dict[str, Point], entity: Entity, motion: np.ndarray
) -> None:
    """The same entity in the new sketch, whose `points` so far are known by name."""

    def moved(place: np.ndarray) -> list[float]:
        return (motion[:, :2] @ place + motion[:, 2]).tolist()

    name = entity.name
    if isinstance(entity, Point):
        x, y = moved(entity.position)
        points[name] = made.point(x, y, name=name)
    elif isinstance(entity, Arc):
        center, start, end = (points[p.name] for p in (entity.center, entity.start, entity.end))
        made.arc(center, start, end, name=name)
    elif isinstance(entity, Circle):
        made.circle(points[entity.center.name], entity.radius, name=name)
    elif isinstance(entity, Line):
        draw = made.segment if isinstance(entity, Segment) else made.line
        if entity.ends is not None:
            a, b = entity.ends
            draw(points[a.name], points[b.name], name=name)
        else:
            foot, half = entity.foot, 0.5 * entity.direction
            draw(moved(foot - half), moved(foot + half), name=name)
