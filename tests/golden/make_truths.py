"""Writes `truths/*.csv`: `python -m tests.golden.make_truths`.

Exact distances of pairs of polygons and of bodies, to 40 digits: the benchmark of run time against error holds
all methods against them. Bodies stand beside where they are, a (3, 4) pose a row. A test holds the files to the
oracle.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path

import numpy as np

from scripts.makers.body_pairs import BodyPair, body_pairs, placed
from scripts.makers.polygon_pairs import FAMILIES, from_least_corner
from tests import oracle
from tests.made_cases import faces_of

TRUTHS = Path(__file__).parents[2] / "scripts" / "bench" / "truths"
DIGITS = 40
N_POLYGONS, N_POSES, SEED = 60, 8, 5


def main() -> None:
    """Writes both files."""
    TRUTHS.mkdir(exist_ok=True)
    for name, rows in (("polygons", polygon_rows()), ("bodies", body_rows())):
        with (TRUTHS / f"{name}.csv").open("w", newline="", encoding="utf-8") as out:
            csv.writer(out, lineterminator="\n").writerows(rows)


def polygon_rows() -> Iterator[tuple]:
    """Family, number, distance [m] of each pair."""
    for name, family in FAMILIES.items():
        pairs = zip(*family(np.random.default_rng(SEED), N_POLYGONS), strict=True)
        for i, (p, q) in enumerate(pairs):
            yield name, i, polygon_truth(p, q)


def polygon_truth(p: np.ndarray, q: np.ndarray) -> str:
    """The distance of two polygons."""
    return digits(oracle.polygon_distance_sq(from_least_corner(p), from_least_corner(q)))


def body_rows() -> Iterator[tuple]:
    """Family, number, distance [m] and the twelve numbers of `world_from_b` of each pair."""
    for i, pair in enumerate(body_pairs(N_POSES)):
        pose = placed(pair)
        yield pair.family, i, body_truth(pair, pose), *map(repr, pose[:3].ravel().tolist())


def body_truth(pair: BodyPair, world_from_b: np.ndarray) -> str:
    """The distance of two bodies; within a closed one it is 0."""
    a, b = pair.a, pair.b
    sq = oracle.solid_distance_sq(
        a.vertices, faces_of(a), b.vertices, faces_of(b), None, world_from_b,
        a.closed and a.oriented, b.closed and b.oriented,
    )  # fmt: skip
    return digits(sq)


def digits(sq: Fraction) -> str:
    """The root of a square, to so many digits."""
    root = Fraction(oracle.root(sq))
    with localcontext(prec=DIGITS):
        return str(Decimal(root.numerator) / Decimal(root.denominator))


if __name__ == "__main__":
    main()
