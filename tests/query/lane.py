"""Pairs of boxes and their answers, also with each pruning rule off in turn, which needs plain Python."""

import numpy as np

from clearance import Polyhedron, distance
from clearance.compile.calls import KernelFault
from clearance.compile.declared import Floats
from clearance.compile.decorators import kernel
from tests.strategies import BOX_FACES, CUBE_CORNERS, rotations


def reported(near):
    """An answer without its counters, every bit of it."""
    numbers = [near.distance, near.error_bound, *near.point_a, *near.point_b]
    return [float(x).hex() for x in numbers] + [near.face_a, near.face_b, near.contact]


def body_pairs(n):
    """`n` pairs of boxes: apart, crossing and one in the other."""
    random = np.random.default_rng(42)
    for i in range(n):
        pose = np.eye(4)
        pose[:3, :3] = rotations(random, 1)[0]
        pose[:3, 3] = random.normal(size=3) * (2.0, 0.7, 0.01)[i % 3]
        scale = (0.5, 0.5, 0.1)[i % 3]
        yield Polyhedron(CUBE_CORNERS, BOX_FACES), Polyhedron(CUBE_CORNERS * scale, BOX_FACES), pose


def body_answers(n):
    """Their answers."""
    return [reported(distance(a, b, pose_b=pose)) for a, b, pose in body_pairs(n)]


def answers_without_rules(n):
    """For each rule, the answers without it, and how many pairs of faces more were looked at."""
    from clearance.kernels.search import body_pair, descent, nearest, node_pairs

    def nothing_known(p, q, *_):
        """Of boxes alone or in lanes."""
        return 0.0 * (p.centre.x + q.centre.x) - np.inf

    rules = {
        "lower_bound_boxes": nothing_known,
        "lower_bound_boxes_along_direction": nothing_known,
        "lower_bound_faces_along_direction": lambda *_: -np.inf,
        "sure_gap": lambda *_: -np.inf,
        "turned_away": lambda *_: 0,
    }
    found = {}
    for name, never in rules.items():
        users = [module for module in (descent, nearest, node_pairs) if hasattr(module, name)]
        rule = getattr(users[0], name)
        for module in users:
            setattr(module, name, never)
        found[name] = body_answers(n)
        for module in users:
            setattr(module, name, rule)
    assert body_pair.nearest_faces is nearest.nearest_faces
    return found


@kernel
def number_at(numbers: Floats, place: int) -> float:
    """A number of an array, wherever that is."""
    return numbers[place]


def out_of_bounds_is_seen():
    """True if reading past an array is an error here."""

    try:
        number_at(np.zeros(3), 5)
    except (IndexError, KernelFault):
        return True
    return False
