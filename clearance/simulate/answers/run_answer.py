"""What the sections of a run come to together: for each rule, and for each step over all rules.

Of a step the row is that of the most critical pair, and of those alike the one nearest
to its fail limit; without rules that is the nearest pair of all. Not for: measuring (`measure`, `certify`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from clearance.record.every_pair import EveryPair
from clearance.record.measurement import Measurement, Minima
from clearance.record.moment import Moment
from clearance.record.names import pair_names, sides_of
from clearance.record.record import CUT
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import sample_codes
from clearance.record.steps import RunAnswer
from clearance.simulate.answers.rule_pairs import (
    MeasuredRule,
    RulePairs,
    SampleMoments,
    measured_rule,
)
from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion, no_minima
from clearance.simulate.measure.sections import Section, SectionAnswer, SectionPlan, rule_limits
from clearance.world.case import Case, Omission
from clearance.world.motion import Motion
from clearance.world.pairs import Pair
from clearance.world.rules import DEFAULT


class JudgedRun(NamedTuple):
    """What a run comes to, and each of its rules with what can measure more of it."""

    answer: RunAnswer
    rules: tuple[MeasuredRule, ...]


def judged(
    plan: SectionPlan,
    answers: Sequence[SectionAnswer],
    case: Case,
    motions: Sequence[Motion],
) -> JudgedRun:
    """What a run comes to, of what its sections come to."""
    n_steps = motions[0].n_steps
    samples = SampleMoments(pair_names(case, plan.pairs), motions)
    rules = []
    for rule in plan.rules:
        own = [answer for answer in answers if answer.section.rule == rule]
        name = case.limits.rule_names[rule]
        found = joined(own, n_steps, len(plan.pairs))
        proven = joined_certificates(own, n_steps, name)
        limits = rule_limits(case, rule, [answer.section for answer in own])
        moment_at = partial(samples.at, found, name)
        rules.append(measured_rule(name, limits, found, proven, moment_at, RulePairs(own, name)))
    return JudgedRun(_over_rules(rules, n_steps), tuple(rules))


def _over_rules(rules: Sequence[MeasuredRule], n_steps: int) -> RunAnswer:
    """Of each step the most critical rule."""
    plain = [rule.answer for rule in rules]
    if len(rules) == 1:
        (only,) = plain
        return RunAnswer(plain, only.measurement, None, only.measurement, only.certificate)
    whole = slice(0, n_steps)
    steps = [_Layer(rule.measurement, whole) for rule in rules]
    worst = _worst_rule(plain, n_steps)
    least = np.argmin([_or_far(rule.measurement.clearance) for rule in rules], axis=0)
    every = _every([rule.measurement.every for rule in rules])
    proofs = [_Layer(rule.certificate, whole) for rule in rules if rule.certificate is not None]
    proven = None if len(proofs) < len(rules) else _least_proof(proofs, n_steps)
    return RunAnswer(
        plain,
        _steps_of(steps, worst, every=every),
        worst,
        _steps_of(steps, least, every=every),
        None if proven is None else proven.data,
    )


class _Layer(NamedTuple):
    """Steps or intervals of a run over which something is known: of a section, or of a rule.

    Attributes:
        rows: of the run. padding: [m] that clearances are less by. places: (p,) of its pairs in the run; None
            where they are counted as there. rule: that judges it, if its moments are not yet those of the run.
    """

    found: MeasuredSteps | ProvenMotion
    rows: slice
    padding: float = 0.0
    places: np.ndarray | None = None
    rule: str | None = None

    def column(self, name: str) -> np.ndarray:
        """(rows, ...) a column as the run has it."""
        n_rows = self.rows.stop - self.rows.start
        if name == "touching":
            return self.found.touches(slice(0, n_rows))
        own = getattr(self.found, name)
        if own is None:
            return np.full(n_rows, np.nan)
        own = own[:n_rows]
        if name == "pair" and self.places is not None:
            return np.where(own >= 0, self.places[np.maximum(own, 0)], -1)
        return own - self.padding if name in _PADDED else own

    def moment_of(self, step: int) -> Moment:
        """The moment of an interval of a proof."""
        assert isinstance(self.found, ProvenMotion)
        moment = self.found.moment_of(step - self.rows.start)
        if self.rule is None:
            return moment
        return moment.of_run(self.rows.start, self.padding, self.rule)


_PADDED = ("clearance", "lower_bound", "upper_bound")


def _nearest_layer(layers: Sequence[_Layer], n_steps: int, column: str) -> np.ndarray:
    """(n,) which layer is nearest at each row, contact of bodies first, the first of those alike; -1 for none."""
    owner, least = np.full(n_steps, -1), np.full(n_steps, np.inf)
    touching = np.zeros(n_steps, dtype=bool)
    for i, (layer, rows) in enumerate((layer, layer.rows) for layer in layers):
        reached, touches = layer.column(column), layer.column("touching")
        in_contact = touching[rows]
        nearer = (touches & ~in_contact) | ((touches == in_contact) & (reached < least[rows]))
        owner[rows][nearer], least[rows][nearer] = i, reached[nearer]
        touching[rows][nearer] = touches[nearer]
    return owner


def _gathered(
    layers: Sequence[_Layer], owner: np.ndarray, name: str, rows: np.ndarray
) -> np.ndarray:
    """(n, ...) a column of the layer that each row is of; `rows` as given where that is -1."""
    for i, layer in enumerate(layers):
        own = owner[layer.rows] == i
        rows[layer.rows][own] = layer.column(name)[own]
    return rows


def _least_bound(layers: Sequence[_Layer], n_steps: int) -> np.ndarray:
    """(n,) [m] the least of the proven bounds."""
    least = np.full(n_steps, np.inf)
    for layer in layers:
        np.minimum(least[layer.rows], layer.column("lower_bound"), out=least[layer.rows])
    return least


def _steps_of(
    layers: Sequence[_Layer],
    owner: np.ndarray,
    minima: Callable[[int | None], Minima] | None = None,
    every: np.ndarray | None = None,
) -> MeasuredSteps:
    """Of each step the row of the layer that it is of, and the least bound of all."""
    n = len(owner)
    times_b = _gathered(layers, owner, "times_b", np.full(n, np.nan))
    return MeasuredSteps(
        _gathered(layers, owner, "clearance", np.full(n, np.nan)),
        _least_bound(layers, n),
        _gathered(layers, owner, "pair", np.full(n, -1, dtype=np.int64)),
        _gathered(layers, owner, "points", np.full((n, 2, 3), np.nan)),
        _sum([layer.found.tally for layer in layers]),
        every,
        any(layer.found.may_cut_pairs for layer in layers if isinstance(layer.found, Measurement)),
        _gathered(layers, owner, "touching", np.zeros(n, dtype=bool)),
        None if np.isnan(times_b).all() else times_b,
        measure_pair_minima=minima,
    )


def _proof_of(layers: Sequence[_Layer], owner: np.ndarray) -> ProvenMotion:
    """Of each interval the row of the layer that it is of, and the least bound of all."""
    n = len(owner)
    own = [layer.found for layer in layers if isinstance(layer.found, ProvenMotion)]
    return ProvenMotion(
        _least_bound(layers, n),
        _gathered(layers, owner, "upper_bound", np.full(n, np.inf)),
        _gathered(layers, owner, "share", np.full(n, -1.0)),
        _gathered(layers, owner, "pair", np.full(n, -1, dtype=np.int64)),
        max(one.gap for one in own),
        _sum([one.tally for one in own]),
        tuple(dict.fromkeys(notice for one in own for notice in one.notices)),
        _gathered(layers, owner, "touching", np.zeros(n, dtype=bool)),
        moment_of=lambda step: layers[max(0, int(owner[step]))].moment_of(step),
    )


def joined(answers: Sequence[SectionAnswer], n_steps: int, n_pairs: int) -> MeasuredSteps:
    """The measurements of some sections as one of all steps: the nearest of each, less its padding."""
    first = answers[0]
    if len(answers) == 1 and _is_whole(first.section, n_steps, n_pairs):
        return first.found
    layers = [_of_section(answer.section, answer.found, answer.section.steps) for answer in answers]
    owner = _nearest_layer(layers, n_steps, "clearance")
    clearance = _gathered(layers, owner, "clearance", np.full(n_steps, np.nan))
    touching = _gathered(layers, owner, "touching", np.zeros(n_steps, dtype=bool))
    hidden = (clearance > _least_unknown(layers, n_steps)) & ~touching
    every = [_every_of(answer, n_steps, n_pairs) for answer in answers]
    minima = [answer.found.measure_pair_minima for answer in answers]
    return _steps_of(
        layers,
        np.where(hidden, -1, owner),
        None if None in minima else _minima(answers, n_pairs),
        _every(every),
    )


def _of_section(
    section: Section, found: MeasuredSteps | ProvenMotion, rows: slice, rule: str = ""
) -> _Layer:
    return _Layer(found, rows, section.padding, section.places, rule)


def _least_unknown(layers: Sequence[_Layer], n_steps: int) -> np.ndarray:
    """(n,) [m] no pair is nearer of the layers that only have a bound."""
    least = np.full(n_steps, np.inf)
    for layer in layers:
        bound, known = layer.column("lower_bound"), layer.column("pair") >= 0
        np.minimum(least[layer.rows], bound, out=least[layer.rows], where=~known)
    return least


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
        least = no_minima(n_pairs)
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


def _every(found: Sequence[np.ndarray | None]) -> np.ndarray | None:
    """(n, pairs) [m] the least of some tables of every pair; None where one is not known."""
    known = [one for one in found if one is not None]
    return np.fmin.reduce(known) if len(known) == len(found) else None


def _every_of(answer: SectionAnswer, n_steps: int, n_pairs: int) -> np.ndarray | None:
    """(n, pairs) [m] the clearance of each pair at each step; NaN where a section does not measure it."""
    if answer.found.every is None:
        return None
    every = np.full((n_steps, n_pairs), np.nan)
    where = np.ix_(np.arange(n_steps)[answer.section.steps], answer.section.places)
    every[where] = answer.found.every - answer.section.padding
    return every


def joined_certificates(
    answers: Sequence[SectionAnswer], n_steps: int, rule: str
) -> ProvenMotion | None:
    """The certificates of some sections as one of all intervals; infinite where they say nothing."""
    first = answers[0]
    if first.certificate is None:
        return None
    whole = first.section.padding == 0.0 and first.section.tied
    if len(answers) == 1 and whole and first.section.phase.n_steps == n_steps:
        places = first.section.places
        if rule == DEFAULT and np.array_equal(places, np.arange(len(places))):
            return first.certificate
    layers = []
    for answer in answers:
        assert answer.certificate is not None
        phase = answer.section.phase
        n_rows = phase.n_steps if phase.last == n_steps - 1 else phase.n_steps - 1
        rows = slice(phase.first, phase.first + n_rows)
        layers.append(_of_section(answer.section, answer.certificate, rows, rule))
    return _proof_of(layers, _nearest_layer(layers, n_steps, "upper_bound"))


def _least_proof(layers: Sequence[_Layer], n_steps: int) -> ProvenMotion:
    """The least of what is proven of all rules; of rules that touch the first."""
    touching = np.array([layer.column("touching") for layer in layers])
    uppers = np.array([layer.column("upper_bound") for layer in layers])
    return _proof_of(layers, np.argmin(np.where(touching, -np.inf, uppers), axis=0))


def _worst_rule(rules: Sequence[RuleAnswer], n_steps: int) -> np.ndarray:
    """(n,) of each step the rule of the most critical row, then nearest to its fail limit; the first of those
    alike.
    """
    every = slice(0, n_steps)
    codes = np.array([sample_codes(rule.measurement, rule.limits, every) for rule in rules])
    margins = np.array([_or_far(r.measurement.clearance) - r.limits.fail for r in rules])
    margins[codes < codes.max(axis=0)] = np.inf
    unknown = np.isinf(margins).all(axis=0)
    bounds = np.array([rule.measurement.lower_bound - rule.limits.fail for rule in rules])
    return np.where(unknown, np.argmin(bounds, axis=0), np.argmin(margins, axis=0))


def _or_far(clearance: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(clearance), np.inf, clearance)


def every_pair(case: Case, pairs: Sequence[Pair], judged: RunAnswer) -> EveryPair | None:
    """The clearance of every pair at every step; None if that was not asked for."""
    every = judged.found.every
    if every is None:
        return None
    own = [(rule.name, rule.measurement.every) for rule in judged.rules]
    by_rule = tuple((name, found) for name, found in own if found is not None)
    return EveryPair(*pair_names(case, pairs), every, sides_of(case), by_rule)


def cut_throughout(
    case: Case, pairs: Sequence[Pair], rules: Sequence[MeasuredRule]
) -> list[Omission]:
    """The pairs of which the paper's method says nothing at any step; none for the exact method."""
    found = rules[0].measurement
    if len(rules) > 1 or not found.may_cut_pairs or found.measure_pair_minima is None:
        return []
    links, obstacles = pair_names(case, pairs)
    cut = np.flatnonzero(np.isinf(found.measure_pair_minima(None).clearance))
    return [Omission(links[i], obstacles[i], CUT) for i in cut]
