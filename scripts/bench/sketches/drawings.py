"""Random drawings of lines, arcs, contacts and symmetry, at the origin and far from it."""

from __future__ import annotations

import numpy as np

from scripts.bench.sketches.slvs import slvs_drawing
from scripts.bench.sketches.table import Table, clocked, spread
from tests.sketch.drawn_randomly import drawing, tangencies


def drawings(table: Table, peers: bool) -> None:
    """120 random drawings of lines, arcs, contacts and symmetry, at the origin and far from it."""
    for sizes in (0.0, 1e4, 1e5, 1e8):
        solved, theirs, times, their_times, gaps = 0, 0, [], [], []
        for seed in range(120):
            d = drawing(seed)
            drawn = d.shaken(0.03, seed)
            shift = sizes * np.ptp(drawn, axis=0)
            s, p, _, _ = d.sketch(drawn, shift)
            taken, result = clocked(s.solve)
            times.append(taken)
            x = np.array([s.numbers(q.variable, 2) for q in p])
            size = float(np.ptp(x, axis=0).max())
            radii = [e.radius for e in s.entities.values() if e.what == "circle"]
            error = np.abs(d.equations(np.concatenate([x.ravel(), radii]))).max()
            solved += result.solved and error <= 1e-12 * size
            gaps.append(max(tangencies(d, x), default=0.0) / size)
            if peers:
                taken, done = slvs_drawing(d, drawn + shift)
                theirs += done
                their_times.append(taken)
        name = f"120 drawings of arcs and contacts, {sizes:.0e} sizes from the origin"
        text = f"{solved} solved, {spread(times)}, contacts to {max(gaps):.1e} of size"
        table.add(name, "clearance", "120, 1e-12", text)
        if peers:
            table.add(name, "slvs", "", f"{theirs} solved, {spread(their_times)}")
