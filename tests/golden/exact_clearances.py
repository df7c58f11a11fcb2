"""The exact least clearance of a case at one step, by the oracle: what the references of this folder are made of.

Shapes are the polyhedra that the case is loaded to. Where the links are and how far they are from the obstacles
is rational arithmetic. Only the order in which pairs are taken comes from floats, each bound less a micrometre,
so that no pair is left out that could be the nearest.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from clearance.world.case import Case
from clearance.world.pairs import measured_pairs
from tests import oracle
from tests.oracle.kinematics import link_poses, placed

SLACK = 1e-6
"""[m] Taken off the gap of two boxes, which floats have to 1e-12."""


def least_clearance_sq(case: Case, step: int) -> tuple[Fraction, list[list[str]]]:
    """The exact squared clearance [m^2] of a step, and the link and obstacle of each pair that has it.

    Of pairs in contact, the first that is found.
    """
    links, obstacles = _links(case, step), _obstacles(case)
    found: dict[tuple[str, str], Fraction] = {}
    for bound, link, obstacle in _by_bound(case, links, obstacles):
        least = min(found.values(), default=None)
        if least is not None and (least == 0 or (bound > 0 and bound * bound > least)):
            break
        found[link, obstacle] = _distance_sq(*links[link], *obstacles[obstacle])
    least = min(found.values())
    return least, [list(pair) for pair, sq in found.items() if sq == least]


def _links(case: Case, step: int) -> dict:
    """Each link's shape and its vertices in the world."""
    (robot,) = case.robots
    given = dict(zip(robot.trajectory.joint_names, robot.trajectory.positions[step], strict=True))
    poses = link_poses(robot.robot, robot.fixed_positions | given, robot.world_from_base)
    return {
        body.name: (body.shape, placed(body.shape.vertices, poses[body.name]))
        for body in robot.robot.bodies
    }


def _obstacles(case: Case) -> dict:
    return {
        one.name: (one.body.shape, placed(one.body.shape.vertices, one.world_from_body))
        for one in case.obstacles
    }


def _by_bound(case: Case, links: dict, obstacles: dict) -> list[tuple[Fraction, str, str]]:
    """The measured pairs and a lower bound of each, the least first."""
    pairs = [(case.robots[0].robot.bodies[p.i_body].name, case.obstacles[p.i_obstacle].name)
             for p in measured_pairs(case)[0]]  # fmt: skip
    boxes = {
        name: _box(vertices)
        for group in (links, obstacles)
        for name, (_, vertices) in group.items()
    }
    return sorted((_gap(boxes[link], boxes[obstacle]), link, obstacle) for link, obstacle in pairs)


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
