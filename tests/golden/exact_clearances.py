"""The exact least clearance of a case at one step, by the oracle: what the references of this folder are made of.

Shapes are the polyhedra that the case is loaded to, pairs those that are measured then. Where the bodies are and
how far they are from each other is rational arithmetic. Only the order in which pairs are taken comes from floats,
each bound less a micrometre, so that no pair is left out that could be the nearest.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import Pair, selected_pairs
from clearance.world.timeline import timeline_of
from tests import oracle
from tests.golden.exact_places import Places
from tests.oracle.kinematics import placed

SLACK = 1e-6
"""[m] Taken off the gap of two boxes, which floats have to 1e-12."""


def least_clearance_sq(case: Case, step: int) -> tuple[Fraction, list[list[str]]]:
    """The exact squared clearance [m^2] of a step, and the two bodies of each pair that has it.

    Of pairs in contact, the first that is found. Limits change no distance, and so are left aside, rules too.
    """
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    phase = timeline.phase_of(step)
    pairs = selected_pairs(phase).pairs
    bodies = _bodies(case, pairs, Fraction(float(timeline.times[step])))
    found: dict[tuple[str, str], Fraction] = {}
    for bound, one, other in _by_bound(case, pairs, bodies):
        least = min(found.values(), default=None)
        if least is not None and (least == 0 or (bound > 0 and bound * bound > least)):
            break
        found[one, other] = _distance_sq(*bodies[one], *bodies[other])
    least = min(found.values())
    return least, [list(pair) for pair, sq in found.items() if sq == least]


def clearance_sq_of(case: Case, step: int, one: str, other: str) -> Fraction:
    """The exact squared clearance [m^2] of two bodies at a step, as tables call them."""
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    pairs = selected_pairs(timeline.phase_of(step)).pairs
    asked = [p for p in pairs if (p.a.name_in(case), p.b.name_in(case)) == (one, other)]
    bodies = _bodies(case, asked, Fraction(float(timeline.times[step])))
    return _distance_sq(*bodies[one], *bodies[other])


def _bodies(case: Case, pairs: list[Pair], time: Fraction) -> dict:
    """The shape of each body of some pairs, and its vertices in the world."""
    places = Places(case)
    bodies = {body for pair in pairs for body in (pair.a, pair.b)}
    shapes = {body.name_in(case): body.shape_in(case) for body in bodies}
    return {
        name: (shape, placed(shape.vertices, places.of(name, time)))
        for name, shape in shapes.items()
    }


def _by_bound(case: Case, pairs: list[Pair], bodies: dict) -> list[tuple[Fraction, str, str]]:
    """The measured pairs and a lower bound of each, the least first."""
    boxes = {name: _box(vertices) for name, (_, vertices) in bodies.items()}
    names = [(pair.a.name_in(case), pair.b.name_in(case)) for pair in pairs]
    return sorted((_gap(boxes[one], boxes[other]), one, other) for one, other in names)


def _box(vertices: list) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(vertices, dtype=float)
    return points.min(axis=0), points.max(axis=0)


def _gap(one: tuple, two: tuple) -> Fraction:
    apart = np.maximum(np.maximum(one[0] - two[1], two[0] - one[1]), 0.0)
    return max(Fraction(0), Fraction(float(np.linalg.norm(apart))) - Fraction(SLACK))


def _distance_sq(shape_a, vertices_a, shape_b, vertices_b) -> Fraction:
    return oracle.solid_distance_sq(
        vertices_a, _faces(shape_a), vertices_b, _faces(shape_b),
        closed_a=_holds(shape_a), closed_b=_holds(shape_b),
    )  # fmt: skip


def _faces(shape) -> list:
    return np.split(shape.face_vertices, shape.face_starts[1:-1])


def _holds(shape) -> bool:
    return shape.closed and shape.oriented
