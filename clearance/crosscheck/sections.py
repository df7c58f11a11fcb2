"""The cross-check of a run in sections: each by itself, without padding, then all as one.

Not for: comparing (`compare`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pyarrow as pa

from clearance.crosscheck.compare import cross_check
from clearance.simulate.judged import Judged, SectionAnswer
from clearance.simulate.moment import Moment
from clearance.simulate.record import CrossCheck, Samples
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.steps import step_table


def cross_check_sections(
    answers: Sequence[SectionAnswer], progress: Callable[[int, int], None] | None = None
) -> CrossCheck:
    """The comparison of every step of all sections with FCL; steps are those of the run.

    Sections whose clocks are not tied are left out: FCL is asked about one time only.

    Raises:
        Unavailable: python-fcl cannot be imported.
    """
    checks = [_of_section(answer, progress) for answer in answers if answer.section.tied]
    worst = max(checks, key=lambda check: check.greatest_difference)
    return replace(
        worst,
        n_steps=sum(check.n_steps for check in checks),
        worst_witness_error=max(check.worst_witness_error for check in checks),
        disagreements=tuple(row for check in checks for row in check.disagreements),
        n_settled=sum(check.n_settled for check in checks),
        greatest_settled=max(check.greatest_settled for check in checks),
    )


def _of_section(answer: SectionAnswer, progress: Callable[[int, int], None] | None) -> CrossCheck:
    section, first = answer.section, answer.section.phase.first
    alone = RuleAnswer("", section.in_motion.limits, answer.found, None, _no_moment)
    judged = Judged((alone,), answer.found, None, answer.found, None)
    tables = step_table(section.phase.case, section.phase.motions, section.pairs, judged)
    samples = Samples(section.phase.case, section.phase.motions, pa.concat_tables(tables), ())
    found = cross_check(samples, progress, section.pairs)
    rows = tuple(replace(row, step=row.step + first) for row in found.disagreements)
    return replace(found, worst_step=found.worst_step + first, disagreements=rows)


def _no_moment(step: int) -> Moment:
    raise AssertionError("a table needs no moment")
