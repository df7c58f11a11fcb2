"""What a reader of the verdict must know: what was not measured, not cross-checked, or has no depth.

Not for: notices of the case itself (`world.plausibility`), nor what becomes of them (`findings.verdict`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.record.certificate import Certificate
from clearance.run.question import Question
from clearance.simulate.answers.carries import notices_on_carries
from clearance.simulate.measure import inside
from clearance.simulate.measure.neighbours import neighbours_that_meet
from clearance.simulate.measure.sections import SectionAnswer, SectionPlan
from clearance.world.case import Case, uncounted_in_sweeps
from clearance.world.extents import metres, reach_of
from clearance.world.notice import Notice, Severity, listed, worst_first
from clearance.world.pairs import names_of
from clearance.world.phase import Phase
from clearance.world.plausible_sizes import FAR_OFF, far_off_notice
from clearance.world.rules import Rule, Waiver, matches

ROUNDED = 1e-4
"""[m] Coordinates that a sketch's file rounds may be off by as much."""

_BY_PAPER = Notice(
    Severity.WARNING,
    "paper",
    "pairs may have been left out: the paper's method has no guarantee; for a safe clearance use method 'exact'",
)


def notices_of(
    question: Question,
    plan: SectionPlan,
    phases: Sequence[Phase],
    certificate: Certificate | None,
    found: Sequence[SectionAnswer],
) -> tuple[Notice, ...]:
    """All notices, those of the case and of how it was measured; the gravest first."""
    measured = inside.notices(plan) if question.inside and question.method == "exact" else ()
    proven = () if certificate is None else certificate.notices
    empty = [*map(_nothing_measured, plan.empty), *_idle_rules(question.case, plan)]
    empty += _waivers_of_all(question.case, plan)
    empty += [*_profiles_without(question.case), *_sketches_that_slid(question.case)]
    empty += _far_off(question.case, found)
    empty += notices_on_carries(phases) if question.case.carries else ()
    empty += neighbours_that_meet(phases)
    empty += [_BY_PAPER] if question.method == "paper" else []
    untied = [*_not_cross_checked(question.case, plan)] if question.cross_check else []
    untied += [*_without_depth(found), *_clouds_without_depth(question.case, found)]
    return worst_first([*question.case.notices, *measured, *proven, *empty, *untied])


def _nothing_measured(phase: Phase) -> Notice:
    start, end = phase.span
    text = f"nothing is measured from {start:.3f} s to {end:.3f} s: no pair is left then"
    return Notice(Severity.WARNING, "pairs", text)


def _idle_rules(case: Case, plan: SectionPlan) -> Iterator[Notice]:
    """A warning on each rule of the case whose limits hold for no measured pair at any time."""
    names = case.limits.rule_names
    for i, rule in enumerate(case.limits.rules, start=1):
        if i not in plan.rules:
            text = f"rule {names[i]!r} ({' - '.join(rule.between)}) applies to no measured pair: "
            yield Notice(Severity.WARNING, "rules", text + "; ".join(_why_idle(case, plan, rule)))


def _why_idle(case: Case, plan: SectionPlan, rule: Rule) -> Iterator[str]:
    """Who has the pairs that a rule matches: nobody, for one reason each, or rules that come later."""
    by_reason: dict[str, list[str]] = {}
    for one in plan.unmeasured:
        if rule.matches((one.link,), (one.obstacle,)):
            by_reason.setdefault(one.reason, []).append(f"{one.link} - {one.obstacle}")
    for reason, pairs in by_reason.items():
        yield f"{listed(pairs)} {'is' if len(pairs) == 1 else 'are'} not measured ({reason})"
    if any(rule.matches(*(names_of(case, body) for body in pair)) for pair in plan.pairs):
        others = "other " if by_reason else ""
        yield f"its {others}pairs are judged by later rules, or outside its time, or stand in it"


