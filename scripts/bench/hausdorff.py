"""Times of the planar Hausdorff distance beside targets, the paper and peers: `python scripts/bench/hausdorff.py`.

Milliseconds of CPU time of this one-threaded process, compiled code warm, for each pair the least of its
repetitions (machines are shared); then the median and the worst over the pairs. Curves are made outside the
clock, biarcs and trees inside it unless said. Writes `results/hausdorff.csv`, one row a line of the tables
printed; `--quick` takes fewer pairs and writes nothing. From the repository's root, with `PYTHONPATH=.`.
"""

from __future__ import annotations

import csv
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(
    0, str(Path(__file__).parents[2])
)  # so that it runs from the root without an installation

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, greater_of, hausdorff
from clearance.planar.steady import steady
from clearance.planar.systems import directed, directions, empty_state, paper, solved, whole
from tests.planar.unlike import CASES as UNLIKE

QUICK = "--quick" in sys.argv
RESULTS = Path(__file__).parent / "results" / "hausdorff.csv"
FIELDS = (
    "table", "case", "pairs", "ms_median", "ms_worst", "target", "peer", "peer_ms", "ratio_median",
    "ratio_least", "paper_ratio", "error_over_size", "note",
)  # fmt: skip
PAPER = {5: (2953, 146), 10: (10156, 1572), 15: (15502, 1306), 30: (35725, 2215)}
TARGET = {5: 0.3, 10: 0.8, 15: 1.5, 30: 4.0, 100: 15.0}
ROWS: list[dict] = []


def row(table, case, **values):
    """Prints one line and keeps it for the file."""
    ROWS.append({"table": table, "case": case, **values})
    shown = [
        f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
        for name, value in values.items()
    ]
    print(f"  {case:34s} " + "  ".join(shown), flush=True)


def ms_of(call) -> float:
    start = time.process_time_ns()
    call()
    return 1e-6 * (time.process_time_ns() - start)


def timed(call, repetitions=9) -> float:
    """Least time of `call`, after one call to warm up."""
    call()
    return min(ms_of(call) for _ in range(repetitions))


def fresh(make, repetitions=9) -> float:
    """As `timed`, for curves made anew outside the clock each time: biarcs and trees are inside it."""
    times = []
    for _ in range(repetitions + 1):
        a, b = make()
        times.append(ms_of(lambda a=a, b=b: hausdorff(a, b)))
    return min(times[1:])


def walks(n, seed):
    """Control points of two random walks."""
    random = np.random.default_rng(seed)
    return tuple(np.cumsum(random.normal(size=(n, 2)), axis=0) for _ in range(2))


def near(n, seed):
    """Control points of a walk and of its copy, 2 % of a step off."""
    c, d = walks(n, seed)
    return c, c + 0.02 * np.random.default_rng(seed + 1000).normal(size=d.shape)


def waves(n, seed):
    """Control points of two waves side by side, as in the paper's Fig. 18."""
    random = np.random.default_rng(seed)
    c = np.stack([np.arange(n) * 1.0, np.cumsum(random.normal(size=n))], axis=1)
    return c, c + [0.0, 0.3] + 0.8 * random.normal(size=(n, 2))


FAMILIES = {"walks": walks, "waves": waves, "near copies": near}


def splines():
    print("clamped cubic B-splines, biarcs and trees inside the clock")
    n_pairs = 4 if QUICK else 12
    for n, target in TARGET.items():
        for name, make in FAMILIES.items():
            times, errors = [], []
            for seed in range(n_pairs):
                c, d = make(n, seed)
                found = hausdorff(Curve.bspline(c), Curve.bspline(d))
                errors.append(found.error_bound / Curve.bspline(c).size)
                times.append(fresh(lambda c=c, d=d: (Curve.bspline(c), Curve.bspline(d))))
            row("splines", f"{n} control points, {name}", pairs=n_pairs, ms_median=float(np.median(times)),
                ms_worst=max(times), target=target, error_over_size=max(errors))  # fmt: skip


