"""A drawn sketch as closed contours of lines and arcs, always of the same pieces however it is dimensioned."""

from __future__ import annotations

import math

import numpy as np

from clearance.profiles.contour import Contour
from clearance.sketch import Sketch
from clearance.sketch.entities import Arc, Circle, Segment
from clearance.sketch.outline import angles_of, chains, ends_of

LONGEST_ARC = 1.2
"""[rad] Arcs are cut into equal parts of at most this as drawn; fitting may double it before a bulge is lost."""

Chain = list[tuple]
"""(entity, runs backwards, number of equal parts) each."""


def drawn_chains(sketch: Sketch) -> list[Chain]:
    """The closed chains of a sketch; circles alone."""
    entities = list(sketch.entities.values())
    parts = [e for e in entities if isinstance(e, Segment | Arc)]
    found = [[(e, back, _parts(e)) for e, back in chain] for chain in chains(sketch, parts)]
    return found + [[(e, False, 6)] for e in entities if type(e) is Circle]


def contours_of_chains(found: list[Chain]) -> tuple[Contour, ...]:
    """The drawing of the chains now."""
    contours = []
    for chain in found:
        vertices: list[np.ndarray] = []
        bulges: list[float] = []
        for entity, back, n in chain:
            _draw(entity, back, n, vertices, bulges)
        contours.append(Contour(np.array(vertices), np.array(bulges)))
    return tuple(contours)


def _parts(entity) -> int:
    if isinstance(entity, Segment):
        return 1
    start, end = angles_of(entity)
    return max(1, math.ceil((end - start) / LONGEST_ARC))


def _draw(entity, back: bool, n: int, vertices: list[np.ndarray], bulges: list[float]) -> None:
    """Appends the start of each of `n` equal parts of an entity, and their bulge."""
    if isinstance(entity, Segment):
        vertices.append(ends_of(entity)[1 if back else 0].position)
        bulges.append(0.0)
        return
    start, end = angles_of(entity) if isinstance(entity, Arc) else (0.0, 2.0 * math.pi)
    bulge = math.tan(0.25 * (end - start) / n)
    center, radius = entity.center.position, entity.radius
    for k in range(n):
        angle = end - (end - start) * k / n if back else start + (end - start) * k / n
        place = center + radius * np.array([math.cos(angle), math.sin(angle)])
        if k == 0 and isinstance(entity, Arc):
            place = ends_of(entity)[1 if back else 0].position
        vertices.append(place)
        bulges.append(-bulge if back else bulge)
