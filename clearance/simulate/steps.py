"""Turns measurements into the table of steps and the list of pair minima that everybody reads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import overload

import numpy as np
import pyarrow as pa

from clearance.simulate.certificate import Certificate
from clearance.simulate.contact.columns import no_contact_columns
from clearance.simulate.every_pair import EveryPair
from clearance.simulate.measurement import Measurement
from clearance.simulate.name_codes import names_of
from clearance.simulate.names import SIDES, BodyNames, columns_of, pair_names, sides_of
from clearance.simulate.parts import blocks
from clearance.simulate.record import PairMinimum
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.run_answer import RunAnswer
from clearance.simulate.status import STATUSES
from clearance.world.case import Case, Omission
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

CUT = "the paper's rules cut every polygon pair at every step"
"""Why the paper's method says nothing of a pair."""


def between_of(steps: pa.Table) -> np.ndarray:
    """(n,) True where the status in a table of steps is that of the motion to the next step."""
    if "between" not in steps.column_names:
        return np.zeros(steps.num_rows, dtype=bool)
    return steps["between"].to_numpy()


def step_table(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    judged: RunAnswer,
    *,
    with_error: bool = False,
    left: tuple[np.ndarray, np.ndarray] | None = None,
) -> Iterator[pa.Table]:
    """One row a step; columns as in `Record.steps`, null where only a bound is known. In blocks of steps.

    Args:
        left: (n,) each [m] what a budget leaves, proven and expected; None without one.
    """
    names, found, certificate = BodyNames.of(case, pairs), judged.found, judged.certificate
    n_steps = len(found.clearance)
    bounded = any((found.pair[block] < 0).any() for block in blocks(n_steps))
    for block in blocks(n_steps):
        columns = _measured_columns(names, found, motions[0].times, block)
        codes = judged.sample_codes(block)
        if certificate is not None:
            columns |= _proven_columns(found, certificate, block)
            codes, between = _with_motion(judged, block, codes)
            columns["between"] = pa.array(between)
        columns["status"] = names_of(codes, [str(status) for status in STATUSES])
        if certificate is None and bounded:
            columns["lower_bound"] = pa.array(found.lower_bound[block])
        if left is not None:
            columns |= _left_columns(*left, block)
        if with_error:
            errors = [motion.tracking_error[block] for motion in motions]
            columns["tracking_error"] = pa.array(np.max(errors, axis=0))
        columns |= no_contact_columns(block.stop - block.start)
        yield pa.table(columns | _sides(names, columns) | _rule_columns(names, judged, block))