def untrimmed(a: Curve, b: Curve) -> Hausdorff:
    """The Hausdorff distance from the systems solved on whole curves."""
    both = [
        directed(way, solved(way, whole(way.one), whole(way.two), empty_state()))
        for way in directions(steady(a), steady(b))
    ]
    return greater_of(*both)


def against_untrimmed():
    print("against the systems on whole curves, curves prepared (the paper's Table 1 beside)")
    for name in ("waves", "walks"):
        for n, (theirs, trimmed_theirs) in PAPER.items():
            quick, published, slow = [], [], []
            for seed in range(3 if QUICK else 12):
                a, b = (Curve.bspline(c) for c in FAMILIES[name](n, seed))
                slow.append(timed(lambda a=a, b=b: untrimmed(a, b), 3))
                published.append(timed(lambda a=a, b=b: hausdorff(a, b, method="paper"), 3))
                quick.append(timed(lambda a=a, b=b: hausdorff(a, b)))
            for method, times in (("trimmed", quick), ("paper", published)):
                ratios = np.array(slow) / times
                row("untrimmed", f"{n} control points, {name}, {method}", pairs=len(ratios),
                    ms_median=float(np.median(times)), ms_worst=max(times), peer="untrimmed",
                    peer_ms=float(np.median(slow)), ratio_median=float(np.median(ratios)),
                    ratio_least=float(ratios.min()), paper_ratio=theirs / trimmed_theirs,
                    note=f"ratio at most {ratios.max():.3g}; paper {theirs} / {trimmed_theirs} ms")  # fmt: skip


def paper_judged():
    print("the paper's answers: the greatest of all roots, and 4.3 with both curves trimmed")
    for name in ("waves", "walks"):
        above, lost, worst, share, cut, n_pairs = 0, 0, 1.0, 1.0, 0, 0
        for n in PAPER:
            for seed in range(3 if QUICK else 12):
                a, b = (Curve.bspline(c) for c in FAMILIES[name](n, seed))
                true, published, slack = (
                    hausdorff(a, b),
                    hausdorff(a, b, method="paper"),
                    1e-9 * a.size,
                )
                least = max(one.lower for one in paper(a, b, literal=True))
                n_pairs += 1
                above += published.distance > true.distance + slack
                cut += published.lower < true.lower - slack
                lost += least < true.lower - slack
                worst, share = (
                    max(worst, published.distance / true.distance),
                    min(share, least / true.distance),
                )
        row("paper judged", name, pairs=n_pairs, note=f"above the truth {above}, at most {worst:.3g} x; "
            f"trimming took the truth {cut}; both curves trimmed: lost {lost}, least {share:.3g} x")  # fmt: skip


def unlike_parametrisations():
    print("curves that nearly coincide under unlike parametrisations, curves prepared")
    for name, make in UNLIKE.items():
        a, b = make()
        found, size = hausdorff(a, b), max(a.size, b.size)
        row("unlike", name, ms_median=timed(lambda a=a, b=b: hausdorff(a, b)), target=20.0,
            error_over_size=found.error_bound / size,
            note=f"distance {found.distance:.3e}, {found.tally.intervals} intervals")  # fmt: skip


def against_scipy():
    from scipy.spatial.distance import directed_hausdorff

    print("scipy directed_hausdorff, both directions, 10,000 samples of each curve")
    for name, make in FAMILIES.items():
        a, b = (Curve.bspline(c) for c in make(15, 1))
        u = np.linspace(0, 1, 10_000)
        p, q = a.point(u), b.point(u)

        def theirs(p=p, q=q):
            return max(directed_hausdorff(p, q)[0], directed_hausdorff(q, p)[0])

        ours, peer = timed(lambda a=a, b=b: hausdorff(a, b)), timed(theirs, 5)
        off = abs(theirs() - hausdorff(a, b).distance)
        row("scipy", f"15 control points, {name}", ms_median=ours, target="faster", peer="scipy", peer_ms=peer,
            ratio_median=peer / ours, note=f"scipy off by {off:.1e}")  # fmt: skip


