"""The Hausdorff distance without trimming: systems (11) to (13) on whole curves, the paper's baseline.

Kept as a check of another kind on the trimmed method and to measure what trimming gains. Not for: curves
that overlap, whose systems have no end of solutions; they are refused.
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadInput
from clearance.kernels.hausdorff_state import STATE
from clearance.kernels.hausdorff_systems import solve_directed
from clearance.planar.curve import Curve
from clearance.planar.directed import Directed, directed_of, placed
from clearance.tolerance import LAST_BITS

BUDGET = 150_000.0
"""Intervals of one direction after which the systems count as having no end of solutions."""


class Unresolved(BadInput):
    """Curves whose systems have no end of solutions, or roots too close to tell apart."""


def untrimmed(a: Curve, b: Curve) -> tuple[Directed, Directed]:
    """Both directed distances of `a` and `b`, each the greatest distance over all roots of the systems.

    Raises: Unresolved where a root could not be isolated, e.g. on overlapping curves.
    """
    shift, size = placed(a, b)
    margin = a.rounding + b.rounding + LAST_BITS * size
    forth = _one_way(a, b, shift, margin, True)
    return forth, _one_way(b, a, -shift, margin, False)


def _one_way(one: Curve, two: Curve, shift: np.ndarray, margin: float, forward: bool) -> Directed:
    state, points = np.empty(STATE), np.empty(5)
    done = solve_directed(
        one.pieces, one.is_end, two.pieces, two.leaves, two.is_end, shift[0], shift[1], BUDGET, state,
        points,
    )  # fmt: skip
    if not done:
        raise Unresolved(
            "systems with more solutions than can be told apart",
            where="a, b",
            valid="curves that do not overlap, or method='trimmed'",
        )
    return directed_of(one, two, state.tolist(), points, margin, forward)
