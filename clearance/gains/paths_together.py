"""A change of the paths of several robots at once, as large as the greatest of the changes of one.

Not for: one robot (`offsets`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.gains.offsets import JointOffsets, least_greatest
from clearance.gains.programme import Box, Inequalities
from clearance.gains.shortfalls import Rows
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.transfers import CombinedTransfers
from clearance.world.case import Case
from clearance.world.pairs import Pair
from clearance.world.timeline import Timeline


@dataclass(frozen=True, eq=False)
class PathsTogether:
    """Offsets of several robots of a case; the variables of one follow those of the other.

    Attributes:
        parts: of each robot.
    """

    parts: tuple[JointOffsets, ...]
    price: float = 100.0
    tool_poses: None = None
    bends: bool = True

    @cached_property
    def transfers(self) -> CombinedTransfers:
        """The parts that any of them hands over elsewhere."""
        return CombinedTransfers(tuple(part.transfers for part in self.parts))

    @cached_property
    def box(self) -> Box:
        low, high = zip(*(part.box for part in self.parts), strict=True)
        return Box(np.concatenate(low), np.concatenate(high))

    @cached_property
    def first_reach(self) -> np.ndarray:
        return np.concatenate([part.first_reach for part in self.parts])

    @cached_property
    def inequalities(self) -> Inequalities:
        """The limits of all joints."""
        from scipy.sparse import block_diag

        own = [part.inequalities for part in self.parts]
        return Inequalities(
            block_diag([one.a for one in own], format="csr"),
            np.concatenate([one.b for one in own]),
        )

    def of_each(self, x: np.ndarray) -> list[np.ndarray]:
        """The variables of each robot."""
        return np.split(x, np.cumsum([len(part.first_reach) for part in self.parts])[:-1])

    def offsets(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        """(n, k) [rad or m] of the samples of each table."""
        each = zip(self.parts, self.of_each(x), strict=True)
        return tuple(part.offsets(own) for part, own in each)

    def case_of(self, x: np.ndarray) -> Case:
        case = self.parts[0].case
        robots = list(case.robots)
        for part, own in zip(self.parts, self.of_each(x), strict=True):
            robots[part.i_robot] = part.placed_of(own)
        return replace(case, robots=tuple(robots))

    def moves(self, case: Case, pair: Pair) -> bool:
        return any(part.moves(case, pair) for part in self.parts)

    def gradient(self, approach: Approach, timeline: Timeline | None = None) -> np.ndarray | None:
        found = [part.gradient(approach, timeline) for part in self.parts]
        if all(one is None for one in found):
            return None
        n_steps = len(approach.steps)
        sizes = [len(part.first_reach) for part in self.parts]
        return np.hstack(
            [
                np.zeros((n_steps, size)) if one is None else one
                for one, size in zip(found, sizes, strict=True)
            ]
        )

    def size(self, x: np.ndarray) -> float:
        each = zip(self.parts, self.of_each(x), strict=True)
        return max(part.size(own) for part, own in each)

    def least(self, rows: Rows, x: np.ndarray, box: Box) -> np.ndarray | None:
        from scipy.sparse import block_diag

        sized = block_diag([part.sized for part in self.parts], format="csr")
        weights = np.concatenate([part.weight_of_each for part in self.parts])
        return least_greatest(rows, x, box, sized, weights, self.inequalities)

    def other_rows(self, x: np.ndarray, beyond: float) -> Rows | None:
        return None

    def swing(self, reach: np.ndarray) -> float:
        each = zip(self.parts, self.of_each(reach), strict=True)
        return sum(part.swing(own) for part, own in each)
