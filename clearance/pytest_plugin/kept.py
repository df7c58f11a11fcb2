"""Whether some pairs of a run keep a distance, measured and proven by themselves. Not for: the assertion."""

from __future__ import annotations

from collections.abc import Iterator

from clearance.errors import BadInput, UnknownLink, nearest_name
from clearance.report.wording import limit_mm, mm, moment_text, of_rule
from clearance.run import Run
from clearance.simulate.rule_answer import RuleAnswer
from clearance.world.rules import PairPattern, checked_level, matches


def faults_of(run: Run, between: tuple[str, str], at_least: float | None) -> list[str]:
    """What comes nearer than [m], or than its fail limit, one line each.

    Raises:
        BadInput: no such pair, or no level.
    """
    pattern = PairPattern((between[0], between[1]))
    level = None if at_least is None else checked_level(at_least, "at_least")
    assert run.record.of_pairs is not None, "a run can be asked again"
    answers = run.record.of_pairs(lambda _, one, other: pattern.matches(one, other), "steps")
    if not answers:
        raise _no_such_pair(run, between)
    return [line for answer in answers for line in _faults(answer, level)]


def _faults(answer: RuleAnswer, at_least: float | None) -> Iterator[str]:
    level = answer.limits.fail if at_least is None else at_least
    wanted = f"at least {limit_mm(level)} mm was asked for"
    if at_least is None:
        wanted = f"the fail limit{of_rule(answer.name)} is {limit_mm(level)} mm"
    worst, certificate = answer.worst, answer.certificate
    if worst is not None and (worst.clearance < level or worst.touches):
        near = "contact" if worst.touches else f"{mm(worst.clearance)} mm"
        yield f"{worst.link} - {worst.obstacle}: {near} at {moment_text(worst)}; {wanted}"
    elif certificate is not None and float(certificate.lower_bound.min()) < level:
        proven = mm(float(certificate.lower_bound.min()))
        told = f"only {proven} mm is proven, though nothing nearer is seen"
        yield f"{told}; {wanted}; a smaller certify_gap proves more"


def _no_such_pair(run: Run, between: tuple[str, str]) -> BadInput:
    names = sorted(
        {
            name
            for rule in run.record.rules
            if rule.pairs
            for pair in rule.pairs.names
            for name in pair
        }
    )
    for pattern in between:
        if not any(matches(name, pattern) for name in names):
            return UnknownLink(f"no body is called {pattern!r}", valid=nearest_name(pattern, names))
    return BadInput(
        f"no pair is measured between {list(between)}", valid="patterns of two bodies of a pair"
    )
