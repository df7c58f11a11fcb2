"""A sketch again as a new one, some dimensions driving that were driven or the other way round, moved if asked.

Not for: solving (`clearance.sketch`), or shapes of numbers (`fit_shape`).
"""

from __future__ import annotations

import numpy as np

from clearance.sketch import Sketch


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
    for name, value in sketch.parameters.items():
        made.parameter(name, value)
    for entity in sketch.entities.values():
        _copy_entity(made, entity, motion)
    for c in sketch.constraints.values():
        if c.built_in:
            continue
        driven = (c.driven and c.name not in driving) or c.name in released
        value = c.given
        if value is not None and not isinstance(value, str):
            value = float(sketch.value(c.name))
        again = made.add(
            c.kind,
            *(entity.name for entity in c.entities),
            value=value,
            name=c.name,
            driven=driven,
            **c.options,
        )
        if driven:
            again.given = float(again.number)  # plain numbers, for files
    return made


def _copy_entity(made: Sketch, entity, motion: np.ndarray) -> None:
    def moved(point) -> list[float]:
        return (motion[:, :2] @ point + motion[:, 2]).tolist()

    name = entity.name
    if entity.what == "point":
        made.point(*moved(entity.position), name=name)
    elif entity.what == "circle":
        made.circle(made.entity(entity.center.name), entity.radius, name=name)
    elif entity.what == "arc":
        ends = (made.entity(p.name) for p in (entity.center, entity.start, entity.end))
        made.arc(*ends, name=name)
    else:
        if entity.ends is not None:
            ends = [made.entity(p.name) for p in entity.ends]
        else:
            foot = entity.foot
            ends = [moved(foot - 0.5 * entity.direction), moved(foot + 0.5 * entity.direction)]
        (made.segment if entity.what == "segment" else made.line)(*ends, name=name)
