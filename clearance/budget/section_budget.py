"""What is left of the pairs of one section. Not for: what sections come to together (`answer`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.budget.proven import PairsWithErrors
from clearance.kernels.budget.sweep import BudgetRows
from clearance.simulate.measure.section_answer import SectionAnswer
from clearance.simulate.measure.sections import Section


@dataclass(frozen=True, eq=False)
class SectionBudget:
    """What a budget leaves of a section; pairs and steps are the section's own, distances without padding.

    Attributes:
        answer: what was measured. pairs: with their errors.
        steps: proven at each step. between: of the motion from each to the next; None where nothing is certified.
        expected: (n,) [m]. expected_between: of the least moment after each, NaN where the steps are nearer; None
            as `between`.
    """

    answer: SectionAnswer
    pairs: PairsWithErrors
    steps: BudgetRows
    between: BudgetRows | None
    expected: np.ndarray
    expected_between: np.ndarray | None

    @property
    def section(self) -> Section:
        """The section."""
        return self.answer.section
