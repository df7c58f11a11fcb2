"""What the sections of a run come to together: for each rule, and for each step over all rules.

Of a step the row is that of the pair that stands worst against its own rule, and of those alike the one nearest
to its fail limit; without rules that is the nearest pair of all. Not for: measuring (`measure`, `certify`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from clearance.simulate.certificate import Certificate, motion_codes
from clearance.simulate.measurement import Measurement, Minima
from clearance.simulate.moment import Moment
from clearance.simulate.names import pair_names
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.rule_pairs import RulePairs
from clearance.simulate.sample_moments import SampleMoments
from clearance.simulate.section_answer import SectionAnswer
from clearance.simulate.sections import Section, SectionPlan, rule_limits
from clearance.simulate.status import sample_codes
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.rules import DEFAULT


@dataclass(frozen=True, eq=False)
class RunAnswer:
    """What was found of a run.

    Attributes:
        rules: what each rule comes to, in the order of the case; at least one.
        found: of each step the row that stands worst. rule: (n,) the place in `rules` of what judged it, or None
            where there is one rule.
        nearest: of each step the nearest pair of all, whatever judges it; `found` where there is one rule.
        certificate: over all rules; None where nothing is proven.
    """

    rules: tuple[RuleAnswer, ...]
    found: Measurement
    rule: np.ndarray | None
    nearest: Measurement
    certificate: Certificate | None

    def rules_at(self, steps: slice) -> np.ndarray:
        """(k,) the place in `rules` of what judged each of some steps."""
        if self.rule is None:
            return np.zeros(len(range(*steps.indices(len(self.found.clearance)))), dtype=np.int64)
        return self.rule[steps]

    def sample_codes(self, steps: slice) -> np.ndarray:
        """(k,) the status of each of some steps by itself, the worst of all rules; -1 where a bound does not
        decide.
        """
        codes = np.array([sample_codes(r.measurement, r.limits, steps) for r in self.rules])
        undecided = (codes < 0).any(axis=0) & (codes.max(axis=0) <= 0)
        return np.where(undecided, -1, codes.max(axis=0))

    def motion_codes(self, steps: slice) -> np.ndarray:
        """(k,) what is proven of the motion from each of some steps to the next, the worst of all rules."""
        found = [motion_codes(r.certificate, r.limits, steps) for r in self.rules if r.certificate]
        return np.max(found, axis=0)


def judged(
    plan: SectionPlan,
    answers: Sequence[SectionAnswer],
    case: Case,
    motions: Sequence[Motion],
) -> RunAnswer:
    """What a run comes to, of what its sections come to."""
    rules, limits, n_steps = [], case.limits, motions[0].n_steps
    samples = SampleMoments(pair_names(case, plan.pairs), motions)
    for rule in plan.rules:
        own = [answer for answer in answers if answer.section.rule == rule]
        found = joined(own, n_steps, len(plan.pairs))
        certificate = joined_certificates(own, n_steps, limits.rule_names[rule])
        name = limits.rule_names[rule]
        moment_at = partial(samples.at, found, name)
        pairs = RulePairs(own, name)
        own_limits = rule_limits(case, rule, [answer.section for answer in own])
        rules.append(RuleAnswer(name, own_limits, found, certificate, moment_at, pairs))
    if len(rules) == 1:
        only = rules[0]
        return RunAnswer((only,), only.measurement, None, only.measurement, only.certificate)
    worst = _worst_rule(rules, n_steps)
    found = _chosen([rule.measurement for rule in rules], worst)
    least = np.argmin([_or_far(rule.measurement.clearance) for rule in rules], axis=0)
    nearest = _chosen([rule.measurement for rule in rules], least)
    return RunAnswer(tuple(rules), found, worst, nearest, _over_rules(rules))


def joined(answers: Sequence[SectionAnswer], n_steps: int, n_pairs: int) -> Measurement:
    """The measurements of some sections as one of all steps: the nearest of each, less its padding."""
    first = answers[0]
    if len(answers) == 1 and _is_whole(first.section, n_steps, n_pairs):
        return first.found
    clearance, lower = np.full(n_steps, np.nan), np.full(n_steps, np.inf)
    unknown = np.full(
        n_steps, np.inf
    )  # [m] no pair is nearer of the sections that only have a bound
    pair, points = np.full(n_steps, -1, dtype=np.int64), np.full((n_steps, 2, 3), np.nan)
    touching = np.zeros(n_steps, dtype=bool)
    times_b = np.full(n_steps, np.nan)
    for answer in answers:
        own, rows = answer.found, answer.section.steps
        reached, touches = own.clearance - answer.section.padding, own.touches(slice(None))
        known = own.pair >= 0
        have, held = clearance[rows], touching[rows]
        nearer = known & (
            np.isnan(have) | (touches & ~held) | ((touches == held) & (reached < have))
        )
        bound = own.lower_bound - answer.section.padding
        np.minimum(lower[rows], bound, out=lower[rows])
        np.minimum(unknown[rows], bound, out=unknown[rows], where=~known)
        clearance[rows] = np.where(nearer, reached, have)
        pair[rows] = np.where(nearer, answer.section.places[np.maximum(own.pair, 0)], pair[rows])
        points[rows] = np.where(nearer[:, None, None], own.points, points[rows])
        touching[rows] = np.where(nearer, touches, held)
        if own.times_b is not None:
            times_b[rows] = np.where(nearer, own.times_b, times_b[rows])
    hidden = (clearance > unknown) & ~touching
    clearance[hidden], pair[hidden], points[hidden] = np.nan, -1, np.nan
    return Measurement(
        clearance,
        lower,
        pair,
        points,
        _sum([answer.found.tally for answer in answers]),
        _minima(answers, n_pairs) if all(a.found.measure_pair_minima for a in answers) else None,
        _every(answers, n_steps, n_pairs)
        if all(a.found.every is not None for a in answers)
        else None,
        any(answer.found.may_cut_pairs for answer in answers),
        touching,
        None if np.isnan(times_b).all() else times_b,
    )


def _is_whole(section: Section, n_steps: int, n_pairs: int) -> bool:
    """True if a section's answer is that of the run as it is."""
    return section.padding == 0.0 and section.tied and (
        len(section.pairs) == n_pairs and section.phase.n_steps == n_steps
    )  # fmt: skip


