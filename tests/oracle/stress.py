"""Polygon and body pairs of every hostile family against exact arithmetic, a million: what is ever wrong.

    python -m tests.oracle.stress --rounds 100 --out stress.csv [FAMILY ... | polygons | bodies]

Counts false and missed contacts and violated error bounds, the worst relative error, the median of bound over
error, and the share of pairs whose contact took exact arithmetic. A round is 1000 to 1200 pairs of each family
that is quick to prove, 220 of the others, 100 of polygons with 8 to 64 corners and 100 pairs of bodies; 100
rounds are 1,004,000 polygon pairs and 10,000 body pairs. The truth is the oracle: a guess proven on the
integer grid (certificates), else brute force in rationals. Seeds are fixed by family and round; the csv is
written after every round, with what was done until then. Exits with 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance import Polyhedron, distance
from clearance.query.distance import _measured
from tests import oracle
from tests.oracle.certificates import polygon_distances_sq
from tests.strategies import BOX_FACES, FAMILIES, QUARTER_TURNS, rotations

SLOW = ("unequal", "parallel_faces", "shared_vertex", "shared_edge", "vertex_on_face", "crossing_plates",
        "nearly_touching")  # fmt: skip


@dataclass
class Tally:
    """What is known of a family."""

    pairs: int = 0
    contacts: int = 0
    false_contacts: int = 0
    missed_contacts: int = 0
    bounds_violated: int = 0
    exact_decisions: int = 0
    by_certificate: int = 0
    worst_relative_error: float = 0.0
    ratios: list = field(default_factory=list)
    seconds: float = 0.0

    def add(self, answer, error_bound, contact, exact, sq, proven) -> None:
        """One answer held against the truth."""
        self.pairs += 1
        self.contacts += sq == 0
        self.false_contacts += bool(contact and sq != 0)
        self.missed_contacts += bool(not contact and sq == 0)
        self.exact_decisions += bool(exact)
        self.by_certificate += proven
        low, high = (
            Fraction(answer) - Fraction(error_bound),
            Fraction(answer) + Fraction(error_bound),
        )
        self.bounds_violated += bool(high * high < sq or (low > 0 and low * low > sq))
        if sq > Fraction(2) ** -900 and self.pairs % 8 == 1:
            error = oracle.error(answer, sq)
            self.worst_relative_error = max(
                self.worst_relative_error, float(error / oracle.root(sq))
            )
            if error:
                self.ratios.append(float(Fraction(error_bound) / error))

    @property
    def wrong(self) -> int:
        """False and missed contacts and violated bounds."""
        return self.false_contacts + self.missed_contacts + self.bounds_violated

    def row(self, name: str) -> dict:
        """As the csv tells it."""
        return {
            "family": name,
            "pairs": self.pairs,
            "contacts": self.contacts,
            "false_contacts": self.false_contacts,
            "missed_contacts": self.missed_contacts,
            "bounds_violated": self.bounds_violated,
            "worst_relative_error": f"{self.worst_relative_error:.2g}",
            "median_bound_to_error": f"{np.median(self.ratios) if self.ratios else np.nan:.4g}",
            "exact_decisions_percent": f"{100 * self.exact_decisions / max(1, self.pairs):.2f}",
            "truth_by_certificate_percent": f"{100 * self.by_certificate / max(1, self.pairs):.1f}",
            "seconds": f"{self.seconds:.0f}",
        }


WEDGE_FACES = [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
PYRAMID_FACES = [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


class Part(NamedTuple):
    """A body, and its corners and faces as the oracle takes them."""

    shape: Polyhedron
    vertices: np.ndarray
    faces: list


def part(random: np.random.Generator) -> Part:
    """A box, a wedge or a pyramid, 1e-3 to 2 wide, about the origin."""
    size = (
        10.0 ** random.uniform(-3.0, 0.3, 3)
        if random.random() < 0.5
        else random.choice([0.25, 0.5, 1.0], 3)
    )
    kind = random.integers(3)
    if kind == 0:
        corners = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        faces = BOX_FACES
    elif kind == 1:
        corners = [[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (0, 1))]
        faces = WEDGE_FACES
    else:
        corners = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [0, 0, 1]]
        faces = PYRAMID_FACES
    vertices = 0.5 * np.array(corners, dtype=float) * size
    return Part(Polyhedron(vertices, faces), vertices, faces)


def pose(random: np.random.Generator, spread: float, square: bool) -> np.ndarray:
    """Any pose, or a quarter turn at a quarter of a metre."""
    matrix = np.eye(4)
    if square:
        matrix[:3, :3] = QUARTER_TURNS[random.integers(24)]
        matrix[:3, 3] = random.integers(-4, 5, 3) / 4.0
    else:
        matrix[:3, :3] = rotations(random, 1)[0]
        matrix[:3, 3] = random.normal(size=3) * spread
    return matrix


def body_pairs(random: np.random.Generator, n: int) -> Iterator[tuple]:
    """`n` tuples (family, a, b, pose_a, pose_b), families in turn."""
    for i in range(n):
        a, b = part(random), part(random)
        name = (
            "bodies_apart",
            "bodies_square",
            "bodies_close",
            "bodies_far_away",
            "bodies_nested",
        )[i % 5]
        square = name == "bodies_square"
        spread = {"bodies_close": 0.3, "bodies_nested": 0.02}.get(name, 1.5)
        pose_a, pose_b = pose(random, 0.3, square), pose(random, spread, square)
        if name == "bodies_far_away":
            offset = random.normal(size=3) * 10.0 ** random.uniform(0.0, 6.0)
            pose_a[:3, 3] += offset
            pose_b[:3, 3] += offset
        if name == "bodies_nested":
            pose_b[:3, 3] += pose_a[:3, 3]
            vertices = 0.1 * b.vertices
            b = Part(Polyhedron(vertices, b.faces), vertices, b.faces)
        yield name, a, b, pose_a, pose_b


def from_least_corner(polygon: np.ndarray) -> np.ndarray:
    """The polygon read from its least corner: the fan that is measured."""
    n = len(polygon)
    doubled = [tuple(x) for x in polygon.tolist()] * 2
    return np.roll(polygon, -min(range(n), key=lambda i: doubled[i : i + n]), axis=0)


def judge_polygons(tally: Tally, name: str, seed: int, n: int) -> None:
    """`n` pairs of a family."""
    ps, qs = (np.ascontiguousarray(x) for x in FAMILIES[name](np.random.default_rng([seed, 77]), n))
    found = _measured(ps, qs)
    turned = [np.array([from_least_corner(polygon) for polygon in x]) for x in (ps, qs)]
    for k, (sq, proven) in enumerate(polygon_distances_sq(*turned)):
        answer, bound = float(found.distance[k]), float(found.error[k])
        tally.add(answer, bound, found.contact[k], found.exact[k], sq, proven)


def judge_bodies(tallies: dict[str, Tally], seed: int, n: int) -> None:
    """`n` pairs of bodies, families in turn."""
    for name, a, b, pose_a, pose_b in body_pairs(np.random.default_rng([seed, 78]), n):
        tally, start = tallies.setdefault(name, Tally()), time.process_time()
        near = distance(a.shape, b.shape, pose_a=pose_a, pose_b=pose_b)
        sq = oracle.solid_distance_sq(a.vertices, a.faces, b.vertices, b.faces, pose_a, pose_b)
        tally.add(
            near.distance, near.error_bound, near.contact, near.tally["exact_decisions"], sq, False
        )
        tally.seconds += time.process_time() - start


def run_round(tallies: dict[str, Tally], seed: int, only: list[str]) -> None:
    """One round of all families, or of some."""
    for name in sorted(FAMILIES):
        if only and name not in only and "polygons" not in only:
            continue
        n = 220 if name in SLOW else 1200
        tally, start = tallies.setdefault(name, Tally()), time.process_time()
        if name == "many_sided":
            for part in range(10):
                judge_polygons(tally, name, 10 * seed + part, 10)
        else:
            judge_polygons(tally, name, seed, n)
        tally.seconds += time.process_time() - start
    if not only or "bodies" in only:
        judge_bodies(tallies, seed, 100)


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--out", type=Path, help="csv file")
    parser.add_argument("families", nargs="*", default=[], help="all if none is named")
    given = parser.parse_args()
    tallies: dict[str, Tally] = {}
    for seed in range(given.rounds):
        run_round(tallies, seed, given.families)
        rows = [tally.row(name) for name, tally in tallies.items()]
        if given.out:
            with given.out.open("w", newline="", encoding="utf-8") as out:
                writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
                writer.writeheader()
                writer.writerows(rows)
        print(f"round {seed + 1}: wrong {sum(t.wrong for t in tallies.values())}", flush=True)
    for row in rows:
        print("| " + " | ".join(str(value) for value in row.values()) + " |")
    sys.exit(1 if any(tally.wrong for tally in tallies.values()) else 0)


if __name__ == "__main__":
    main()
