"""What exactness costs: the polygon kernel against a plain one of the same structure, in one process and run.

    PYTHONPATH=. python scripts/bench/robust_cost.py [--out robust_cost.csv]

Plain: the same order, planes and search in doubles, its best distance and points; no refinement, no bound, no
decision about contact. Batches of random pairs by number of corners and of every family, calls in turn,
least and median nanoseconds a pair of both, ratio of the least ones (other work only adds), and the share of
pairs whose contact took exact arithmetic.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np

from clearance.compile.declared import Floats3
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import FRAMES_AT_REST
from clearance.kernels.features.bounds import SLACK
from clearance.kernels.features.face_pair import nearest_of_faces, nothing_yet
from clearance.kernels.search.polygon_pair import (
    PolygonPairAnswers,
    _comes_first,
    _empty_surface,
    _fill,
    _first_corner,
    _scale_of,
)
from clearance.query.distance import _measured
from tests.strategies import FAMILIES, anywhere

CORNERS = ((3, 3), (4, 3), (4, 4), (6, 6), (8, 8), (12, 12), (16, 16), (32, 32), (64, 64))


@kernel
def plain(ps: Floats3, qs: Floats3, answers: PolygonPairAnswers) -> None:
    """`nearest_polygons` without what makes it exact."""
    a_p, b_q = _empty_surface(ps.shape[1]), _empty_surface(qs.shape[1])
    _plain_each(ps, qs, lend(a_p), lend(b_q), answers)
    a_p.blunt[0] = b_q.blunt[0] = 0.0  # held until here


@inline
def _plain_each(ps, qs, a_p, b_q, answers):
    frames = FRAMES_AT_REST
    for k in range(ps.shape[0]):
        first_p, first_q = _first_corner(ps[k]), _first_corner(qs[k])
        in_order = _comes_first(ps[k], first_p, qs[k], first_q)
        origin = ps[k, first_p] if in_order else qs[k, first_q]
        scale, unscale = _scale_of(ps[k], qs[k], origin)
        reach = _fill(a_p, ps[k], first_p, origin, scale)
        reach += _fill(b_q, qs[k], first_q, origin, scale)
        a, b = a_p, b_q
        if not in_order:
            a, b = b_q, a_p
        near = nearest_of_faces(a, 0, b, 0, frames.m, 4.0 * SLACK * reach, nothing_yet(np.inf))
        answers.distance[k] = np.sqrt(near.best.gap_sq) * unscale
        for axis in range(3):
            answers.points[k, 0, axis] = near.best.p[axis] * unscale + origin[axis]
            answers.points[k, 1, axis] = near.best.q[axis] * unscale + origin[axis]


def timed(ps: np.ndarray, qs: np.ndarray, calls: int) -> dict:
    """Nanoseconds a pair of both, calls in turn."""
    k = len(ps)
    flags = np.empty(k, dtype=np.bool_), np.empty(k, dtype=np.bool_)
    answers = PolygonPairAnswers(np.empty(k), np.empty(k), np.empty((k, 2, 3)), *flags)
    spent: dict[str, list[float]] = {"exact": [], "plain": []}
    for _ in range(calls):
        for name, call in (
            ("exact", lambda: _measured(ps, qs)),
            ("plain", lambda: plain(ps, qs, answers)),
        ):
            start = time.perf_counter_ns()
            call()
            spent[name].append((time.perf_counter_ns() - start) / k)
    found = _measured(ps, qs)
    least = {name: min(times) for name, times in spent.items()}
    return {
        "plain_ns_least": round(least["plain"]),
        "exact_ns_least": round(least["exact"]),
        "ratio": round(least["exact"] / least["plain"], 2),
        "plain_ns_median": round(float(np.median(spent["plain"]))),
        "exact_ns_median": round(float(np.median(spent["exact"]))),
        "contacts_percent": round(100 * float(found.contact.mean()), 1),
        "exact_decisions_percent": round(100 * float(found.exact.mean()), 1),
    }


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="csv file")
    parser.add_argument("--calls", type=int, default=40)
    given = parser.parse_args()
    rows = []
    for n, m in CORNERS:
        pairs = anywhere(np.random.default_rng(3), 6000 // (n + m) ** 2 + 20, n, m)
        rows.append(
            {
                "input": f"{n} and {m} corners",
                **timed(*map(np.ascontiguousarray, pairs), given.calls),
            }
        )
        print(rows[-1], flush=True)
    for name, family in FAMILIES.items():
        if name != "many_sided":
            pairs = family(np.random.default_rng(3), 150)
            rows.append({"input": name, **timed(*map(np.ascontiguousarray, pairs), given.calls)})
            print(rows[-1], flush=True)
    ratios = [row["ratio"] for row in rows]
    print(
        f"median ratio by corners {np.median(ratios[: len(CORNERS)]):.2f}, of all {np.median(ratios):.2f}"
    )
    if given.out:
        with given.out.open("w", newline="", encoding="utf-8") as out:
            writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
