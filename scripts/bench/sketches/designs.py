"""Sketches as designers draw them: a section of a ship, a bar in a box, many rectangles, one wrong dimension."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from clearance.sketch import Sketch
from scripts.bench.sketches.table import Table, clocked, relative, spread, timed
from scripts.makers.point_sketches import patch

SKETCHES = Path(__file__).parents[3] / "scenes" / "sketches"


def midship(table: Table) -> None:
    """The first solve of a section of a ship, and the solve after one dimension changed."""
    times, result = timed(lambda: Sketch.load(SKETCHES / "midship_e.yaml"))
    text = f"{spread(times)}, {result.status}, residual / size {relative(result):.1e}"
    table.add("midship section: first solve", "clearance", "50 ms", text)
    s, times = Sketch.load(SKETCHES / "midship_e.yaml"), []
    s.solve()
    for k in range(20):
        s.set("t", 11.0 + 0.01 * k)
        taken, result = clocked(s.solve)
        assert result.solved
        times.append(taken)
    table.add("midship section: change of one dimension", "clearance", "", spread(times))


def bars(table: Table) -> None:
    """The bar in the box, its length free, drawn in 60 places."""
    solved, lengths = 0, set()
    for seed in range(60):
        random, s = np.random.default_rng(seed), Sketch.load(SKETCHES / "bar_length.yaml")
        turn, middle = random.uniform(0.2, 1.2), np.array([5.0, 3.0]) + random.uniform(-1, 1, 2)
        d = np.array([math.cos(turn), math.sin(turn)])
        m = np.array([-d[1], d[0]])
        for k, (u, v) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
            at = s.entity(f"P{k}").variable
            s._lists.numbers[at : at + 2] = (middle + 4.5 * u * d + 0.5 * v * m - s.origin).tolist()
        result = s.solve()
        solved += result.solved
        lengths.add(round(s.value("length"), 4))
    text = f"{solved}, lengths {', '.join(map(str, sorted(lengths)))}"
    table.add("bar in the box from 60 starts", "clearance", "60", text)


def conflict(table: Table) -> None:
    """The time to name the constraints that one wrong dimension contradicts."""
    for span, factor in ((4, 1.1), (8, 1.1), (8, 0.9)):
        s, points, edges = patch(300, 0.05, 1)
        present = {tuple(sorted(e)) for e in edges}
        a, b = next(
            (a, b)
            for a in range(120, 300)
            for b in range(a + 1, 300)
            if span - 1 < np.linalg.norm(points[a] - points[b]) < span and (a, b) not in present
        )
        p = list(s.entities.values())
        s.distance(p[a], p[b], factor * float(np.linalg.norm(points[a] - points[b])), name="wrong")
        s.solve().conflicts  # noqa: B018 - warm
        times = []
        for _ in range(5):
            taken, names = clocked(lambda s=s: s.solve().conflicts)
            times.append(taken)
        name = f"one dimension {factor} x over {span} edges, n = 300"
        table.add(name, "clearance", "100 ms", f"{spread(times)}, {len(names)} named")


def rectangles() -> Sketch:
    """1000 rectangles of their own: four points, four segments, three right angles, two sides."""
    s, random = Sketch(), np.random.default_rng(0)
    for k in range(1000):
        corners = np.array([[0, 0], [2, 0], [2, 1], [0, 1]]) + 3.0 * np.array([k % 32, k // 32])
        p = [s.point(*q) for q in corners + random.uniform(-0.1, 0.1, (4, 2))]
        sides = [s.segment(p[i], p[(i + 1) % 4]) for i in range(4)]
        for i in range(3):
            s.perpendicular(sides[i], sides[i + 1])
        s.distance(p[0], p[1], 2.0), s.distance(p[1], p[2], 1.0)
    return s


def separate_rectangles(table: Table) -> None:
    """Many small parts: what a solve costs beside its equations."""
    times, result = timed(rectangles, 5)
    text = f"{spread(times)}, residual / size {relative(result):.1e}"
    table.add("1000 separate rectangles", "clearance", "", text)
