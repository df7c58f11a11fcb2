"""What no change of a kind can mend: a pair at a step that falls short, and that nothing of it moves.

Not for: what is too far to reach (`unreachable`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.gains.shortfalls import Gradient, State
from clearance.simulate.approaches import Approach


@dataclass(frozen=True)
class Blocked:
    """A pair that stays too near.

    Attributes:
        body_a, body_b: names, as in tables. time: [s]. clearance: [m] less padding and depth. wanted: [m].
        moves: whether the change moves either body against the other at another time, so that what is kept still
            is at fault.
    """

    body_a: str
    body_b: str
    time: float
    clearance: float
    wanted: float
    moves: bool

    def __str__(self) -> str:
        told = f"{self.body_a} and {self.body_b} are {self.clearance * 1e3:.2f} mm apart at {self.time:.3f} s"
        why = "that moment is to be kept" if self.moves else "nothing of this change moves them"
        return f"{told}, {self.wanted * 1e3:g} mm are needed, and {why}"


def blocked_by(state: State, gradient: Gradient) -> Blocked | None:
    """The worst pair that falls short and that no change moves; None without one."""
    found = [told for one in state.near if (told := _worst(state, one, gradient)) is not None]
    return min(found, key=lambda told: told.clearance - told.wanted, default=None)


def pair_at(state: State, approach: Approach, row: int, *, moves: bool) -> Blocked:
    """What falls short in a row of an approach."""
    case, phase = approach.case, approach.section.phase
    step = int(approach.steps[row])
    return Blocked(
        approach.pair.a.name_in(case),
        approach.pair.b.name_in(case),
        float(phase.motions[0].times[step - phase.first]),
        float(approach.clearances[row]),
        approach.rule.limits.fail + state.margin,
        moves,
    )


def worst_pair(state: State) -> Blocked | None:
    """The pair that falls short by most; None where none does."""
    rows = [(float(own.max()), i, int(own.argmax())) for i, one in enumerate(state.near)
            if len(own := state.missing(one))]  # fmt: skip
    if not rows or max(rows)[0] <= 0.0:
        return None
    _, i, row = max(rows)
    return pair_at(state, state.near[i], row, moves=True)


def _worst(state: State, approach: Approach, gradient: Gradient) -> Blocked | None:
    missing, by_unit = state.missing(approach), gradient(approach)
    stays = missing > 0.0
    if by_unit is not None:
        stays &= ~by_unit.any(axis=1)
    rows = np.flatnonzero(stays)
    if not len(rows):
        return None
    return pair_at(state, approach, int(rows[np.argmax(missing[rows])]), moves=by_unit is not None)
