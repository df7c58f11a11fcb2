"""A change of the paths of one robot, or of several at once, as large as the greatest of the changes of one.

Of those that are as large the least in sum is taken. Not for: the offsets of a robot (`offsets`), by how much
(`search`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from clearance.gains.offsets import JointOffsets
from clearance.gains.programme import Box, Inequalities, reachable, within_reach
from clearance.gains.shortfalls import Rows
from clearance.gains.tool_poses import ToolPoses
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.transfers import CombinedTransfers
from clearance.world.case import Case
from clearance.world.pairs import Pair
from clearance.world.timeline import Timeline

EVENLY = 0.01
"""[-] What the sum of all offsets weighs beside the greatest."""


@dataclass(frozen=True, eq=False)
class PathChange:
    """Offsets of robots of a case; the variables of one follow those of the other.

    Attributes:
        parts: of each robot; one that keeps its tool is alone. The others are as of a `Shift`.
    """

    parts: tuple[JointOffsets, ...]
    price: float = 100.0
    bends: bool = True

    @cached_property
    def transfers(self) -> CombinedTransfers:
        """The parts that any of them hands over elsewhere."""
        return CombinedTransfers(tuple(part.transfers for part in self.parts))

    @property
    def tool_poses(self) -> ToolPoses | None:
        """What is kept of a tool's poses; None for nothing."""
        return self.parts[0].tool_poses

    @cached_property
    def box(self) -> Box:
        size = len(self.first_reach)
        return Box(np.full(size, -np.inf), np.full(size, np.inf))

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
        return None if self.tool_poses is None else self.tool_poses.rows(x, beyond)

    def swing(self, reach: np.ndarray) -> float:
        each = zip(self.parts, self.of_each(reach), strict=True)
        return sum(part.swing(own) for part, own in each)


def least_greatest(
    rows: Rows, x: np.ndarray, box: Box, sized: Any, weights: np.ndarray, inequalities: Inequalities
) -> np.ndarray | None:
    """(m,) the variables of least greatest offset that keep all rows, linear about x; None if none do.

    Args:
        sized: (r, m) sparse: what offsets are at samples. weights: (m,) of each variable.
        inequalities: kept beside the rows.
    """
    from scipy.optimize import linprog
    from scipy.sparse import block_array, csr_array, eye_array

    size, rows, inequalities = len(x), reachable(rows, x, box), within_reach(inequalities, *box)
    wanted = rows.missing + rows.gradients @ x
    ones, unit = csr_array(np.ones((sized.shape[0], 1))), eye_array(size)
    a = block_array(
        [
            [csr_array(-rows.gradients), None, csr_array((len(wanted), 1))],
            [sized, None, -ones],
            [-sized, None, -ones],
            [unit, -unit, None],
            [-unit, -unit, None],
            [inequalities.a, None, None],
        ],
        format="csr",
    )
    flat = np.zeros(2 * sized.shape[0] + 2 * size)
    cost = np.concatenate([np.zeros(size), EVENLY / size * weights, [1.0]])
    bounds = [*zip(box.low, box.high, strict=True), *([(0.0, None)] * (size + 1))]
    b = np.concatenate([-wanted, flat, inequalities.b])
    found = linprog(cost, A_ub=a, b_ub=b, bounds=bounds, method="highs")
    return None if found.x is None else np.asarray(found.x[:size])
