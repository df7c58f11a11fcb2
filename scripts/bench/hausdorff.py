"""Times of the planar Hausdorff distance beside the targets and peers: `python scripts/bench/hausdorff.py`.

One core, compiled code warm, medians of repetitions, input made outside the clock unless said. Prints one
table for each claim; with `--quick` fewer repetitions.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff
from clearance.planar.systems import Unresolved

QUICK = "--quick" in sys.argv
PAPER = {5: (2953, 146), 10: (10156, 1572), 15: (15502, 1306), 30: (35725, 2215)}
TARGET = {5: 0.3, 10: 0.8, 15: 1.5, 30: 4.0, 100: 15.0}


def timed(call, repetitions):
    """Median and greatest time [ms] of `call`, after one call to warm up."""
    call()
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        call()
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times)), max(times)


def fresh_timed(make, repetitions):
    """As `timed`, for curves made anew outside the clock each time: biarcs and trees are inside it."""
    times = []
    for _ in range(repetitions + 1):
        a, b = make()
        start = time.perf_counter()
        hausdorff(a, b)
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times[1:])), max(times[1:])


def pairs(n, seed):
    """Control points of a far pair (two walks) and of a near pair (a walk and its copy, 2 % of a step off)."""
    rng = np.random.default_rng(seed)
    c, d = (np.cumsum(rng.normal(size=(n, 2)), axis=0) for _ in range(2))
    return {"far": (c, d), "near": (c, c + 0.02 * rng.normal(size=(n, 2)))}


def splines():
    print(
        "clamped cubic B-splines [ms]: median and worst pair of 10; fresh = biarcs and trees inside the clock"
    )
    print(
        "  n    pair   prepared  fresh    worst fresh  target  worst error_bound/size  largest kind counts"
    )
    for n in TARGET:
        for name in ("far", "near"):
            prepared, fresh, errors, kinds = [], [], [], {}
            for seed in range(10):
                c, d = pairs(n, seed)[name]
                a, b = Curve.bspline(c), Curve.bspline(d)
                found = hausdorff(a, b)
                errors.append(found.error_bound / max(a.size, b.size))
                kinds[found.kind] = kinds.get(found.kind, 0) + 1
                prepared.append(timed(lambda a=a, b=b: hausdorff(a, b), 5)[0])
                fresh.append(
                    fresh_timed(lambda c=c, d=d: (Curve.bspline(c), Curve.bspline(d)), 5)[0]
                )
            print(
                f"  {n:3d}  {name:4s}  {np.median(prepared):8.3f}  {np.median(fresh):7.3f}  {max(fresh):10.3f}"
                f"  {TARGET[n]:8.1f}  {max(errors):10.1e}  {kinds}"
            )


def against_untrimmed():
    print("trimmed against untrimmed [ms], median over pairs (paper's Table 1 beside; its ratio)")
    for n, (theirs, trimmed_theirs) in PAPER.items():
        ratios, slow, quick, unresolved = [], [], [], 0
        for seed in range(3 if QUICK else 6):
            c, d = pairs(n, seed)["far"]
            a, b = Curve.bspline(c), Curve.bspline(d)
            fast = timed(lambda a=a, b=b: hausdorff(a, b), 5)[0]
            try:
                start = time.perf_counter()
                other = hausdorff(a, b, method="untrimmed")
                full = 1e3 * (time.perf_counter() - start)
            except Unresolved:
                unresolved += 1
                continue
            assert abs(other.distance - hausdorff(a, b).distance) <= 1e-12 * a.size
            slow.append(full)
            quick.append(fast)
            ratios.append(full / fast)
        print(
            f"  {n:3d}  untrimmed {np.median(slow):9.2f}  trimmed {np.median(quick):7.3f}  ratio"
            f" {np.median(ratios):7.0f} (least {min(ratios):.0f})  unresolved {unresolved}"
            f"   paper {theirs} / {trimmed_theirs} = {theirs / trimmed_theirs:.1f}"
        )


def against_scipy():
    from scipy.spatial.distance import directed_hausdorff

    c, d = pairs(15, 1)["far"]
    a, b = Curve.bspline(c), Curve.bspline(d)
    u = np.linspace(0, 1, 10_000)
    p, q = a.point(u), b.point(u)
    theirs = timed(lambda: max(directed_hausdorff(p, q)[0], directed_hausdorff(q, p)[0]), 3)[0]
    value = max(directed_hausdorff(p, q)[0], directed_hausdorff(q, p)[0])
    ours = timed(lambda: hausdorff(a, b), 9)[0]
    print(f"scipy directed_hausdorff on 2 x 10,000 samples: {theirs:.2f} ms, off by"
          f" {abs(value - hausdorff(a, b).distance):.1e}; ours {ours:.3f} ms, {theirs / ours:.0f} x")  # fmt: skip


def overlaps():
    rng = np.random.default_rng(1)
    c = np.cumsum(rng.normal(size=(30, 2)), axis=0)
    a, turn = Curve.bspline(c), 2.0 * math.pi
    cases = {
        "identical": (a, Curve.bspline(c), 0.0),
        "reversed": (a, Curve.bspline(c[::-1]), 0.0),
        "1e-9 apart splines": (a, Curve.bspline(c + 1e-9 * rng.normal(size=c.shape)), None),
        "concentric circles": (
            Curve.circle([0, 0], 1),
            Curve.arc([0, 0], 1.25, 0.3, 0.3 + turn),
            0.25,
        ),
        "1e-9 apart circles": (
            Curve.circle([0, 0], 1),
            Curve.arc([0, 0], 1 + 1e-9, 0.3, 0.3 + turn),
            1e-9,
        ),
        "offset lines": (Curve.line([0, 0], [1, 0]), Curve.line([0, 0.5], [1, 0.5]), 0.5),
    }
    print("overlap [ms], target 5; error and bound relative to size, target 1e-14")
    for name, (one, two, known) in cases.items():
        found = hausdorff(one, two)
        size = max(one.size, two.size)
        error = "-" if known is None else f"{abs(found.distance - known) / size:.1e}"
        ms = timed(lambda one=one, two=two: hausdorff(one, two), 9)[0]
        print(f"  {name:20s} {ms:7.3f}  error {error}  bound {found.error_bound / size:.1e}")


def outlines():
    print(
        "polylines of 108,594 and 720 vertices [ms], target 20; prepared = biarcs and trees made before"
    )
    rng = np.random.default_rng(2)
    angle = np.linspace(0, 2 * math.pi, 108_595)[:-1]
    waves = sum(math.exp(-0.4 * k) * np.sin(k * angle + rng.uniform(0, 6)) for k in range(2, 40))
    radius = 1 + 0.05 * waves + 1e-6 * rng.normal(size=angle.shape)
    smooth = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    walk = np.cumsum(rng.normal(size=(108_594, 2)), axis=0)
    rough = (1 + 0.05 * waves + 2e-3 * rng.normal(size=angle.shape))[:, None] * np.stack(
        [np.cos(angle), np.sin(angle)], axis=1
    )
    for name, points in (
        ("outline", smooth),
        ("random walk", walk),
        ("noise 30 x the step", rough),
    ):
        few = points[np.linspace(0, len(points) - 1, 720).astype(int)]
        a, b = Curve.polyline(points), Curve.polyline(few)
        ms, worst = timed(lambda a=a, b=b: hausdorff(a, b), 5)
        fresh = fresh_timed(lambda p=points, f=few: (Curve.polyline(p), Curve.polyline(f)), 3)[0]
        found = hausdorff(a, b)
        kept = found.tally.arcs - found.tally.trimmed_arcs
        print(
            f"  {name:20s} prepared {ms:8.2f} (worst {worst:.2f})  fresh {fresh:8.2f}"
            f"  kept {kept} of {found.tally.arcs}  {_shapely(points, few)}"
        )


def _shapely(points, few):
    try:
        import shapely
    except ImportError:
        return "shapely not installed"
    if QUICK:
        return ""
    one, two = shapely.LineString(points), shapely.LineString(few)
    start = time.perf_counter()
    value = one.hausdorff_distance(two)
    return f"shapely {1e3 * (time.perf_counter() - start):.0f} ms -> {value:.9g}"


def map_memory():
    print(
        "pixels of the map: a page ten times as large with the same curves ten times as large, and far apart"
    )
    c, d = pairs(30, 1)["near"]
    for scale, apart in ((1, 0), (10, 0), (1, 1000)):
        found = hausdorff(Curve.bspline(c * scale), Curve.bspline(d * scale + apart))
        print(f"  scale {scale:3d}, {apart:4d} apart: {found.tally.pixels} pixels")


if __name__ == "__main__":
    for table in (splines, overlaps, against_scipy, against_untrimmed, outlines, map_memory):
        table()
        sys.stdout.flush()
