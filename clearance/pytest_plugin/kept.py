"""Whether some pairs of a run keep a distance, measured and proven by themselves. Not for: the assertion."""

from __future__ import annotations

from collections.abc import Iterator

from clearance.errors import BadInput, UnknownLink, nearest_name
from clearance.findings.doubts import SELF_COLLISION
from clearance.findings.of_rule import why_undecided
from clearance.record.budget import RuleBudget
from clearance.record.record import Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.session import PairTest
from clearance.record.wording import limit_mm, mm, moment_text, of_rule
from clearance.run import Run
from clearance.world.case import Case
from clearance.world.notice import listed
from clearance.world.pairs import NO_GEOMETRY
from clearance.world.rules import PairPattern, checked_level, matches
from clearance.world.self_pairs import RIGID, self_pairs

CONTACT = "contact is not ruled out"


def faults_of(run: Run, between: tuple[str, str], at_least: float | None) -> list[str]:
    """What comes nearer than [m], or than its fail limit, one line each.

    Raises:
        BadInput: no such pair, or no level.
    """
    pattern = PairPattern(between)
    level = None if at_least is None else checked_level(at_least, "at_least")

    def is_meant(_: str, one: tuple[str, ...], other: tuple[str, ...]) -> bool:
        return pattern.matches(one, other)

    answers = run.session.of_pairs(is_meant, "steps", () if level is None else (level,))
    if not answers:
        raise _no_such_pair(run, between)
    found = {one.name: [*_faults(run.record, one, level)] for one in answers}
    for left in _budgets(run, is_meant, level):
        if not found[left.rule]:
            found[left.rule] += _with_tolerances(left, between, level)
    return [line for lines in found.values() for line in lines]


def left_out_of(run: Run, between: tuple[str, str]) -> list[str]:
    """The pairs of such bodies that are excluded, excused or not asked for, and why; not those without a shape."""
    pattern, found = PairPattern(between), []
    for one in run.record.unmeasured:
        whole = one.obstacle == "*" and any(matches(one.link, name) for name in between)
        if one.reason != NO_GEOMETRY and (whole or pattern.matches((one.link,), (one.obstacle,))):
            found.append(f"{one.link} - {one.obstacle} ({one.reason})")
    return [*found, *_links_unasked(run.record.case, pattern)]


def _links_unasked(case: Case, pattern: PairPattern) -> Iterator[str]:
    """The pairs of links of one robot that can move against each other, where the case does not ask for them."""
    for placed in case.robots:
        before = case.prefix_of(placed)
        for pair in () if placed.self_clearance else self_pairs(placed.robot):
            a, b = (before + pair.link_a, before + pair.link_b)
            known = {pair.link_a, pair.link_b}.isdisjoint(placed.exclude_links)
            if (
                known
                and pair.excused != RIGID
                and pattern.matches((a, pair.link_a), (b, pair.link_b))
            ):
                yield f"{b} - {a} ({SELF_COLLISION} not checked)"


def _budgets(run: Run, is_meant: PairTest, level: float | None) -> tuple[RuleBudget, ...]:
    """What tolerances leave of the pairs; nothing without any, and for limits that the case lets pass unproven."""
    tolerance = run.record.case.tolerance
    if tolerance is None or (level is None and tolerance.unproven_ok):
        return ()
    return run.session.budget_of_pairs(is_meant)


def _with_tolerances(
    left: RuleBudget, between: tuple[str, str], at_least: float | None
) -> Iterator[str]:
    level = left.limits.fail if at_least is None else at_least
    if not left.limits.below(left.least, level) and left.least > 0.0:
        return
    proven = f"only {mm(left.least)} mm is proven" if left.least > 0.0 else CONTACT
    yield f"{between[0]} - {between[1]}: with tolerances {proven}; {_wanted(left, level, at_least)}"


def _wanted(answer: RuleAnswer | RuleBudget, level: float, at_least: float | None) -> str:
    if at_least is not None:
        return f"at least {limit_mm(level)} mm was asked for"
    name = answer.name if isinstance(answer, RuleAnswer) else answer.rule
    return f"the fail limit{of_rule(name)} is {limit_mm(level)} mm"


def _faults(record: Record, answer: RuleAnswer, at_least: float | None) -> Iterator[str]:
    level = answer.limits.fail if at_least is None else at_least
    wanted = _wanted(answer, level, at_least)
    worst, certificate = answer.worst, answer.certificate
    if worst is not None and (answer.limits.below(worst.clearance, level) or worst.touches):
        near = "contact" if worst.touches else f"{mm(worst.clearance)} mm"
        yield f"{worst.link} - {worst.obstacle}: {near} at {moment_text(record, worst)}; {wanted}"
    elif certificate is not None and answer.limits.below(certificate.lower_bound.min(), level):
        proven = mm(float(certificate.lower_bound.min()))
        claim = f"only {proven} mm is proven, though nothing nearer is seen"
        yield f"{claim}; {wanted}; {why_undecided(record.case)}"


def _no_such_pair(run: Run, between: tuple[str, str]) -> BadInput:
    measured = {body.name_in(run.record.case) for pair in run.record.pairs for body in pair}
    left_out = [one for one in run.record.unmeasured if one.obstacle != "*"]
    names = sorted(measured | {name for one in left_out for name in (one.link, one.obstacle)})
    whole = {one.link: one.reason for one in run.record.unmeasured if one.obstacle == "*"}
    for pattern in between:
        if any(matches(name, pattern) for name in names):
            continue
        if found := [link for link in whole if matches(link, pattern)]:
            why = listed([*{whole[link]: None for link in found}])
            return UnknownLink(
                f"{pattern!r} matches {listed(found)} alone: {why}", valid=listed(names, 6)
            )
        return UnknownLink(f"no body is called {pattern!r}", valid=nearest_name(pattern, names))
    why = listed(left_out_of(run, between))
    fault = f"no pair is measured between {list(between)}{f': {why}' if why else ''}"
    return BadInput(fault, valid="patterns of two bodies of a pair")