def overlaps():
    print(
        "overlap, curves prepared; errors relative to size, target 1e-14 where the value is known"
    )
    random = np.random.default_rng(1)
    c, turn = np.cumsum(random.normal(size=(30, 2)), axis=0), 2.0 * math.pi
    a, circle = Curve.bspline(c), Curve.circle([0, 0], 1)
    knots = np.concatenate([np.zeros(4), np.arange(1, 27) / 27.0, np.ones(4)])
    cases = {
        "identical": (a, Curve.bspline(c), 0.0),
        "reversed": (a, Curve.bspline(c[::-1]), 0.0),
        "other parameter": (a, Curve.bspline(c, 3, 5.0 * knots + 2.0), 0.0),
        "part of it": (a, Curve.contours([a, Curve.bspline(c[:12])]), None),
        "1e-9 apart": (a, Curve.bspline(c + 1e-9 * random.normal(size=c.shape)), None),
        "concentric circles": (circle, Curve.arc([0, 0], 1.25, 0.3, 0.3 + turn), 0.25),
        "1e-9 apart circles": (circle, Curve.arc([0, 0], 1 + 1e-9, 0.3, 0.3 + turn), 1e-9),
        "offset lines": (Curve.line([0, 0], [1, 0]), Curve.line([0, 0.5], [1, 0.5]), 0.5),
    }
    for name, (one, two, known) in cases.items():
        found, size = hausdorff(one, two), max(one.size, two.size)
        error = (found.error_bound if known is None else abs(found.distance - known)) / size
        row("overlap", name, ms_median=timed(lambda one=one, two=two: hausdorff(one, two)), target=5.0,
            error_over_size=float(error), note="error bound" if known is None else "error")  # fmt: skip


def outlines():
    print("polylines of 108,594 and 720 vertices, trees inside the clock")
    random = np.random.default_rng(2)
    angle = np.linspace(0, 2 * math.pi, 108_595)[:-1]
    wave = sum(math.exp(-0.4 * k) * np.sin(k * angle + random.uniform(0, 6)) for k in range(2, 40))
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    noise = random.normal(size=angle.shape)
    cases = {
        "outline": (1 + 0.05 * wave + 1e-6 * noise)[:, None] * ring,
        "random walk": np.cumsum(random.normal(size=(108_594, 2)), axis=0),
        "noise of 30 steps": (1 + 0.05 * wave + 2e-3 * noise)[:, None] * ring,
    }
    for name, points in cases.items():
        few = points[np.linspace(0, len(points) - 1, 720).astype(int)]
        ms = fresh(lambda p=points, f=few: (Curve.polyline(p), Curve.polyline(f)))
        made = timed(lambda p=points, f=few: (Curve.polyline(p), Curve.polyline(f)))
        peer, value = _shapely(points, few)
        found = hausdorff(Curve.polyline(points), Curve.polyline(few))
        row("polylines", name, ms_median=ms, target=20.0, peer="shapely", peer_ms=peer, ratio_median=peer / ms,
            note=f"{made:.1f} ms to make both curves; shapely off by {value - found.distance:.1e}")  # fmt: skip


def _shapely(points, few) -> tuple[float, float]:
    import shapely

    one, two = shapely.LineString(points), shapely.LineString(few)
    start = time.process_time_ns()
    value = one.hausdorff_distance(two)
    return 1e-6 * (time.process_time_ns() - start), value


def map_memory():
    print("pixels of the map: larger curves, a larger page, longer curves")
    c, d = near(30, 1)
    for case, one, two in (
        ("as it is", c, d),
        ("10 x as large", 10 * c, 10 * d),
        ("1000 apart", c, d + 1000),
        ("8 x as long", *near(240, 1)),
    ):
        found = hausdorff(Curve.bspline(one), Curve.bspline(two))
        row("map", case, note=f"{found.tally.pixels} pixels")


def main():
    for table in (
        splines,
        overlaps,
        unlike_parametrisations,
        against_scipy,
        against_untrimmed,
        paper_judged,
        outlines,
        map_memory,
    ):
        table()
    if not QUICK:
        with RESULTS.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(
                {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in r.items()} for r in ROWS
            )


if __name__ == "__main__":
    main()
