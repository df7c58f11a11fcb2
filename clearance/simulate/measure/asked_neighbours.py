"""Neighbours that are apart at home, asked about at configurations: warned of once where they meet.

The free positions of a joint are worked out once, so that a configuration within them costs a comparison.
Not for: runs (`neighbours`), nor joints of several degrees of freedom that a configuration gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.simulate.measure.neighbours import Neighbours, excused_neighbours
from clearance.tolerance import REACH
from clearance.world.case import Case
from clearance.world.notice import Notice


@dataclass(frozen=True, eq=False)
class _Watched:
    """A pair whose joint is the given column of a configuration, and from where to where it is free [rad or m]."""

    pair: Neighbours
    column: int
    free: tuple[float, float]

    def meets_at(self, given: np.ndarray) -> Notice | None:
        """A warning if the two meet at one of the configurations (n, k)."""
        positions = given[:, self.column]
        low, high = self.free
        outside = positions[(positions < low) | (positions > high)]
        return self.pair.meets_at(outside[:, None]) if len(outside) else None


class AskedNeighbours:
    """The neighbours of a case that are apart at home.

    Args:
        names: of the joints that a configuration gives, robot by robot.

    Attributes:
        at_rest: a warning on each pair whose joint no configuration gives, and that meets where it stays.
        free: (k, 2) from where to where each joint of a configuration is in no doubt [rad or m].
    """

    def __init__(self, case: Case, names: Sequence[tuple[str, ...]]) -> None:
        self.at_rest: list[Notice] = []
        self._n_columns = sum(map(len, names))
        self._watched: list[_Watched] = []
        first = 0
        for i, given in enumerate(names):
            for pair in excused_neighbours(case, i):
                if not pair.is_apart_at_home:
                    continue
                if not set(pair.joints) & set(given):
                    fixed = case.robots[i].fixed_positions
                    stays = np.array([[fixed.get(name, 0.0) for name in pair.joints]])
                    self.at_rest += [one] if (one := pair.meets_at(stays)) else []
                elif len(pair.joints) == 1:
                    column = first + given.index(pair.joints[0])
                    self._watched.append(_Watched(pair, column, pair.free_range()))
            first += len(given)
        self._set_free()

    def _set_free(self) -> None:
        self.free = np.tile([-REACH, REACH], (self._n_columns, 1))
        for one in self._watched:
            low, high = self.free[one.column]
            self.free[one.column] = max(low, one.free[0]), min(high, one.free[1])

    def meeting_at(self, given: np.ndarray) -> list[Notice]:
        """A warning on each pair that meets at one of the configurations (n, k); it is not watched any longer."""
        found = [(one, one.meets_at(given)) for one in self._watched]
        self._watched = [one for one, notice in found if notice is None]
        self._set_free()
        return [notice for _, notice in found if notice is not None]
