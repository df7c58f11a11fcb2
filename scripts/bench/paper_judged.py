"""Prints the figures of `clearance/query/PAPER.md`: the first paper held against the oracle.

Run from the repository's root: `PYTHONPATH=. python scripts/bench/paper_judged.py [pairs] [poses]`.
Fixed seeds; times are medians of 15 after a warm-up, with the bodies prepared outside the clock.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator

import numpy as np

from clearance.errors import BadPolygon
from clearance.query.paper import distance_paper, polygon_distance_paper
from tests import oracle
from tests.made_cases import faces_of
from tests.oracle.certificates import polygon_distances_sq
from tests.query.paper_shapes import ball, box, pipe, pose, ring_body
from tests.strategies import FAMILIES, rotations

WRONG = 1e-9
"""[-] An answer counts as wrong when it is above the truth by more than this part of the size."""


def judge_families(n: int) -> None:
    """One line a family: share wrong, contacts missed, worst excess, passes."""
    print("family | pairs | wrong % | contacts missed | worst excess | <= 3 passes % | given up")
    for name, family in FAMILIES.items():
        excess, missed, contacts, passes, given_up = [], 0, 0, [], 0
        for p, q, true_sq in drawn(name, family, n):
            try:
                found = polygon_distance_paper(p, q)
            except BadPolygon:
                continue
            true = float(oracle.root(true_sq))
            size = max(np.ptp(p, axis=0).max(), np.ptp(q, axis=0).max())
            excess.append((found.distance - true) / size)
            contacts += true == 0
            missed += true == 0 and excess[-1] > WRONG
            passes.append(found.tally["passes"])
            given_up += found.tally["not_converged"]
        wrong, quick = np.array(excess) > WRONG, np.array(passes) <= 3
        print(
            f"{name} | {len(excess)} | {100 * wrong.mean():.1f} | {missed} of {contacts} | "
            f"{max(excess):.2g} | {100 * quick.mean():.1f} | {given_up}",
            flush=True,
        )


def drawn(name: str, family: Callable, n: int) -> Iterator[tuple]:
    """`n` pairs of a family with their exact squared distances; many-sided ones a tenth, ten a draw."""
    batches = [(11, n)] if name != "many_sided" else [(seed, 10) for seed in range(n // 100)]
    for seed, size in batches:
        ps, qs = family(np.random.default_rng(seed), size)
        for p, q, (true_sq, _) in zip(ps, qs, polygon_distances_sq(ps, qs), strict=True):
            yield p, q, true_sq


def judge_bodies(n: int) -> None:
    """One line a pair of bodies 1 mm apart: what rule 2, the iteration and both together lose."""
    cone = ring_body([0.3, 0.001], [-0.5, 0.5], 12)
    slab, needle = box(2, 1, 0.02), box(2, 0.02, 0.02)
    print(
        "bodies | poses | rule 2 alone % | iteration alone % | both % | nothing left | worst ratio"
    )
    for name, a, b in (
        ("cubes", box(1, 1, 1), box(1, 1, 1)),
        ("slabs", slab, slab),
        ("needles", needle, needle),
        ("slab and needle", slab, needle),
        ("cones", cone, cone),
        ("box and pipe", box(0.5, 0.4, 0.3), pipe(0.3, 0.35, 1.0)),
    ):
        random = np.random.default_rng(9)
        rows = np.array([judge_pose(a, b, near_pose(random, a, b)) for _ in range(n)])
        rows = rows[(rows[:, 0] > 1e-4) & (rows[:, 0] < 2e-3)]
        lost = 100 * (rows[:, 1:] > rows[:, :1] * (1 + 1e-6)).mean(axis=0)
        finite = rows[np.isfinite(rows[:, 3])]
        print(
            f"{name} | {len(rows)} | {lost[0]:.1f} | {lost[1]:.1f} | {lost[2]:.1f} | "
            f"{len(rows) - len(finite)} | {(finite[:, 3] / finite[:, 0]).max():.3g}"
        )


def near_pose(random: np.random.Generator, a, b) -> np.ndarray:
    """A random attitude and direction of approach, 1 mm before contact."""
    turn = rotations(random, 1)[0]
    toward = random.normal(size=3)
    toward /= np.linalg.norm(toward)
    aside = random.uniform(-0.4, 0.4, 3) * (1, 0.5, 0)
    reach = 3.0
    for _ in range(60):
        gap = distance_paper(
            a, b, None, pose(*(aside + reach * toward), turn), rule_2=False
        ).distance
        if gap <= 0.00101:
            break
        reach -= max(gap - 0.001, 1e-5) * 0.999
    return pose(*(aside + reach * toward), turn)


def judge_pose(a, b, world_from_b: np.ndarray) -> tuple[float, float, float, float]:
    """True distance; exact least over what rule 2 leaves; iteration without the rule; both."""
    world_b = b.vertices @ world_from_b[:3, :3].T + world_from_b[:3, 3]
    true_sq = oracle.polyhedron_distance_sq(
        a.vertices, faces_of(a), b.vertices, faces_of(b), None, world_from_b
    )
    return (
        float(oracle.root(true_sq)),
        least_of(a, b, world_b, left_by_rule_2(a, b, world_from_b)),
        distance_paper(a, b, None, world_from_b, rule_2=False).distance,
        distance_paper(a, b, None, world_from_b).distance,
    )


def left_by_rule_2(a, b, world_from_b: np.ndarray) -> np.ndarray:
    """(m, n) True for the face pairs that the rule keeps."""
    normals = b.normals @ world_from_b[:3, :3].T
    centres = b.centres @ world_from_b[:3, :3].T + world_from_b[:3, 3]
    between = centres[None] - a.centres[:, None]
    opposed = a.normals @ normals.T < 0
    before_a = np.einsum("ijk,ik->ij", between, a.normals) > 0
    return opposed & before_a & (np.einsum("ijk,jk->ij", between, normals) < 0)


def least_of(a, b, world_b: np.ndarray, kept: np.ndarray) -> float:
    """The exact least distance over the kept face pairs, infinite where there is none."""
    faces_a, faces_b, best = faces_of(a), faces_of(b), math.inf
    pairs = [(a.vertices[faces_a[i]], world_b[faces_b[j]]) for i, j in np.argwhere(kept)]
    for p, q in sorted(pairs, key=_centres_apart):
        reach = sum(np.linalg.norm(x - x.mean(axis=0), axis=1).max() for x in (p, q))
        if _centres_apart((p, q)) - reach < best:
            best = min(best, float(oracle.root(oracle.polygon_distance_sq(p, q))))
    return best


def _centres_apart(pair) -> float:
    return float(np.linalg.norm(pair[0].mean(axis=0) - pair[1].mean(axis=0)))


def judge_motions() -> None:
    """Box past box and box past pipe, the paper's two checks: passes and wrong steps."""
    for name, other in (
        ("box past box", box(0.6, 0.2, 0.5)),
        ("box past pipe", pipe(0.3, 0.35, 1)),
    ):
        totals, wrong, worst, n = {}, 0, 1.0, 0
        for seed in range(4):
            turn = rotations(np.random.default_rng(seed), 1)[0]
            for x in np.linspace(-2, 2, 100):
                at = pose(x, 0.3 * math.sin(3 * x), 0.9, turn)
                found = distance_paper(box(0.5, 0.4, 0.3), other, None, at)
                totals = {k: totals.get(k, 0) + v for k, v in found.tally.items()}
                true = judge_pose(box(0.5, 0.4, 0.3), other, at)[0]
                n, wrong = n + 1, wrong + (found.distance > true + 1e-9)
                worst = max(worst, found.distance / true)
        print(f"{name}: {n} steps, {wrong} wrong, worst ratio {worst:.3g}; {totals}")


def time_balls() -> None:
    """The paper's last figure: two convex bodies of about 200 polygons."""
    a, at = ball(), pose(2.2, 0.3, 0.4, rotations(np.random.default_rng(5), 1)[0])
    for options in ({}, {"tolerance": 0.5}, {"rule_2": False}):
        distance_paper(a, a, None, at, **options)
        times = []
        for _ in range(15):
            start = time.perf_counter()
            found = distance_paper(a, a, None, at, **options)
            times.append(time.perf_counter() - start)
        spread = f"{min(times) * 1e3:.3f} to {max(times) * 1e3:.3f}"
        print(f"{a.n_faces} polygons each {options}: {np.median(times) * 1e3:.3f} ms ({spread})")
        print(f"    of {found.tally['pairs']} pairs {found.tally['measured']} measured")


if __name__ == "__main__":
    judge_families(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
    judge_bodies(int(sys.argv[2]) if len(sys.argv) > 2 else 100)
    judge_motions()
    time_balls()