def _sum(tallies: Sequence[dict[str, int]]) -> dict[str, int]:
    total: dict[str, int] = {}
    for tally in tallies:
        for name, number in tally.items():
            total[name] = total.get(name, 0) + number
    return total


def _minima(answers: Sequence[SectionAnswer], n_pairs: int) -> Callable[[int | None], Minima]:
    """Finds the least of each pair over some sections; infinite for pairs that are not theirs."""

    def found(most: int | None) -> Minima:
        least = Minima(
            np.full(n_pairs, np.inf), np.full(n_pairs, -1), np.full((n_pairs, 2, 3), np.nan)
        )
        for answer in answers:
            assert answer.found.measure_pair_minima is not None
            own, places = answer.found.measure_pair_minima(most), answer.section.places
            reached = own.clearance - answer.section.padding
            nearer = reached < least.clearance[places]
            least.clearance[places[nearer]] = reached[nearer]
            least.step[places[nearer]] = own.step[nearer] + answer.section.phase.first
            least.points[places[nearer]] = own.points[nearer]
        return least

    return found


def _every(answers: Sequence[SectionAnswer], n_steps: int, n_pairs: int) -> np.ndarray:
    """(n, pairs) [m] the clearance of each pair at each step; NaN where it is not measured by these sections."""
    every = np.full((n_steps, n_pairs), np.nan)
    for answer in answers:
        assert answer.found.every is not None
        where = np.ix_(np.arange(n_steps)[answer.section.steps], answer.section.places)
        every[where] = np.fmin(every[where], answer.found.every - answer.section.padding)
    return every