def _waivers_of_all(case: Case, plan: SectionPlan) -> Iterator[Notice]:
    """A warning on each waiver that names no body, and is of all pairs that are measured, by whatever rule."""
    for waiver in case.waivers:
        by_pattern = all({*one} & {*"*?["} for one in waiver.between)
        if by_pattern and waiver.is_of_case(case.name) and _is_of_all(waiver, case, plan):
            level = f"down to {waiver.at_least * 1000:g} mm"
            text = f"{waiver} is for every pair: it waives later faults too, {level}"
            yield Notice(Severity.WARNING, "waivers", text)


def _is_of_all(waiver: Waiver, case: Case, plan: SectionPlan) -> bool:
    rules = [case.limits.rule_names[i] for i in plan.rules]
    return all(matches(rule, waiver.rule) for rule in rules) and all(
        waiver.matches(names_of(case, one), names_of(case, two)) for one, two in plan.pairs
    )


def _profiles_without(case: Case) -> Iterator[Notice]:
    """A warning on what profiles do not count of how far links may be from where they are said to be."""
    if not case.profiles:
        return
    left_out = uncounted_in_sweeps([case])
    if left_out:
        names = listed([repr(space.name) for space in case.profiles])
        text = f"profiles are judged without the {left_out} of the case: {names}"
        yield Notice(
            Severity.WARNING, "profiles", f"{text}; give them a limit of what these may add"
        )


def _sketches_that_slid(case: Case) -> Iterator[Notice]:
    """A warning on each sketch that is judged at another place than its file draws, though nothing fixes it."""
    for space in case.profiles:
        if space.drift > ROUNDED:
            zone = f"the sketch of profile {space.name!r} is up to {1000 * space.drift:.3g} mm"
            text = f"{zone} from where it is drawn, and nothing fixes it; fix the corner that is to stay"
            yield Notice(Severity.WARNING, "sketch", text)


def _far_off(case: Case, found: Sequence[SectionAnswer]) -> Iterator[Notice]:
    """A warning that nothing comes near to anything, which boxes of hollow meshes do not show."""
    least = min((one.found.clearance.min(initial=np.inf) for one in found), default=np.inf)
    reach = max(map(reach_of, case.robots))
    is_noted = any(notice.kind in ("units", "reach") for notice in case.notices)
    if FAR_OFF * reach < least < np.inf and not is_noted:
        text = f"nothing comes nearer than {metres(least)} m to the robot"
        yield far_off_notice(text, least / reach)


def _without_depth(found: Sequence[SectionAnswer]) -> Iterator[Notice]:
    """Contact of pairs that no one time has: none of what is said of contact is worked out."""
    if any((one.found.clearance <= 0.0).any() for one in found if not one.section.tied):
        text = "contact of bodies whose clocks are not tied has no depth, volume or separation vector here"
        yield Notice(Severity.WARNING, "contact", text)


def _clouds_without_depth(case: Case, found: Sequence[SectionAnswer]) -> Iterator[Notice]:
    """Contact with clouds: how deep a ball is says nothing of the thing that was scanned."""
    names: dict[str, None] = {}
    for one in found:
        pairs, touching = one.section.pairs, one.found.pair[one.found.clearance <= 0.0]
        for i in np.unique(touching).tolist() if len(touching) else ():
            if i >= 0 and pairs[i].has_cloud(case):
                clouds = (body for body in pairs[i] if body.body_in(case).is_cloud)
                names |= {body.name_in(case): None for body in clouds}
    if names:
        lacks = "has no depth, volume or separation vector here: clouds of points"
        text = f"contact with {listed([*names], 6)} {lacks}"
        yield Notice(Severity.WARNING, "contact", text)


def _not_cross_checked(case: Case, plan: SectionPlan) -> Iterator[Notice]:
    from clearance.crosscheck import MOST_POINTS, is_too_large

    large = {pair for pair in plan.pairs if is_too_large(case, pair)}
    if large:
        text = (
            f"{len(large)} pairs with clouds of points are not cross-checked: FCL is asked about up to "
            f"{MOST_POINTS:,} points"
        )
        yield Notice(Severity.WARNING, "cross-check", text)
    untied = {pair for one in plan.sections if not one.tied for pair in one.pairs}
    if untied:
        text = f"{len(untied)} pairs whose clocks are not tied are not cross-checked: FCL is asked about one time"
        yield Notice(Severity.WARNING, "cross-check", text)
