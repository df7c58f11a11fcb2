"""Polygon pairs of every hostile family against rational arithmetic, ten thousand each: what is ever wrong.

    PYTHONPATH=. python scripts/bench/stress.py --cases 10000 --processes 2

Counts false and missed contacts and violated error bounds, the worst relative error, the median of bound over
error, and the share of pairs whose contact took exact arithmetic. Seeds are fixed; exits with 1 if anything is
wrong. The oracle takes 0.25 ms a pair of triangles and up to 70 ms a pair of 64-gons.
"""

import argparse
import multiprocessing
import sys
import time
from fractions import Fraction

import numpy as np

from clearance import polygon_distance
from tests import oracle
from tests.strategies import FAMILIES

BATCH = 50


def from_least_corner(polygon):
    n = len(polygon)
    first = min(range(n), key=lambda i: [tuple(polygon[(i + k) % n]) for k in range(n)])
    return np.roll(polygon, -first, axis=0)


def judge(task):
    """(false, missed, violated, worst relative error, ratios, exact decisions, pairs) of one batch."""
    name, seed, n = task
    counts, worst, ratios = np.zeros(5, dtype=int), 0.0, []
    for p, q in zip(*FAMILIES[name](np.random.default_rng([seed, 77]), n), strict=True):
        near = polygon_distance(p, q)
        sq = oracle.polygon_distance_sq(from_least_corner(p), from_least_corner(q))
        error = oracle.error(near.distance, sq)
        counts += (
            near.contact and sq != 0,
            not near.contact and sq == 0,
            error > Fraction(near.error_bound),
            near.tally["exact_decisions"],
            1,
        )
        if sq > Fraction(2) ** -900:
            worst = max(worst, float(error / oracle.root(sq)))
            if error:
                ratios.append(float(Fraction(near.error_bound) / error))
    return counts, worst, ratios


def family(name, n_cases, pool):
    """Prints one row and returns the number of wrong answers."""
    tasks = [(name, i, min(BATCH, n_cases - i * BATCH)) for i in range(-(-n_cases // BATCH))]
    counts, worst, ratios, start = np.zeros(5, dtype=int), 0.0, [], time.perf_counter()
    for i, (some, most, more) in enumerate(pool.imap_unordered(judge, tasks)):
        counts, worst = counts + some, max(worst, most)
        ratios.extend(more)
        if sys.stderr.isatty():
            print(f"\r{name} {i + 1}/{len(tasks)} batches", end="\r", file=sys.stderr)
    false, missed, violated, exact, n = counts
    ratio = np.median(ratios) if ratios else float("nan")
    seconds = time.perf_counter() - start
    print(
        f"| {name} | {n} | {false} | {missed} | {violated} | {worst:.1e} | {ratio:.3g} "
        f"| {100 * exact / n:.1f} | {seconds:.0f} |",
        flush=True,
    )
    return false + missed + violated


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=10000, help="pairs a family")
    parser.add_argument("--many-sided", type=int, default=None, help="pairs of that family")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("families", nargs="*", default=[], help="all if none is named")
    given = parser.parse_args()
    print("| family | pairs | false | missed | bound violated | worst relative error "
          "| median bound / error | exact % | s |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|---|")
    wrong = 0
    polygon_distance(np.eye(3), np.eye(3) + 1.0)  # compiled before the processes start
    with multiprocessing.get_context("fork").Pool(given.processes) as pool:
        for name in given.families or sorted(FAMILIES):
            n = given.many_sided if name == "many_sided" and given.many_sided else given.cases
            wrong += family(name, n, pool)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