def joined_certificates(
    answers: Sequence[SectionAnswer], n_steps: int, rule: str
) -> Certificate | None:
    """The certificates of some sections as one of all intervals; infinite where they say nothing."""
    first = answers[0]
    if first.certificate is None:
        return None
    whole = first.section.padding == 0.0 and first.section.tied
    if len(answers) == 1 and whole and first.section.phase.n_steps == n_steps:
        places = first.section.places
        if rule == DEFAULT and np.array_equal(places, np.arange(len(places))):
            return first.certificate
    lower, upper = np.full(n_steps, np.inf), np.full(n_steps, np.inf)
    share, pair = np.full(n_steps, -1.0), np.full(n_steps, -1, dtype=np.int64)
    touching, owner = np.zeros(n_steps, dtype=bool), np.zeros(n_steps, dtype=np.int64)
    for i, answer in enumerate(answers):
        own, phase = answer.certificate, answer.section.phase
        assert own is not None
        n_rows = phase.n_steps if phase.last == n_steps - 1 else phase.n_steps - 1
        rows = slice(phase.first, phase.first + n_rows)
        low, high = (
            bound[:n_rows] - answer.section.padding for bound in (own.lower_bound, own.upper_bound)
        )
        touches = own.touches(slice(0, n_rows))
        np.minimum(lower[rows], low, out=lower[rows])
        nearer = (touches & ~touching[rows]) | ((touches == touching[rows]) & (high < upper[rows]))
        upper[rows] = np.where(nearer, high, upper[rows])
        share[rows] = np.where(nearer, own.share[:n_rows], share[rows])
        own_pair = own.pair[:n_rows]
        places = np.where(own_pair >= 0, answer.section.places[np.maximum(own_pair, 0)], -1)
        pair[rows] = np.where(nearer, places, pair[rows])
        touching[rows] = np.where(nearer, touches, touching[rows])
        owner[rows] = np.where(nearer, i, owner[rows])

    def moment_of(step: int) -> Moment:
        answer = answers[int(owner[step])]
        assert answer.certificate is not None
        found = answer.certificate.moment_of(step - answer.section.phase.first)
        return found.of_run(answer.section.phase.first, answer.section.padding, rule)

    certificates = [answer.certificate for answer in answers if answer.certificate is not None]
    return Certificate(
        lower,
        upper,
        share,
        pair,
        max(certificate.gap for certificate in certificates),
        _sum([certificate.tally for certificate in certificates]),
        moment_of,
        tuple(dict.fromkeys(notice for c in certificates for notice in c.notices)),
        touching,
    )


def _worst_rule(rules: Sequence[RuleAnswer], n_steps: int) -> np.ndarray:
    """(n,) of each step the rule whose row stands worst, then nearest to its fail limit; the first of those
    alike.
    """
    every = slice(0, n_steps)
    codes = np.array([sample_codes(rule.measurement, rule.limits, every) for rule in rules])
    margins = np.array([_or_far(r.measurement.clearance) - r.limits.fail for r in rules])
    margins[codes < codes.max(axis=0)] = np.inf
    unknown = np.isinf(margins).all(axis=0)
    bounds = np.array([rule.measurement.lower_bound - rule.limits.fail for rule in rules])
    return np.where(unknown, np.argmin(bounds, axis=0), np.argmin(margins, axis=0))


def _chosen(found: Sequence[Measurement], which: np.ndarray) -> Measurement:
    """Of each step the row of one of some measurements."""
    steps = np.arange(len(which))

    def of(name: str) -> np.ndarray:
        return np.array([getattr(one, name) for one in found])[which, steps]

    every = [one.every for one in found if one.every is not None]
    times_b = [np.full(len(which), np.nan) if o.times_b is None else o.times_b for o in found]
    return Measurement(
        of("clearance"),
        np.min([one.lower_bound for one in found], axis=0),
        of("pair"),
        of("points"),
        _sum([one.tally for one in found]),
        None,
        np.fmin.reduce(every) if len(every) == len(found) else None,
        any(one.may_cut_pairs for one in found),
        np.array([one.touches(slice(None)) for one in found])[which, steps],
        None if np.isnan(times_b).all() else np.array(times_b)[which, steps],
    )


def _over_rules(rules: Sequence[RuleAnswer]) -> Certificate | None:
    """The least of what is proven of all rules."""
    own = [rule.certificate for rule in rules if rule.certificate is not None]
    if len(own) < len(rules):
        return None
    touching = np.array([one.touches(slice(None)) for one in own])
    uppers = np.array([one.upper_bound for one in own])
    which = np.argmin(np.where(touching, -np.inf, uppers), axis=0)
    steps = np.arange(len(which))

    def of(name: str) -> np.ndarray:
        return np.array([getattr(one, name) for one in own])[which, steps]

    return Certificate(
        np.min([one.lower_bound for one in own], axis=0),
        of("upper_bound"),
        of("share"),
        of("pair"),
        max(one.gap for one in own),
        _sum([one.tally for one in own]),
        lambda step: own[int(which[step])].moment_of(step),
        tuple(dict.fromkeys(notice for one in own for notice in one.notices)),
        touching[which, steps],
    )


def _or_far(clearance: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(clearance), np.inf, clearance)
