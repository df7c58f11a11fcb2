"""A small question to each domain of kernels, for processes with other compiler settings (`test_lanes`).

`python tests/query/lane_of_domains.py DOMAIN …` prints the answers as JSON, every bit of them: floats are
hexadecimal. The questions are as small as they can be and still come to the kernels: what takes time is to
compile.
"""

from __future__ import annotations

import json
import sys

import numpy as np

import clearance as cl
from clearance.compile.calls import KernelFault
from clearance.compile.declared import Floats
from clearance.compile.decorators import kernel
from tests.made_cases import arm, at, dented, flying
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
        yield (
            cl.Polyhedron(CUBE_CORNERS, BOX_FACES),
            cl.Polyhedron(CUBE_CORNERS * scale, BOX_FACES),
            pose,
        )


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


def search() -> list:
    """Boxes apart, crossing and one in the other; a dented ball, whose features have concave edges."""
    rough = dented(np.random.default_rng(5), 1, 0.3, 0.3)
    pairs = [*body_pairs(6), (rough, rough, at(x=0.8)), (rough, rough, at(x=0.5, y=0.1))]
    return [reported(cl.distance(a, b, pose_b=pose)) for a, b, pose in pairs]


def sweep() -> list:
    """An arm of two links past a box and a dented ball, every step."""
    steps = cl.check(_two_links(), certify=False).steps
    return [[name, [_bits(x) for x in steps[name].to_pylist()]] for name in steps.column_names]


def certify() -> list:
    """The proof for the motion between the steps, of the arm and of a body that turns and flies."""
    found = []
    for case in (_two_links(), _flight()):
        proof = cl.answer(cl.Question(case, certify_gap=2e-2, contact="none")).record.certificate
        found.append([_bits(x) for x in (*proof.lower_bound, *proof.upper_bound, *proof.share)])
    return found


def polytope() -> list:
    """What two convex bodies share, how deep they are in one another, and a point of both."""
    random = np.random.default_rng(6)
    found = []
    for shift in (0.4, 0.9, 5.0):
        a, b = (cl.Polytope(random.normal(size=(9, 3)) + [i * shift, 0.0, 0.0]) for i in range(2))
        region = cl.intersect([a, b])
        depth = cl.penetration(a, b)
        found.append(
            [_bits(a.volume), _bits(region.volume), _bits(depth.depth), _bits(depth.at_least)]
        )
    return found


def hausdorff() -> list:
    """Polylines, cubics and arcs, and whether they keep within a limit."""
    bent = np.array([[0.0, 0.0], [1.0, 0.8], [2.0, -0.7], [3.0, 0.1]])
    curves = [
        cl.Curve.polyline(bent),
        cl.Curve.bezier(bent),
        cl.Curve.arc([1.5, 0.0], 1.4, 0.2, 2.9),
    ]
    found = []
    for a in curves:
        for b in curves:
            both = cl.hausdorff(a, b)
            found.append([_bits(both.lower), _bits(both.upper), cl.within(a, b, 0.9 * both.lower)])
    return found


DOMAINS = {one.__name__: one for one in (search, sweep, certify, polytope, hausdorff)}


def _two_links() -> cl.Case:
    rough = dented(np.random.default_rng(2), 0, 0.3, 0.08)
    obstacles = [(cl.box((0.2, 0.2, 0.2)), at(x=0.45, y=0.35)), (rough, at(x=0.2, y=-0.3, z=0.1))]
    positions = np.linspace([-0.4, -0.2], [0.9, 0.7], 7)
    return arm("two links", [cl.box((0.2, 0.05, 0.05)), rough], obstacles, positions)


def _flight() -> cl.Case:
    positions = np.linspace([-0.1, 0.0, 0.02, 0.0, 0.0, 0.0], [0.1, 0.05, 0.0, 0.5, 1.0, 0.3], 5)
    bar = cl.box((0.3, 0.02, 0.02))
    return flying(
        "flight",
        bar,
        [(cl.pipe(inner_radius=0.3, outer_radius=0.35, length=0.1, sections=12), at())],
        positions,
    )


def _bits(value: object) -> object:
    """A float as hexadecimal digits; anything else as it is."""
    return float(value).hex() if isinstance(value, float) else value


def main(domains: list[str]) -> None:
    """Prints the answers of the domains that are named."""
    np.seterr(all="ignore")
    found = {"bounds": out_of_bounds_is_seen()} | {name: DOMAINS[name]() for name in domains}
    print(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1:])
