"""The table of steps, made of what was found of each: plain data in, a table out. Not for: measuring."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.record.certificate import Certificate, motion_codes
from clearance.record.measurement import Measurement
from clearance.record.names import SIDES, BodyNames, columns_of
from clearance.record.rows.blocks import blocks
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import STATUSES, sample_codes
from clearance.record.table import Column, Names, Table
from clearance.world.case import Case
from clearance.world.made_moves import MadeMoves
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

REMAINING = ("proven", "expected")
"""The columns of what a budget leaves [m]."""


@dataclass(frozen=True, eq=False)
class RunAnswer:
    """What was found of a run.

    Attributes:
        rules: what each rule comes to, in the order of the case; at least one.
        found: of each step the most critical row. rule: (n,) the place in `rules` of what judged it, or None
            where there is one rule.
        nearest: of each step the nearest pair of all, whatever judges it; `found` where there is one rule.
        certificate: over all rules; None where nothing is proven.
    """

    rules: Sequence[RuleAnswer]
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
        decide, or no rule has a pair to measure.
        """
        found = [rule.measurement for rule in self.rules]
        codes = np.array([sample_codes(r.measurement, r.limits, steps) for r in self.rules])
        undecided = (codes < 0).any(axis=0) & (codes.max(axis=0) <= 0)
        empty = np.all(
            [(m.pair[steps] < 0) & np.isinf(m.lower_bound[steps]) for m in found], axis=0
        )
        return np.where(undecided | empty, -1, codes.max(axis=0))

    def motion_codes(self, steps: slice) -> np.ndarray:
        """(k,) what is proven of the motion from each of some steps to the next, the worst of all rules."""
        proven = [(one, one.certificate) for one in self.rules if one.certificate]
        return np.max([_seen_codes(one, own, steps) for one, own in proven], axis=0)


@dataclass(frozen=True, eq=False)
class StepColumns:
    """All that the table of a run's steps is made of.

    Attributes:
        remaining: (n,) each [m] what a budget leaves, proven and expected; None without one.
    """

    case: Case
    motions: Sequence[Motion]
    pairs: Sequence[Pair]
    judged: RunAnswer
    with_error: bool = False
    remaining: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def n_steps(self) -> int:
        """How many rows there are."""
        return len(self.judged.found.clearance)

    def batches(self) -> Iterator[Table]:
        """One row a step; columns as in `Record.rows`, NaN where only a bound is known. In blocks of steps."""
        judged, found = self.judged, self.judged.found
        names, certificate = BodyNames.of(self.case, self.pairs), judged.certificate
        moves = MadeMoves.of(self.case)
        bounded = any((found.pair[block] < 0).any() for block in blocks(self.n_steps))
        for block in blocks(self.n_steps):
            columns = _measured_columns(names, found, self.motions[0].times, block)
            codes = judged.sample_codes(block)
            if certificate is not None:
                columns |= _proven_columns(found, certificate, block)
                codes, between = _with_motion(judged, block, codes)
                columns["between"] = between
            columns["status"] = Names(codes, [str(status) for status in STATUSES])
            if certificate is None and bounded:
                columns["lower_bound"] = found.lower_bound[block]
            if self.remaining is not None:  # NaN where nothing is expected
                columns |= {
                    k: each[block] for k, each in zip(REMAINING, self.remaining, strict=True)
                }
            if self.with_error:
                errors = [motion.tracking_error[block] for motion in self.motions]
                columns["tracking_error"] = np.max(errors, axis=0)
            columns |= _move_columns(moves, self.motions[0].times[block])
            unknown = np.full(block.stop - block.start, np.nan)
            columns |= {"penetration": unknown, "volume": unknown}
            yield Table(columns | _sides(names, columns) | _rule_columns(names, judged, block))


def _seen_codes(rule: RuleAnswer, own: Certificate, steps: slice) -> np.ndarray:
    """(k,) what is proven of the motion; 0 where a distance of 0 was asked about, as it is the least of others."""
    asked = _is_unseen(rule.measurement, own, steps) & (own.upper_bound[steps] <= 0.0)
    return np.where(asked, 0, motion_codes(own, rule.limits, steps))


def _is_unseen(found: Measurement, certificate: Certificate, steps: slice) -> np.ndarray:
    """(k,) True where the upper bound of the motion to the next step is no distance that was seen."""
    seen = certificate.pair[steps] >= 0
    known = found.pair[steps.start : steps.stop + 1] >= 0
    after = np.append(known[1:], known[-1:])[: len(seen)]
    return ~(seen | (known[: len(seen)] & after))


def _with_motion(judged: RunAnswer, steps: slice, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The status of each of `steps`, or of the motion to the next where that is worse than at both of its ends;
    and whether it is."""
    after = judged.sample_codes(slice(steps.start + 1, steps.stop + 1))
    after = np.append(after, [-1] * (len(own) - len(after)))
    motion = judged.motion_codes(steps)
    between = (motion > 0) & (motion > np.maximum(own, after))
    return np.where(between, motion, own), between


def _sides(names: BodyNames, columns: dict[str, Column]) -> dict[str, Column]:
    """The two bodies under the names that every run has, where the run has names of its own for them."""
    if names.sides == SIDES:
        return {}
    sides = zip(names.columns, columns_of(SIDES), strict=True)
    return {general: columns[own] for own, general in sides}


def _rule_columns(names: BodyNames, judged: RunAnswer, steps: slice) -> dict[str, Column]:
    """What judged each step, and where there are several rules the nearest pair of all."""
    rules = Names(judged.rules_at(steps), [rule.name for rule in judged.rules])
    columns: dict[str, Column] = {"rule": rules}
    if judged.rule is not None:
        near = judged.nearest
        columns |= {
            "nearest_clearance": near.clearance[steps],
            "nearest_a": Names(near.pair[steps], names.a),
            "nearest_b": Names(near.pair[steps], names.b),
        }
    if judged.found.times_b is not None:
        columns["time_b"] = judged.found.times_b[steps]
    return columns


def _proven_columns(
    found: Measurement, certificate: Certificate, steps: slice
) -> dict[str, Column]:
    """What is proven of the motion from each of `steps` to the next, and the least distance seen there."""
    uppers = np.where(_is_unseen(found, certificate, steps), np.nan, certificate.upper_bound[steps])
    return {"lower_bound": certificate.lower_bound[steps], "upper_bound": uppers}


def _move_columns(moves: MadeMoves, times: np.ndarray) -> dict[str, Column]:
    """The move that is made at each time [s]; nothing without a program."""
    return {"move": Names(*moves.codes(times))} if moves.robots else {}


def _measured_columns(
    names: BodyNames, found: Measurement, times: np.ndarray, block: slice
) -> dict[str, Column]:
    first, second, *places = names.columns
    points = found.points[block].reshape(-1, 6)
    columns: dict[str, Column] = {
        "step": np.arange(block.start, block.stop),
        "time": times[block],
        "clearance": found.clearance[block],
        first: Names(found.pair[block], names.a),
        second: Names(found.pair[block], names.b),
    }
    return columns | {name: points[:, i] for i, name in enumerate(places)}
