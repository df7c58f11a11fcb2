"""What was known of a run, and is not of another: its proof, bodies, pairs, limits, outlines, findings.

Not for: the findings and doubts that both can have (`comparison`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from functools import cache

from clearance.findings.finding import PROFILE, Finding
from clearance.findings.findings_file import FindingList
from clearance.findings.measurement_conditions import (
    MeasuredPairs,
    MeasuredRule,
    MeasurementConditions,
)
from clearance.record.wording import count, limit_mm, seconds
from clearance.world.notice import listed
from clearance.world.rules import matches

TIME = 1e-6
"""[s] Times that differ by less are the same, summed otherwise."""

SIZE = 1e-6
"""[m] Sides of a box round a shape that differ by less are the same, rounded otherwise."""

NEAREST = "nearest"
"""The mode of a profile whose limit is the greatest distance; the text of its finding begins with the mode."""

_Limits = tuple[tuple[str, float], ...]
"""The fail limits [m] of a pair, each with when it holds; the last one holds otherwise."""


def known_less(before: FindingList, now: FindingList) -> tuple[str, ...]:
    """What is not known of now as it was before, one line each."""
    old, new = before.measured, now.measured
    found = (less(old, new) for less in (_proven_less, _measured_less, _counted_less, _asked_less))
    return tuple(itertools.chain(*found, _present_less(before, now), _listed_less(before, now)))


def shorter_or_smaller(before: FindingList, now: FindingList) -> Iterator[str]:
    """How motion or obstacles are less than before, one line each: they may be others, and yet nothing is lost."""
    still = [name for name in before.measured.moving if name not in now.measured.moving]
    if still:
        yield f"shorter: what moved before has no motion any more: {listed(still)}"
    if now.duration < before.duration:
        yield f"shorter: the run takes {seconds(now.duration)}, and took {seconds(before.duration)}"
    if now.n_moves < before.n_moves:
        yield f"shorter: programs make {count(now.n_moves, 'move')}, and made {before.n_moves:,}"
    old, new = before.measured.sizes, now.measured.sizes
    smaller = [
        f"{name} {_size_text(new[name])}, was {_size_text(was)}"
        for name, was in old.items()
        if any(a < b - SIZE for a, b in zip(new.get(name, was), was, strict=True))
    ]
    if smaller:
        yield f"smaller: {listed(smaller)}"


def _size_text(sides: tuple[float, float, float]) -> str:
    return " x ".join(limit_mm(side) for side in sides) + " mm"


def _proven_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    if (old.basis, new.basis) == ("motion", "samples"):
        yield "the motion was proven, and now only the samples are measured"
    if old.basis != "pose" == new.basis:
        yield "a motion was checked, and now only a single pose is"
    if (old.method, new.method) == ("exact", "paper"):
        yield "the method was exact, and is paper, without guarantee"
    if _slack(new) < _slack(old):
        yield f"clock slack was {slack_text(old)}, and is {slack_text(new)}: other clocks are not covered"
    if old.tolerances and not new.tolerances:
        yield "tolerances were counted, and are not given any more"
    elif smaller := [
        f"{name} {new.errors.get(name, 0.0):g}, was {was:g}"
        for name, was in old.errors.items()
        if new.errors.get(name, 0.0) < was
    ]:
        yield f"tolerances are smaller (m, rad, s): {listed(smaller)}"


def _measured_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    """Bodies that are gone, and pairs that were measured and are left out, for some time at least."""
    there = {*_bodies(new.pairs), *_bodies(new.unmeasured)}
    gone = sorted({*_bodies(old.pairs)} - there)
    if gone:
        yield f"not measured any more: {listed(gone)}"
    known = _pairs(old.unmeasured)
    lost = {
        pair: None
        for pair in itertools.chain.from_iterable(new.unmeasured)
        if tuple(sorted(pair)) not in known
        and (old.has_body(pair[0]) if pair[1] == "*" else old.has_pair(*pair))
    }
    left_out = {*gone, *(a for a, b in lost if b == "*")}
    told = {tuple(sorted(pair)) for pair in lost}
    missing = _pairs(old.pairs) - _pairs(new.pairs) - told
    pairs = [*lost, *sorted(pair for pair in missing if not left_out & {*pair})]
    if pairs:
        yield f"not measured as before: {listed([f'{a} - {b}' for a, b in pairs])}"


def _counted_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    """Joints beyond their limits that fail no longer, and bodies with less padding."""
    if (old.joints, new.joints) == ("fail", "warn"):
        yield "joints beyond their limits no longer fail"
    there = {*_bodies(new.pairs)}
    for name, was in old.paddings.items():
        is_now = new.paddings.get(name, 0.0)
        if is_now < was and name in there:
            yield f"padding of {name}: now {limit_mm(is_now)} mm, and was {limit_mm(was)} mm"


def _asked_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    """Pairs that may come nearer than before, by their fail limits."""
    if old.rules == new.rules:
        return
    of_old, of_new = _Judge(old), _Judge(new)
    softer: dict[tuple[_Limits, _Limits], list[str]] = {}
    for a, b in sorted(_pairs(old.pairs) & _pairs(new.pairs)):
        was, is_now = of_old.limits(a, b), of_new.limits(a, b)
        if _is_softer(was, is_now):
            softer.setdefault((was, is_now), []).append(f"{a} - {b}")
    for (was, is_now), pairs in softer.items():
        yield f"fail limit of {listed(pairs, 1)}: now {_limits_text(is_now)}, and was {_limits_text(was)}"


class _Judge:
    """Which fail limits a run has for a pair."""

    def __init__(self, conditions: MeasurementConditions) -> None:
        self._rules = conditions.rules
        self._prefixes = [f"{robot.name}/" for robot in conditions.robots]
        self._sides = cache(self._sides_of)
        self._limits = cache(self._limits_of)

    def limits(self, a: str, b: str) -> _Limits:
        """Those of a pair."""
        return self._limits(self._sides(a), self._sides(b))

    def _sides_of(self, body: str) -> frozenset[tuple[int, int]]:
        """The patterns that are of a body: the number of each one's rule, and its place there."""
        names = [body, *(body.removeprefix(one) for one in self._prefixes)]
        return frozenset(
            (i, side)
            for i, rule in enumerate(self._rules)
            for side, pattern in enumerate(rule.between)
            if any(matches(name, pattern) for name in names)
        )

    def _limits_of(self, a: frozenset[tuple[int, int]], b: frozenset[tuple[int, int]]) -> _Limits:
        """The last rule counts, as long as it holds, then the one before it."""
        found = []
        for i, rule in reversed([*enumerate(self._rules)]):
            if _is_of(rule, i, a, b):
                found.append((rule.when, rule.fail))
                if not rule.when:
                    break
        return tuple(found)


