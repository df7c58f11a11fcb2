"""Pairs with one padding, asked about at any positions of all that moves. Not for: motions (`measure`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.kernels.motion.sweep_rows import PairRows, StepRows
from clearance.kernels.motion.tracked_scene import Scene
from clearance.record.measurement import SWEEP_COUNTERS
from clearance.simulate.measure.layout import lay_out
from clearance.world.case import Case
from clearance.world.pairs import Pair


class NearestAsked(NamedTuple):
    """The nearest pair at one position.

    Attributes:
        is_separate: False where its bodies touch. clearance: [m] less padding. place: of the pair in the checker.
        points: (2, 3) [m] witness points in the world.
    """

    is_separate: bool
    clearance: float
    place: int
    points: np.ndarray


class NearestOfMany(NamedTuple):
    """The same at n positions: (n,), (n,), (n,), (n, 2, 3)."""

    is_separate: np.ndarray
    clearances: np.ndarray
    places: np.ndarray
    points: np.ndarray


class AskedPairs:
    """Pairs of a case with one padding.

    Args:
        places: (p,) of each pair in the checker. padding: [m] by which clearances are less than distances.
        position: (1, columns) [rad or m] the positions that `at_position` asks about; its owner writes into it.
    """

    def __init__(
        self,
        case: Case,
        pairs: Sequence[Pair],
        places: np.ndarray,
        padding: float,
        position: np.ndarray,
    ) -> None:
        self._places, self._padding, self._position = places, padding, position
        self._layout = lay_out(case, pairs)
        self._is_in_world = self._layout.is_in_world
        no_rows = PairRows(
            np.empty((0, len(pairs))), np.empty(0), np.empty(0, np.int64), np.empty((0, 2, 3))
        )
        n_columns = position.shape[1]
        self._scene = Scene(self._layout.surface, self._layout.world, no_rows, n_columns)
        self._counts = np.empty(len(SWEEP_COUNTERS), dtype=np.int64)
        self._row = _rows(1)
        self._ask = self._scene.always_at(position, self._row, self._counts)

    def at_position(self) -> NearestAsked:
        """The nearest pair at the one position."""
        self._ask()
        row = self._row
        if not self._is_in_world:
            self._layout.to_world(self._position, row.pair, row.points)
        distance, place = row.clearance.item(), self._places[row.pair[0]]
        return NearestAsked(distance > 0.0, distance - self._padding, place, row.points[0].copy())

    def at(self, positions: np.ndarray) -> NearestOfMany:
        """The nearest pair at each of n positions (n, columns)."""
        rows = _rows(len(positions))
        self._scene.nearest_at(positions, rows, self._counts)
        self._layout.to_world(positions, rows.pair, rows.points)
        clearances = rows.clearance - self._padding
        places = self._places[rows.pair]
        return NearestOfMany(rows.clearance > 0.0, clearances, places, rows.points)


def nearest_of_many(found: Sequence[NearestOfMany]) -> NearestOfMany:
    """Row by row the nearest, contact first, the first of those alike."""
    first, *others = found
    for other in others:
        nearer = (first.is_separate & ~other.is_separate) | (
            (first.is_separate == other.is_separate) & (other.clearances < first.clearances)
        )
        pairs = zip(first, other, strict=True)
        first = NearestOfMany(*(_where(nearer, one, another) for one, another in pairs))
    return first


def _where(nearer: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.where(nearer.reshape(-1, *[1] * (one.ndim - 1)), other, one)


def _rows(n: int) -> StepRows:
    numbers, pair = np.empty((2, n)), np.empty(n, dtype=np.int64)
    return StepRows(
        numbers[0], numbers[1], pair, np.empty((n, 2), dtype=np.int64), np.empty((n, 2, 3))
    )
