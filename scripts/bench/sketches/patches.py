"""Patches of triangles, whole and with slivers: time, growth, and whether any triangle is flipped."""

from __future__ import annotations

import math

import numpy as np

from scripts.bench.sketches.slvs import slvs_solve
from scripts.bench.sketches.table import Table, clocked, relative, spread, timed
from scripts.makers.point_sketches import (
    constructed,
    flipped,
    patch,
    shaken,
    sketched,
    slivered,
)


def patches(table: Table, peers: bool) -> None:
    """Triangulated patches of 100 to 10,000 points, and how the time grows."""
    medians = {}
    for n, target in ((100, "30 ms"), (300, "100 ms"), (1000, "500 ms"), (10000, "")):
        name = f"triangulated patch, n = {n}, off by 5 %"
        times, result = timed(lambda n=n: patch(n, 0.05, 1)[0])
        medians[n] = float(np.median(times))
        text = f"{spread(times)}, residual / size {relative(result):.1e}"
        table.add(name, "clearance", target, text)
        if peers and n <= 300:
            _, points, edges = patch(n, 0.05, 1)
            taken, done, _ = slvs_solve(points, shaken(points, 0.05, 2), edges)
            table.add(name, "slvs", "", f"{taken:.1f} ms, {'solved' if done else 'failed'}")
    growth = medians[10000] / medians[1000]
    table.add("growth from n = 1000 to 10,000", "clearance", "13.3 (n log n)", f"{growth:.1f}")
    turned(table, peers)


def turned(table: Table, peers: bool) -> None:
    """Patches drawn far off: how many are solved, how many triangles come out flipped."""
    name, solved, flips, theirs, their_flips = (
        "the same, n = 100, off by 20 %, 10 seeds",
        0,
        0,
        0,
        0,
    )
    for seed in range(10):
        s, points, edges = patch(100, 0.2, seed)
        solved += s.solve().solved
        flips += flipped(s, points, edges)
        if peers:
            _, done, x = slvs_solve(points, shaken(points, 0.2, seed + 1), edges)
            theirs += done
            their_flips += flipped(sketched(points, x, edges), points, edges) if done else 0
    table.add(name, "clearance", "10, 0 flipped", f"{solved} solved, {flips} flipped")
    if peers:
        table.add(name, "slvs", "", f"{theirs} solved, {their_flips} flipped")


def slivers(table: Table, seeds: int = 20) -> None:
    """Patches of Delaunay triangles, some of whose slivers are drawn the wrong way round."""
    for n in (100, 300, 1000):
        times, worst, solved = [], 0.0, 0
        for seed in range(seeds):
            s, points, edges = slivered(n, 0.05, seed)
            taken, result = clocked(s.solve)
            times.append(taken)
            if result.solved:
                x = np.array([e.position for e in s.entities.values()])
                a, b = np.array(edges).T
                apart = np.linalg.norm(x[a] - x[b], axis=1)
                error = np.abs(apart - np.linalg.norm(points[a] - points[b], axis=1)).max()
                worst, solved = max(worst, error / np.abs(x).max()), solved + 1
        name = f"Delaunay triangles, n = {n}, off by 5 %, {seeds} seeds"
        text = f"{solved} solved, {spread(times)}, error / size {worst:.1e}"
        table.add(name, "clearance", f"{0.95 * seeds:.0f} solved", text)


def constructions(table: Table, seeds: int = 20) -> None:
    """Random constructions: each point at distances from two before it, drawn off by 5 % of the points' spacing or
    of the mean distance; how many are solved within the default effort, and whether any takes longer."""
    for n, share in ((100, 0.95), (300, 0.9), (1000, 0.7)):
        far = 0.52 * math.sqrt(n)  # the mean distance of two points in a square of n
        kinds = (
            ("two of the 6 nearest", 0.05, 6),
            ("any two", 0.05, None),
            ("any two, far off", 0.05 * far, None),
        )
        for what, off, near in kinds:
            times, solved = [], 0
            for seed in range(seeds):
                s = constructed(n, off, seed, near)[0]
                taken, result = clocked(s.solve)
                times.append(taken)
                solved += result.solved
            name = f"constructions on {what}, n = {n}, {seeds} seeds"
            over = max(0.0, max(times) / (1e3 * s.most_seconds) - 1.0)
            text = f"{solved} solved, {spread(times)}, {over:.1%} beyond its effort"
            table.add(name, "clearance", f"{share * seeds:.0f} solved", text)
