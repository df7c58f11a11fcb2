"""The cross-check of a run in sections: each by itself, without padding, then all as one.

Not for: comparing (`compare`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pyarrow as pa

from clearance.crosscheck.compare import compared
from clearance.record.record import CrossCheck, Samples
from clearance.record.rule_answer import RuleAnswer
from clearance.record.steps import RunAnswer, step_table
from clearance.simulate.measure.section_answer import SectionAnswer


def cross_check_sections(
    answers: Sequence[SectionAnswer], progress: Callable[[int, int], None] | None = None
) -> CrossCheck:
    """The comparison of every step of all sections with FCL; steps are those of the run.

    Sections whose clocks are not tied are omitted: FCL measures one time only.

    Raises:
        Unavailable: python-fcl cannot be imported.
    """
    tied = [answer for answer in answers if answer.section.tied]
    found = [_of_section(answer, progress) for answer in tied]
    checks = [check for check, _ in found]
    worst = max(checks, key=lambda check: check.greatest_difference)
    return replace(
        worst,
        n_steps=len({step for answer in tied for step in _steps_of(answer)}),
        worst_witness_error=max(check.worst_witness_error for check in checks),
        disagreements=tuple(row for check in checks for row in check.disagreements),
        n_settled=len({step for _, settled in found for step in settled}),
        greatest_settled=max(check.greatest_settled for check in checks),
    )


def _steps_of(answer: SectionAnswer) -> range:
    steps = answer.section.steps
    return range(steps.start, steps.stop)


def _of_section(
    answer: SectionAnswer, progress: Callable[[int, int], None] | None
) -> tuple[CrossCheck, list[int]]:
    """The comparison of a section, and the steps of the run that are settled for us."""
    section, first = answer.section, answer.section.phase.first
    alone = RuleAnswer("", section.in_motion.limits, answer.found)
    judged = RunAnswer((alone,), answer.found, None, answer.found, None)
    tables = step_table(section.phase.case, section.phase.motions, section.pairs, judged)
    samples = Samples(section.phase.case, section.phase.motions, pa.concat_tables(tables), ())
    found, settled = compared(samples, progress, section.pairs)
    rows = tuple(replace(row, step=row.step + first) for row in found.disagreements)
    moved = replace(found, worst_step=found.worst_step + first, disagreements=rows)
    return moved, (settled + first).tolist()