def _with_motion(judged: RunAnswer, steps: slice, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The status of each of `steps`, or of the motion to the next where that is worse than at both of its ends;
    and whether it is."""
    after = judged.sample_codes(slice(steps.start + 1, steps.stop + 1))
    after = np.append(after, [-1] * (len(own) - len(after)))
    motion = judged.motion_codes(steps)
    between = (motion > 0) & (motion > np.maximum(own, after))
    return np.where(between, motion, own), between


def _sides(names: BodyNames, columns: dict[str, pa.Array]) -> dict[str, pa.Array]:
    """The two bodies under the names that every run has, where the run has names of its own for them."""
    if names.sides == SIDES:
        return {}
    told = zip(names.columns, columns_of(SIDES), strict=True)
    return {general: columns[own] for own, general in told}


def _rule_columns(names: BodyNames, judged: RunAnswer, steps: slice) -> dict[str, pa.Array]:
    """What judged each step, and where there are several rules the nearest pair of all."""
    columns = {"rule": names_of(judged.rules_at(steps), [rule.name for rule in judged.rules])}
    if judged.rule is not None:
        near = judged.nearest
        columns |= {
            "nearest_clearance": pa.array(near.clearance[steps], from_pandas=True),
            "nearest_a": names_of(near.pair[steps], names.a),
            "nearest_b": names_of(near.pair[steps], names.b),
        }
    if judged.found.times_b is not None:
        columns["time_b"] = pa.array(judged.found.times_b[steps], from_pandas=True)
    return columns


def _proven_columns(
    found: Measurement, certificate: Certificate, steps: slice
) -> dict[str, pa.Array]:
    """What is proven of the motion from each of `steps` to the next, and the least distance seen there."""
    seen = certificate.pair[steps] >= 0
    known = found.pair[steps.start : steps.stop + 1] >= 0
    after = np.append(known[1:], known[-1:])[: len(seen)]
    unseen = ~(seen | (known[: len(seen)] & after))
    return {
        "lower_bound": pa.array(certificate.lower_bound[steps]),
        "upper_bound": pa.array(certificate.upper_bound[steps], mask=unseen),
    }


def _left_columns(proven: np.ndarray, expected: np.ndarray, steps: slice) -> dict[str, pa.Array]:
    """What a budget leaves of each step; null where nothing is expected of it."""
    return {
        "proven": pa.array(proven[steps]),
        "expected": pa.array(expected[steps], from_pandas=True),
    }


def _measured_columns(
    names: BodyNames, found: Measurement, times: np.ndarray, block: slice
) -> dict[str, pa.Array]:
    first, second, *places = names.columns
    points = found.points[block].reshape(-1, 6)
    return {
        "step": pa.array(np.arange(block.start, block.stop)),
        "time": pa.array(times[block]),
        "clearance": pa.array(found.clearance[block], from_pandas=True),
        first: names_of(found.pair[block], names.a),
        second: names_of(found.pair[block], names.b),
    } | {name: pa.array(points[:, i], from_pandas=True) for i, name in enumerate(places)}


class PairMinima(Sequence[PairMinimum]):
    """The least clearance of every pair over the run, least first, found when first looked at.

    Empty if less was asked for. Ties are in the order of the pairs. Of the first few nothing else is measured. A
    pair that different rules judge at different times is there once for each.
    """

    def __init__(
        self,
        case: Case,
        motions: Sequence[Motion],
        pairs: Sequence[Pair],
        rules: Sequence[RuleAnswer],
    ) -> None:
        self._names = pair_names(case, pairs)
        self._times = motions[0].times
        self._rules = rules

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> PairMinimum: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[PairMinimum, ...]: ...

    def __getitem__(self, index: int | slice) -> PairMinimum | tuple[PairMinimum, ...]:
        if "_rows" not in self.__dict__ and isinstance(index, slice):
            if (
                (index.start, index.step) == (None, None)
                and index.stop is not None
                and index.stop > 0
            ):
                return self._found(index.stop)[index]
        return self._rows[index]

    @cached_property
    def _rows(self) -> tuple[PairMinimum, ...]:
        return self._found(None)

    def _found(self, most: int | None) -> tuple[PairMinimum, ...]:
        found = [row for rule in self._rules for row in self._of_rule(rule, most)]
        return tuple(sorted(found, key=lambda row: row.clearance))

    def _of_rule(self, rule: RuleAnswer, most: int | None) -> Iterator[PairMinimum]:
        find = rule.measurement.measure_pair_minima
        if find is None:
            return
        links, obstacles = self._names
        found = find(most)
        for i in np.argsort(found.clearance, kind="stable"):
            if np.isfinite(found.clearance[i]):  # the paper's rules can cut a pair at every step
                yield PairMinimum(
                    link=links[i],
                    obstacle=obstacles[i],
                    clearance=float(found.clearance[i]),
                    step=int(found.step[i]),
                    time=float(self._times[found.step[i]]),
                    point_link=tuple(found.points[i, 0].tolist()),
                    point_obstacle=tuple(found.points[i, 1].tolist()),
                    rule=rule.name,
                )


def every_pair(case: Case, pairs: Sequence[Pair], judged: RunAnswer) -> EveryPair | None:
    """The clearance of every pair at every step; None if that was not asked for."""
    every = judged.found.every
    if every is None:
        return None
    own = [(rule.name, rule.measurement.every) for rule in judged.rules]
    by_rule = tuple((name, found) for name, found in own if found is not None)
    return EveryPair(*pair_names(case, pairs), every, sides_of(case), by_rule)


def cut_throughout(case: Case, pairs: Sequence[Pair], found: Measurement) -> list[Omission]:
    """The pairs of which the paper's method says nothing at any step; none for the exact method."""
    if not found.may_cut_pairs or found.measure_pair_minima is None:
        return []
    links, obstacles = pair_names(case, pairs)
    cut = np.flatnonzero(np.isinf(found.measure_pair_minima(None).clearance))
    return [Omission(links[i], obstacles[i], CUT) for i in cut]
