"""Where the search for a fitted sketch starts: as drawn, brought to the outline, and the same shaken.

Always the same for the same input. Not for: the search.
"""

from __future__ import annotations

import numpy as np

from clearance.profiles.fit_shape import SketchShape
from clearance.profiles.outline_file import DrawnOutline


def starts_of(shape: SketchShape, outline: DrawnOutline, mode: str, count: int) -> list[np.ndarray]:
    """As drawn; scaled and shifted to the outline's box; then the same shaken, always alike."""
    first = shape.start
    found = [first]
    here = shape.at(first)
    if here is None:
        return found
    own, other = here.curve.box, outline.curve.box
    scale = float(np.min((other[1] - other[0]) / (own[1] - own[0]))) if mode != "inside" else 1.0
    moved = first.copy()
    for i, kind in enumerate(shape.kinds):
        if kind not in ("angle", "ratio", "parameter"):
            moved[i] = first[i] * scale
    moved = _centred(shape, moved, other) if mode != "inside" else moved
    if mode != "inside":
        found.append(moved)
    rng = np.random.default_rng(0)
    while len(found) < count:
        source = found[0] if len(found) % 2 or mode == "inside" else moved
        shaken = source.copy()
        n = len(shape.free)
        shaken[:n] *= rng.uniform(0.6, 1.4, n)
        if shape.slides:
            shaken[n : n + 2] += 0.1 * shape.size * rng.uniform(-1.0, 1.0, 2)
        if shape.turns:
            shaken[-1] += 0.5 * np.pi * rng.integers(0, 4) + rng.uniform(-0.3, 0.3)
        found.append(shaken)
    return found[: max(1, count)]


def _centred(shape: SketchShape, numbers: np.ndarray, box: np.ndarray) -> np.ndarray:
    """The numbers with the shape's box centred on another, where it may slide."""
    here = shape.at(numbers) if shape.slides else None
    if here is None:
        return numbers
    n = len(shape.free)
    moved = numbers.copy()
    moved[n : n + 2] += box.mean(axis=0) - here.curve.box.mean(axis=0)
    return moved