def _is_of(
    rule: MeasuredRule, i: int, a: frozenset[tuple[int, int]], b: frozenset[tuple[int, int]]
) -> bool:
    orders = ((a, b), (b, a))
    return not rule.between or any((i, 0) in one and (i, 1) in two for one, two in orders)


def _is_softer(old: _Limits, new: _Limits) -> bool:
    """True if a limit is below the one before; where they hold at other times, unless none can be."""
    if [when for when, _ in old] == [when for when, _ in new]:
        return any(is_now < was for (_, was), (_, is_now) in zip(old, new, strict=True))
    return min(fail for _, fail in new) < max(fail for _, fail in old)


def _limits_text(limits: _Limits) -> str:
    return ", else ".join(f"{limit_mm(fail)} mm {when}".strip() for when, fail in limits)


def _present_less(before: FindingList, now: FindingList) -> Iterator[str]:
    """Robots and obstacles that are in the cell for less time than before; not those that are new."""
    old = before.measured
    known = {*_bodies(old.pairs), *(robot.name for robot in old.robots)}
    for name, present in now.measured.present.items():
        was = old.present.get(name, before.duration)
        if name in known and present < was - TIME:
            yield f"{name} is in the cell for {seconds(present)}, and was for {seconds(was)}"


def _listed_less(before: FindingList, now: FindingList) -> Iterator[str]:
    """Outlines that are not checked, or otherwise, and findings that may be missing, where they were not before.

    A run that passes is missing none that fails it.
    """
    old, new = _outlines(before), _outlines(now)
    lost = sorted(old.keys() - new.keys())
    if lost and not now.not_listed:
        yield f"profile not checked as before: {listed(lost)}"
    for name in sorted(old.keys() & new.keys()):
        was, is_now = old[name], new[name]
        if was.text != is_now.text:
            yield f"profile {name}: {is_now.text}; and was {was.text}"
        greatest = was.text.startswith(NEAREST)
        if was.fail < is_now.fail if greatest else is_now.fail < was.fail:
            yield f"limit of profile {name}: now {limit_mm(is_now.fail)} mm, and was {limit_mm(was.fail)} mm"
    if not any(finding.fails for finding in now.findings):
        return
    if now.incomplete and not before.incomplete:
        yield f"findings may be missing: {now.incomplete}"
    if now.not_listed > before.not_listed:
        yield f"{now.not_listed:,} findings are not listed"


def _outlines(listed_in: FindingList) -> dict[str, Finding]:
    return {one.rule: one for one in listed_in.findings if one.kind == PROFILE}


def _bodies(blocks: Iterable[MeasuredPairs]) -> Iterator[str]:
    return (name for block in blocks for name in (*block.a, *block.b))


def _pairs(blocks: Iterable[MeasuredPairs]) -> set[tuple[str, ...]]:
    return {tuple(sorted(pair)) for block in blocks for pair in block}


def _slack(conditions: MeasurementConditions) -> float:
    """[s]"""
    return float("inf") if conditions.clock_slack == "not tied" else float(conditions.clock_slack)


def slack_text(conditions: MeasurementConditions) -> str:
    """How far clocks may be apart."""
    slack = conditions.clock_slack
    return slack if isinstance(slack, str) else f"{slack:g} s"
