"""Prints the times of the planar Hausdorff distance, beside the paper's ways and peers.

    python scripts/bench/hausdorff.py [--tables NAME ...] [--pairs N] [--sizes N ...] [--csv FILE]

Milliseconds of CPU, compiled code warm, for each pair the least of its repetitions; then the median and the worst
over the pairs. Curves are made outside the clock, biarcs and trees inside it unless said.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import Row, least_time

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, greater_of, hausdorff
from clearance.planar.systems import directed, directions, empty_state, paper, solved, whole

Curves = tuple[Curve, Curve]
Points = tuple[np.ndarray, np.ndarray]

SMALLEST = [
    "--pairs",
    "1",
    "--sizes",
    "5",
    "--tables",
    "splines",
    "untrimmed",
    "judged",
    "overlaps",
]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__, words, tables=[*TABLES], pairs=12, sizes=[5, 10, 15, 30, 100]
    )
    rows: list[Row] = []
    for name in asked.tables:
        found = [{"table": name, **row} for row in TABLES[name](asked.sizes, asked.pairs)]
        harness.show(TABLES[name].__doc__.split("\n")[0], found)
        rows += found
    harness.write_csv(rows, asked.csv)
    return rows


def walks(n: int, seed: int) -> Points:
    """Control points of two random walks."""
    random = np.random.default_rng(seed)
    one, two = (np.cumsum(random.normal(size=(n, 2)), axis=0) for _ in range(2))
    return one, two


def near(n: int, seed: int) -> Points:
    """Control points of a walk and of its copy, 2 % of a step off."""
    c, d = walks(n, seed)
    return c, c + 0.02 * np.random.default_rng(seed + 1000).normal(size=d.shape)


def waves(n: int, seed: int) -> Points:
    """Control points of two waves side by side, as in the paper's Fig. 18."""
    random = np.random.default_rng(seed)
    c = np.stack([np.arange(n) * 1.0, np.cumsum(random.normal(size=n))], axis=1)
    return c, c + [0.0, 0.3] + 0.8 * random.normal(size=(n, 2))


FAMILIES: dict[str, Callable[[int, int], Points]] = {
    "walks": walks,
    "waves": waves,
    "near copies": near,
}


def ms_of(call: Callable[[], object], repetitions: int = 9) -> float:
    """Least time of `call`, after one call to warm up."""
    call()
    return 1e3 * least_time(call, repetitions)[0]


def fresh(make: Callable[[], Curves], repetitions: int = 9) -> float:
    """As `ms_of`, for curves made anew outside the clock each time: biarcs and trees are inside it."""
    made = [make() for _ in range(repetitions + 1)]
    calls = [lambda pair=pair: hausdorff(*pair) for pair in made]
    return 1e3 * min(least_time(call, 1)[0] for call in calls[1:])


def splines_of(points: Points) -> Curves:
    """Clamped cubic B-splines."""
    return Curve.bspline(points[0]), Curve.bspline(points[1])


def times_of(ms: list[float]) -> Row:
    """The median and the worst."""
    return {"pairs": len(ms), "ms_median": float(np.median(ms)), "ms_worst": max(ms)}


def splines(sizes: list[int], n_pairs: int) -> Iterator[Row]:
    """Clamped cubic B-splines, biarcs and trees inside the clock."""
    for n in sizes:
        for name, make in FAMILIES.items():
            drawn = [make(n, seed) for seed in range(n_pairs)]
            found = [(hausdorff(*pair), pair[0].size) for pair in map(splines_of, drawn)]
            error = max(one.error_bound / size for one, size in found)
            times = [fresh(lambda points=points: splines_of(points)) for points in drawn]
            yield {
                "case": f"{n} control points, {name}",
                **times_of(times),
                "error_over_size": error,
            }


def untrimmed(sizes: list[int], n_pairs: int) -> Iterator[Row]:
    """Trimmed and by the paper, in parts of the systems on whole curves; curves prepared."""

    def slowly(a: Curve, b: Curve) -> Hausdorff:
        ways = directions(a, b)
        return greater_of(
            *(directed(w, solved(w, whole(w.one), whole(w.two), empty_state())) for w in ways)
        )

    for name in ("waves", "walks"):
        for n in (n for n in sizes if n <= 30):
            pairs = [splines_of(FAMILIES[name](n, seed)) for seed in range(n_pairs)]
            slow = np.array([ms_of(lambda p=p: slowly(*p), 3) for p in pairs])
            for method in ("trimmed", "paper"):
                times = [ms_of(lambda p=p, m=method: hausdorff(*p, method=m), 3) for p in pairs]
                gain = slow / times
                yield {
                    "case": f"{n} control points, {name}, {method}", **times_of(times),
                    "gain": float(np.median(gain)), "least": gain.min(), "greatest": gain.max(),
                }  # fmt: skip


