"""Polygon and body pairs of every hostile family against rational arithmetic, a million: what is ever wrong.

    python -m tests.oracle.stress --rounds 100 [FAMILY ... | bodies]

Counts false and missed contacts and violated error bounds, and tells the worst relative error. A round is 1000
polygon pairs of each family, 100 of polygons with 8 to 64 corners, and 100 pairs of bodies. Seeds are fixed by
family and round. Exits with 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from clearance import Polyhedron, box, distance
from clearance.query.distance import _measured
from tests import oracle
from tests.made_cases import faces_of
from tests.strategies import FAMILIES, QUARTER_TURNS, rotations


@dataclass
class Tally:
    """What is known of a family."""

    pairs: int = 0
    contacts: int = 0
    false_contacts: int = 0
    missed_contacts: int = 0
    bounds_violated: int = 0
    worst_relative_error: float = 0.0

    def add(self, answer: float, error_bound: float, contact: bool, sq: Fraction) -> None:
        """One answer held against the truth."""
        self.pairs += 1
        self.contacts += sq == 0
        self.false_contacts += contact and sq != 0
        self.missed_contacts += not contact and sq == 0
        low, high = (
            Fraction(answer) - Fraction(error_bound),
            Fraction(answer) + Fraction(error_bound),
        )
        self.bounds_violated += high * high < sq or (low > 0 and low * low > sq)
        if sq > Fraction(2) ** -900 and self.pairs % 8 == 1:
            error = float(oracle.error(answer, sq) / oracle.root(sq))
            self.worst_relative_error = max(self.worst_relative_error, error)

    @property
    def wrong(self) -> int:
        """False and missed contacts and violated bounds."""
        return self.false_contacts + self.missed_contacts + self.bounds_violated


def judge_polygons(tally: Tally, name: str, seed: int, n: int) -> None:
    """`n` pairs of a family, each read from its least corner on: the fan that is measured."""
    ps, qs = (np.ascontiguousarray(x) for x in FAMILIES[name](np.random.default_rng([seed, 77]), n))
    found = _measured(ps, qs)
    for k, pair in enumerate(zip(ps, qs, strict=True)):
        sq = oracle.polygon_distance_sq(*map(from_least_corner, pair))
        tally.add(float(found.distance[k]), float(found.error[k]), bool(found.contact[k]), sq)


def from_least_corner(polygon: np.ndarray) -> np.ndarray:
    """The polygon with its least corner first."""
    return np.roll(polygon, -min(range(len(polygon)), key=lambda i: tuple(polygon[i])), axis=0)


def body_pairs(random: np.random.Generator, n: int) -> Iterator[tuple]:
    """Tuples (family, a, b, pose_a, pose_b) of boxes and wedges, families in turn."""
    for i in range(n):
        name = ("apart", "square", "close", "far away", "nested")[i % 5]
        spread = {"close": 0.3, "nested": 0.02}.get(name, 1.5)
        a, b = part(random), part(random)
        pose_a, pose_b = (pose(random, s, name == "square") for s in (0.3, spread))
        if name == "far away":
            offset = random.normal(size=3) * 10.0 ** random.uniform(0.0, 6.0)
            pose_a[:3, 3] += offset
            pose_b[:3, 3] += offset
        if name == "nested":
            pose_b[:3, 3] += pose_a[:3, 3]
            b = Polyhedron(0.1 * b.vertices, faces_of(b))
        yield f"bodies {name}", a, b, pose_a, pose_b


def part(random: np.random.Generator) -> Polyhedron:
    """A box or a wedge, 1e-3 to 2 wide, about the origin."""
    if random.random() < 0.5:
        return box(10.0 ** random.uniform(-3.0, 0.3, 3))
    corners = [[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (0, 1))]
    faces = [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
    return Polyhedron(np.array(corners) * random.choice([0.125, 0.25, 0.5], 3), faces)


def pose(random: np.random.Generator, spread: float, square: bool) -> np.ndarray:
    """Any pose, or a quarter turn at a quarter of a metre."""
    matrix = np.eye(4)
    matrix[:3, :3] = QUARTER_TURNS[random.integers(24)] if square else rotations(random, 1)[0]
    matrix[:3, 3] = random.integers(-4, 5, 3) / 4.0 if square else random.normal(size=3) * spread
    return matrix


def run_round(tallies: dict[str, Tally], seed: int, only: list[str]) -> None:
    """One round of all families, or of some."""
    for name in sorted(FAMILIES):
        if not only or name in only:
            judge_polygons(tallies[name], name, seed, 100 if name == "many_sided" else 1000)
    if only and "bodies" not in only:
        return
    for name, a, b, pose_a, pose_b in body_pairs(np.random.default_rng([seed, 78]), 100):
        near = distance(a, b, pose_a=pose_a, pose_b=pose_b)
        sq = oracle.solid_distance_sq(
            a.vertices, faces_of(a), b.vertices, faces_of(b), pose_a, pose_b
        )
        tallies[name].add(near.distance, near.error_bound, near.contact, sq)


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("families", nargs="*", default=[], help="all if none is named")
    given = parser.parse_args()
    tallies: dict[str, Tally] = defaultdict(Tally)
    for seed in range(given.rounds):
        run_round(tallies, seed, given.families)
        print(f"round {seed + 1}: wrong {sum(t.wrong for t in tallies.values())}", flush=True)
    for name, tally in tallies.items():
        print(f"| {name} | " + " | ".join(f"{value:.2g}" if isinstance(value, float) else str(value)
                                          for value in vars(tally).values()) + " |")  # fmt: skip
    sys.exit(1 if any(tally.wrong for tally in tallies.values()) else 0)


if __name__ == "__main__":
    main()
