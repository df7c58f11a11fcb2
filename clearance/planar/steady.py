"""Curves of extreme weights for the searches: the same points under a parameter that floats can follow.

Between weights 1 and 1e30 a piece runs through half its length within 1e-30 of its parameter, nearer to an end
than floats lie. Weights w_i may be scaled by lambda^i without moving a point: so both ends get the same weight,
and where those between still stand out the piece is halved, which reduces their ratio to its square root.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.planar.assembly import assembled
from clearance.planar.curve import Curve
from clearance.planar.curve_facts import halved
from clearance.tolerance import WEIGHTS

HALVINGS = 12
"""Halvings: each reduces the ratio of weights to its square root; 1e300 is below 2 after ten."""


@dataclass(frozen=True, eq=False)
class SteadyCurve(Curve):
    """A curve with even weights; parameters are reported as those of the curve it stands for.

    Attributes:
        given: that curve.
        piece_of: (n,) its piece that each piece here is a part of.
        maps: (n, 2, 2) M of each, from (1 - u, u) here to multiples of the same there; no entry is negative, so
            that no digit is lost.
    """

    given: Curve
    piece_of: np.ndarray
    maps: np.ndarray

    @property
    def rounding(self) -> float:
        """As for any curve, and `HALVINGS` more passes."""
        return (1.0 + 0.25 * HALVINGS) * super().rounding

    def parameter_of(self, piece: int, local: float) -> float:
        """The given curve's parameter; nearer to an end than floats lie it is that end."""
        rest, share = (self.maps[piece] @ (1.0 - local, local)).tolist()
        return self.given.parameter_of(int(self.piece_of[piece]), share / (rest + share))


def steady(curve: Curve) -> Curve:
    """The curve itself, or where its weights are extreme its `SteadyCurve`, made once."""
    if not isinstance(curve, Curve) or not curve.pieces.rational.any():
        return curve
    if "_steady" not in curve.__dict__:
        curve.__dict__["_steady"] = _steadied(curve) if _is_extreme(curve) else curve
    return curve.__dict__["_steady"]


def _is_extreme(curve: Curve) -> bool:
    weight, first = curve.pieces.control[:, 2], curve.pieces.first[:-1]
    most, least = (extreme.reduceat(weight, first) for extreme in (np.maximum, np.minimum))
    return bool((most > WEIGHTS * least).any())


def _steadied(curve: Curve) -> Curve:
    first, rows, owner, maps = curve.pieces.first, [], [], []
    for i in range(curve.n_pieces):
        for part, matrix in _even(
            curve.pieces.control[first[i] : first[i + 1]], np.eye(2), HALVINGS
        ):
            flat = part / part[:, 2:]
            if not (flat[:, :2] == flat[0, :2]).all():
                flat[:, 2] = part[:, 2] / part[:, 2].max()
                rows.append(flat)
                owner.append(i)
                maps.append(matrix)
    sizes = np.concatenate([[0], np.cumsum([len(row) for row in rows])])
    place = np.arange(len(rows), dtype=float)
    made = assembled(
        np.concatenate(rows),
        sizes,
        np.stack([place, place + 1.0], axis=1),
        curve.contour[owner],
        curve.origin,
    )
    return SteadyCurve(*made, curve, np.array(owner), np.array(maps))


def _even(rows: np.ndarray, matrix: np.ndarray, halvings: int):
    """The parts of a homogeneous control polygon with even weights, in order, and where each is on the piece."""
    n = len(rows) - 1
    rows = rows / rows[0, 2]
    step = rows[-1, 2] ** (-1.0 / n)
    rows = rows * step ** np.arange(n + 1)[:, None]
    matrix = matrix @ np.diag([1.0, step])
    if halvings == 0 or rows[:, 2].max() <= WEIGHTS * rows[:, 2].min():
        return [(rows, matrix)]
    left, right = (half[0] for half in halved(rows[None]))
    return [
        *_even(left, matrix @ np.array([[1.0, 0.5], [0.0, 0.5]]), halvings - 1),
        *_even(right, matrix @ np.array([[0.5, 0.0], [0.5, 1.0]]), halvings - 1),
    ]