def judged(sizes: list[int], n_pairs: int) -> Iterator[Row]:
    """The paper's answers: the greatest of all roots, and 4.3 with both curves trimmed."""
    for name in ("waves", "walks"):
        pairs = [
            splines_of(FAMILIES[name](n, seed)) for n in sizes if n <= 30 for seed in range(n_pairs)
        ]
        above, lost, worst, share = 0, 0, 1.0, 1.0
        for a, b in pairs:
            true, told, slack = hausdorff(a, b), hausdorff(a, b, method="paper"), 1e-9 * a.size
            least = max(one.lower for one in paper(a, b, literal=True))
            above += told.distance > true.distance + slack
            lost += least < true.lower - slack
            worst = max(worst, told.distance / true.distance)
            share = min(share, least / true.distance)
        yield {
            "case": name, "pairs": len(pairs), "above the truth": above, "at most, times": worst,
            "too small when both are trimmed": lost, "at least, times": share,
        }  # fmt: skip


def overlaps(sizes: list[int], n_pairs: int) -> Iterator[Row]:
    """Overlap and curves that nearly coincide under unlike parametrisations; curves prepared."""
    random = np.random.default_rng(1)
    c, turn = np.cumsum(random.normal(size=(30, 2)), axis=0), 2.0 * math.pi
    a, circle = Curve.bspline(c), Curve.circle([0, 0], 1)
    knots = np.concatenate([np.zeros(4), np.arange(1, 27) / 27.0, np.ones(4)])
    half = Curve.bezier([(1, 0), (1, 2), (-1, 2), (-1, 0)], [1, 1 / 3, 1 / 3, 1])
    cubic = [(0, 0), (1, 2), (2, -1), (3, 0)]
    cases = {
        "identical": (a, Curve.bspline(c), 0.0),
        "reversed": (a, Curve.bspline(c[::-1]), 0.0),
        "other parameter": (a, Curve.bspline(c, 3, 5.0 * knots + 2.0), 0.0),
        "part of it": (a, Curve.contours([a, Curve.bspline(c[:12])]), None),
        "1e-9 apart": (a, Curve.bspline(c + 1e-9 * random.normal(size=c.shape)), None),
        "concentric circles": (circle, Curve.arc([0, 0], 1.25, 0.3, 0.3 + turn), 0.25),
        "1e-9 apart circles": (circle, Curve.arc([0, 0], 1 + 1e-9, 0.3, 0.3 + turn), 1e-9),
        "offset lines": (Curve.line([0, 0], [1, 0]), Curve.line([0, 0.5], [1, 0.5]), 0.5),
        "rational semicircle, arc": (half, Curve.arc([0, 0], 1, 0, math.pi), 0.0),
        "weights 1 to 1e6": (
            Curve.bezier(cubic, [1, 1e2, 1e4, 1e6]),
            Curve.bezier(cubic),
            None,
        ),
    }
    for name, (one, two, known) in cases.items():
        found, size = hausdorff(one, two), max(one.size, two.size)
        error = (found.error_bound if known is None else abs(found.distance - known)) / size
        ms = ms_of(lambda one=one, two=two: hausdorff(one, two))
        yield {
            "case": name,
            "ms": ms,
            "error_over_size": float(error),
            "known": str(known is not None),
        }


def polylines(sizes: list[int], n_pairs: int) -> Iterator[Row]:
    """Polylines of 108,594 and 720 vertices, trees inside the clock; shapely beside."""
    import shapely

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
        make = lambda p=points, f=few: (Curve.polyline(p), Curve.polyline(f))  # noqa: E731
        ms, found = fresh(make), hausdorff(*make())
        one, two = shapely.LineString(points), shapely.LineString(few)
        peer, value = least_time(lambda one=one, two=two: one.hausdorff_distance(two), 1)
        yield {
            "case": name, "ms": ms, "shapely_ms": 1e3 * peer, "ratio": 1e3 * peer / ms,
            "shapely off by": value - found.distance,
        }  # fmt: skip


TABLES = {table.__name__: table for table in (splines, overlaps, untrimmed, judged, polylines)}

if __name__ == "__main__":
    main()
