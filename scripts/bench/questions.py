"""What run time against error is measured on, with the truth: polygon pairs, body pairs, whole steps.

The truth of the first two is in `truths/`, written by exact arithmetic (`tests/golden/make_truths.py`); that of
steps are the shared cases' references, where the nearest obstacle is the very mesh that is measured. Seeds are
fixed; all is made outside the clock.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np
from inputs import Scene, Solid, scenes, solid

from clearance.crosscheck.triangles import TriangleSoup
from clearance.world.body import Body
from scripts.makers.body_pairs import body_pairs
from scripts.makers.polygon_pairs import FAMILIES, from_least_corner

TRUTHS = Path(__file__).parent / "truths"

N_POLYGONS, N_POSES, SEED = 60, 8, 5
"""Pairs and poses a family that the files hold."""


@dataclass(frozen=True, eq=False)
class Question:
    """Two bodies where they stand, and how far apart they are.

    Attributes:
        size: [m] the greatest extent of the two; errors are told in parts of it.
        exact: [m] to 40 digits.
    """

    family: str
    a: Solid
    b: Solid
    pose_a: np.ndarray
    pose_b: np.ndarray
    size: float
    exact: Decimal

    @property
    def truth(self) -> float:
        """[m]"""
        return float(self.exact)

    def error(self, answer: float) -> float:
        """|answer - truth| in parts of the size; below 0 is contact."""
        return float(abs(Decimal(max(0.0, float(answer))) - self.exact)) / self.size


def polygon_questions(n: int) -> list[Question]:
    """`n` pairs of each family, at most as many as the file holds; families in turn."""
    truths = {(row[0], int(row[1])): Decimal(row[2]) for row in _rows("polygons")}
    drawn = {
        name: list(zip(*family(np.random.default_rng(SEED), N_POLYGONS), strict=True))
        for name, family in FAMILIES.items()
    }
    return [
        _polygon_question(name, *pairs[i], truths[name, i])
        for i in range(min(n, N_POLYGONS))
        for name, pairs in drawn.items()
    ]


def _rows(name: str) -> list[list[str]]:
    with (TRUTHS / f"{name}.csv").open(encoding="utf-8") as lines:
        return list(csv.reader(lines))


def _polygon_question(family: str, p: np.ndarray, q: np.ndarray, exact: Decimal) -> Question:
    p, q = from_least_corner(p), from_least_corner(q)
    size = max(np.ptp(p, axis=0).max(), np.ptp(q, axis=0).max())
    a, b = fan("p", p), fan("q", q, stands=True)
    return Question(family, a, b, np.eye(4), np.eye(4), float(size), exact)


def fan(name: str, corners: np.ndarray, stands: bool = False) -> Solid:
    """A polygon as the peers take it; `shape` is missing, since ours takes the corners."""
    k = np.arange(1, len(corners) - 1)
    triangles = np.stack([np.zeros_like(k), k, k + 1], axis=1)
    open_soup = TriangleSoup(
        np.ascontiguousarray(corners), triangles, np.zeros(len(triangles)), np.empty((0, 3, 3))
    )
    return Solid(name, None, open_soup, None, stands)


def body_questions(n: int) -> Iterator[Question]:
    """`n` poses of each family of bodies, at most as many as the file holds, and two inside another."""
    rows = list(zip(body_pairs(N_POSES), _rows("bodies"), strict=True))
    n_families = (len(rows) - 2) // N_POSES
    for pair, row in [*rows[: n * n_families], *rows[-2:]]:
        pose = np.eye(4)
        pose[:3] = np.array(row[3:], dtype=float).reshape(3, 4)
        a, b = solid(Body("a", pair.a)), solid(Body("b", pair.b), stands=True)
        size = max(np.ptp(shape.bounds, axis=0).max() for shape in (pair.a, pair.b))
        yield Question(pair.family, a, b, np.eye(4), pose, float(size), Decimal(row[2]))


def step_sample(scene: Scene, n: int) -> np.ndarray:
    """At most `n` steps, evenly spread over those whose reference is exact."""
    exact = np.flatnonzero(scene.reference[1])
    return exact[np.unique(np.linspace(0, len(exact) - 1, n).round().astype(int))]


def step_scenes(names: Sequence[str]) -> list[Scene]:
    """The shared cases among `names`."""
    return [scene for scene in scenes(names) if scene.reference is not None]
