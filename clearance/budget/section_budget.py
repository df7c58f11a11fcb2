"""The distances that a budget leaves in one section. Not for: all sections together (`answer`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.budget.proven import PairsWithErrors
from clearance.kernels.budget.sweep import BudgetRows
from clearance.simulate.measure.section_answer import SectionAnswer
from clearance.simulate.measure.sections import Section


@dataclass(frozen=True, eq=False)
class SectionBudget:
    """The distances that a budget leaves in a section, without padding; pairs and steps are the section's own.

    Attributes:
        answer: as measured. pairs: with their errors.
        steps: proven at each step. between: proven from each step to the next; None without a certificate.
        expected: (n,) [m]. expected_between: of the least moment after each, NaN where the steps are nearer; None
            like `between`.
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
