"""The Hausdorff distance from the systems (11) to (13), on parts of curves: the paper's method.

Its answers are compared with those of the default method. Not for: that method (`hausdorff`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.kernels.curve.arc import EPS
from clearance.kernels.hausdorff.paper import draw_page, greatest_depth, paper_candidates
from clearance.kernels.hausdorff.state import SEARCH_STATE
from clearance.kernels.hausdorff.systems import solve_directed
from clearance.kernels.hausdorff.witness import witness_of
from clearance.planar.curve import Curve
from clearance.planar.directed import DirectedDistance, arrays_of, directed_of, placed
from clearance.tolerance import LAST_BITS

BUDGET = 4e5
"""Cells, pairs of cells and roots (40 cells each) of one direction after which the rest has its bound only."""

PAGE = 64
"""Pixels along the longer side of the paper's page, which names no number; of 32 to 256 the fastest."""


class Direction(NamedTuple):
    """One direction: the curve searched, the other, the step between their frames, and whether it is a to b."""

    one: Curve
    two: Curve
    shift: np.ndarray
    margin: float
    forward: bool


def directions(a: Curve, b: Curve) -> tuple[Direction, Direction]:
    """From a to b, and from b to a."""
    shift, size = placed(a, b)
    margin = a.rounding + b.rounding + LAST_BITS * size
    return Direction(a, b, shift, margin, True), Direction(b, a, -shift, margin, False)


def paper(
    a: Curve, b: Curve, *, literal: bool = False
) -> tuple[DirectedDistance, DirectedDistance]:
    """Both directed distances as Kim, Oh, Kim (2010) publish them: the greatest distance of *all* roots.

    That can be above the true distance, by roots that are no nearest points; `lower` and `upper` are proven of
    the true one. `literal`: the systems have only the trimmed parts of the other curve as well, as the paper's
    4.3 can be read; its answers can then be too small.
    """
    both = directions(a, b)
    trimmed = [_trimmed(direction) for direction in both]
    parts = [
        _parts(direction.one, remaining)
        for direction, (_, remaining) in zip(both, trimmed, strict=True)
    ]
    found = []
    for k, direction in enumerate(both):
        other = parts[1 - k] if literal else whole(direction.two)
        state, remaining = trimmed[k]
        state = solved(direction, parts[k], other, state)
        if (
            not remaining.all()
        ):  # trimmed parts are within the reach of (8) to (10) and both biarc errors
            worst = state["map_bound"] + direction.one.leaves.arcs[:, EPS].max()
            state["upper"] = np.maximum(state["upper"], worst)
        found.append(_published(direction, state))
    return found[0], found[1]


def empty_state() -> np.ndarray:
    """A SEARCH_STATE of nothing found, (1,)."""
    state = np.zeros(1, SEARCH_STATE)
    state["piece_a"], state["root"] = -1, -1.0
    return state


def whole(curve: Curve) -> np.ndarray:
    """All of a curve as parts (n, 3) piece, start, end."""
    n = np.arange(curve.n_pieces)
    return np.stack([n, np.zeros(len(n)), np.ones(len(n))], axis=1)


def _parts(curve: Curve, remaining: np.ndarray) -> np.ndarray:
    """The remaining arcs as parts (n, 3) piece, start, end; neighbours as one."""
    arcs, owner = curve.leaves.arcs[remaining, :2], curve.leaves.piece[remaining]
    if not len(arcs):
        return np.empty((0, 3))
    new = np.append(True, (owner[1:] != owner[:-1]) | (arcs[1:, 0] != arcs[:-1, 1]))
    last = np.append(new[1:], True)
    return np.stack([owner[new], arcs[new, 0], arcs[last, 1]], axis=1)


def _trimmed(direction: Direction) -> tuple[np.ndarray, np.ndarray]:
    """A state with the bound (2), and which arcs of the curve searched remain (n,)."""
    one, two, (shift_x, shift_y) = direction.one, direction.two, direction.shift
    low = np.minimum(one.box[0], two.box[0]) - two.origin
    span = np.maximum(one.box[1], two.box[1]) - two.origin - low
    pixel = float(span.max()) / PAGE
    columns, rows = (int(k) for k in np.ceil(span / pixel) + 1)
    x0, y0 = low - 0.5 * pixel
    page = draw_page(two.leaves, x0, y0, pixel, rows, columns)
    deepest = greatest_depth(one.pieces, one.leaves, shift_x, shift_y, page)
    bound = max(0.0, deepest - two.leaves.arcs[:, EPS].max() - np.sqrt(2.0) * pixel)
    remaining = paper_candidates(one.leaves, two.leaves, shift_x, shift_y, page, bound)
    state = empty_state()
    state["n_arcs"], state["n_kept"] = len(remaining), remaining.sum()
    state["n_pixels"], state["map_bound"] = page.depth.size, bound
    return state, remaining


def solved(
    direction: Direction, parts: np.ndarray, other: np.ndarray, state: np.ndarray
) -> np.ndarray:
    """`state` with the systems solved on parts (n, 3) of the curve searched and of the other.

    On overlapping curves, whose systems have no end of solutions, the budget ends the search; the bounds show it.
    """
    solve_directed(
        arrays_of(direction.one),
        parts,
        arrays_of(direction.two),
        other,
        direction.shift[0],
        direction.shift[1],
        BUDGET,
        state,
    )
    return state


def directed(direction: Direction, state: np.ndarray) -> DirectedDistance:
    """The distance of one direction, from what was found."""
    one, two = direction.one, direction.two
    points = witness_of(
        arrays_of(one), arrays_of(two), direction.shift[0], direction.shift[1], state
    )
    return directed_of(one, two, state[0], points, direction.margin, direction.forward)


def _published(direction: Direction, state: np.ndarray) -> DirectedDistance:
    """The greatest root as the answer, with what is proven of the true distance."""
    lower = float(state["lower"][0])
    upper = float(np.maximum(state["upper"], state["distance"])[0])
    if state["root"][0] >= 0.0:
        state["distance"] = state["root"]
        for place in ("piece_a", "at_a", "piece_b", "at_b"):
            state[place] = state[f"root_{place}"]
    found = directed(direction, state)
    return replace(found, lower=max(0.0, lower - direction.margin), upper=upper + direction.margin)
