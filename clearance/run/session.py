"""The session of a run: all that can be asked beside its record, other pairs and tolerances too.

Not for: measuring (`answers`), nor what the run comes to (`result`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from clearance.record.budget import BudgetMoment, RuleBudget
from clearance.record.rule_answer import RuleAnswer
from clearance.record.session import PairTest
from clearance.run.answers import MeasurementPlan, answers_of_pairs
from clearance.simulate.answers.run_answer import judged
from clearance.simulate.measure.resources import DEFAULT_RESOURCES
from clearance.simulate.session import MeasuringSession

if TYPE_CHECKING:
    from clearance.budget.answer import MeasuredBudget
    from clearance.world.rules import Waiver


@dataclass(frozen=True, eq=False)
class RunSession(MeasuringSession):
    """What can be asked of a run beside its record; each answer is worked out once.

    Attributes:
        plan: what is measured, and when. budgets: what tolerances leave, of each rule; empty without tolerances.
        drawings: by its name, what draws the picture of a profile as SVG.
    """

    plan: MeasurementPlan = field(kw_only=True)
    budgets: tuple[MeasuredBudget, ...] = field(kw_only=True)
    drawings: Mapping[str, Callable[[], str]] = field(kw_only=True)

    @property
    def pictures(self) -> dict[str, str]:
        """The picture of each profile as SVG, by its name."""
        return {name: draw() for name, draw in self.drawings.items()}

    @cached_property
    def _budget_of(self) -> dict[RuleBudget, MeasuredBudget]:
        return {one.remaining: one for one in self.budgets}

    def of_pairs(
        self, is_meant: PairTest, need: str | None = None, levels: tuple[float, ...] = ()
    ) -> tuple[RuleAnswer, ...]:
        """The answer of each rule for the pairs that are meant, as if there were no others.

        Args:
            need: as of the run if not given; else proven too. levels: [m] to be decided beside the limits.
        """
        some, found = answers_of_pairs(self.plan, is_meant, need, levels)
        if not found:
            return ()
        return self.answers(judged(some, found, self.plan.question.case, self.plan.motions).rules)

    def budget_of_pairs(
        self, is_meant: PairTest, waiver: Waiver | None = None
    ) -> tuple[RuleBudget, ...]:
        """What tolerances leave to the pairs that are meant, against their waiver if they have one; empty without
        tolerances.
        """
        some, found = answers_of_pairs(self.plan, is_meant)
        if not found or not self.budgets:
            return ()
        from clearance.budget.answer import budget_answers

        case = self.plan.question.case
        own = budget_answers(case, some, found, DEFAULT_RESOURCES, waiver)
        self._budget_of.update({one.remaining: one for one in own})
        return tuple(one.remaining for one in own)

    def least_left(self, budget: RuleBudget) -> tuple[BudgetMoment, ...]:
        """The moments at which tolerances leave least to a rule, the worst first."""
        return self._budget_of[budget].worst.moments

    def error_sources(
        self, budget: RuleBudget, i_moment: int = 0, most: int | None = None
    ) -> BudgetMoment:
        """One of these moments with what each error takes of it, and of the first `most` the greatest size."""
        return self._budget_of[budget].worst.with_sources(i_moment, most)
