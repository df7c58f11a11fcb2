"""Irreducible clusters of points: no point can be peeled off, no three form a body."""

from __future__ import annotations

import numpy as np

from scripts.bench.sketches.slvs import slvs_solve
from scripts.bench.sketches.table import Table, clocked, relative, spread
from scripts.makers.point_sketches import irreducible, shaken, sketched


def irreducible_clusters(table: Table, seeds: int, peers: bool) -> None:
    """Irreducible clusters of 100 points drawn far off: how many are solved, and in what time."""
    if seeds == 0:
        return
    solved, times, worst, theirs, their_times = 0, [], 0.0, 0, []
    for seed in range(seeds):
        points, edges = irreducible(100, seed)
        drawn = shaken(points, 0.2, seed + 1000)
        s = sketched(points, drawn, edges)
        taken, result = clocked(s.solve)
        solved += result.solved
        worst = max(worst, relative(result)) if result.solved else worst
        times.append(taken)
        if peers and seed < 10:
            taken, done, _ = slvs_solve(points, drawn, edges)
            theirs += done
            their_times.append(taken)
    name = f"3-connected, n = 100, off by 20 %, {seeds} seeds"
    text = f"{solved} solved, {spread(times)}, 9 of 10 below {np.quantile(times, 0.9):.1f} ms"
    table.add(name, "clearance", "all, 30 ms", f"{text}, residual / size {worst:.1e}")
    if peers:
        table.add(name, "slvs", "", f"{theirs} of {min(seeds, 10)} solved, {spread(their_times)}")
