"""A few queries for processes with other compiler settings (`test_lanes`): prints their answers as JSON.

`answers`: polygon pairs as hexadecimal floats. `meetings`: where faces of boxes meet. `rules`: bodies with
each pruning rule off in turn, which needs functions that can be replaced, hence plain Python.
"""

import json
import os
import sys

import numpy as np

from clearance import Polyhedron, distance, polygon_distance
from clearance.compile.calls import KernelFault
from clearance.compile.declared import Floats
from clearance.compile.decorators import kernel
from tests.strategies import BOX_FACES, CUBE_CORNERS, FAMILIES, rotations

NAMES = (
    "anywhere",
    "needles",
    "coplanar",
    "shared_edge",
    "vertex_on_face",
    "parallel_faces",
    "crossing_plates",
)


def reported(near):
    """An answer without its counters, every bit of it."""
    numbers = [near.distance, near.error_bound, *near.point_a, *near.point_b]
    return [float(x).hex() for x in numbers] + [near.face_a, near.face_b, near.contact]


def polygon_answers(n):
    """`n` pairs a family."""
    pairs = [
        pair
        for name in NAMES
        for pair in zip(*FAMILIES[name](np.random.default_rng(41), n), strict=True)
    ]
    return [reported(polygon_distance(p, q)) for p, q in pairs]


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


def meetings(n):
    """Which faces of two boxes meet, straight from the kernels: planes, tree and predicates."""
    from clearance.geometry.tree import surface_of
    from clearance.kernels.arithmetic.double_double import frames_of
    from clearance.kernels.arithmetic.predicates import new_exact_scratch
    from clearance.kernels.arithmetic.vec3 import rigid
    from clearance.kernels.features.meeting import meeting
    from clearance.kernels.features.posed_pair import PosedPair

    exact, found = new_exact_scratch(), []
    for a, b, pose in body_pairs(n):
        frames = frames_of(rigid(np.eye(4)), rigid(pose))
        one, two = surface_of(a), surface_of(b)
        for i in range(6):
            for j in range(6):
                at = meeting(PosedPair(one, i, two, j, frames), exact)
                found.append([bool(at.found), *(int(x) for x in at[1:])])
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


def main():
    """Prints what is asked for."""
    os.environ.setdefault("PYTHONHASHSEED", "0")
    np.seterr(all="ignore")
    if sys.argv[1] == "rules":
        reported_now = {"all": body_answers(12), "without": answers_without_rules(12)}
    elif sys.argv[1] == "meetings":
        reported_now = {
            "meetings": meetings(12),
            "bounds": out_of_bounds_is_seen(),
            "compiles": "numba" in sys.modules,
        }
    else:
        reported_now = {
            "polygons": polygon_answers(int(sys.argv[2])),
            "bounds": out_of_bounds_is_seen(),
        }
    print(json.dumps(reported_now))


if __name__ == "__main__":
    main()
