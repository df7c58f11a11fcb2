"""Turns measurements into the table of steps and the list of pair minima that everybody reads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from functools import cached_property
from typing import overload

import numpy as np
import pyarrow as pa

from clearance.simulate.contact_columns import no_contact_columns
from clearance.simulate.measure import Measurement
from clearance.simulate.names import pair_names
from clearance.simulate.parts import blocks
from clearance.simulate.record import Certificate, EveryPair, PairMinimum
from clearance.world.case import Case, Limits, Omission
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


class Status(StrEnum):
    """How a step stands against the limits, worst last."""

    CLEAR = "clear"
    NEAR = "near"
    VIOLATED = "violated"
    CONTACT = "contact"


STATUSES = tuple(Status)


def status_codes(clearance: np.ndarray, limits: Limits) -> np.ndarray:
    """(n,) indices into `STATUSES`: contact at 0, violated below `fail`, near below `warn`; 0 where unknown."""
    below = [clearance <= 0.0, clearance < limits.fail, clearance < limits.warn]
    return np.select(below, [3, 2, 1], default=0)


def status_of(clearance: float, limits: Limits) -> str:
    """How one clearance [m] stands against the limits."""
    return str(STATUSES[int(status_codes(np.array(clearance), limits))])


def motion_codes(certificate: Certificate, limits: Limits, steps: slice) -> np.ndarray:
    """(k,) what is proven of the motion from each of `steps` to the next, as indices into `STATUSES`.

    Below a limit is what is not proven to stay above it; where only distances below the limit were asked about,
    what is really seen below it. Contact is what is seen.
    """
    lower, upper = certificate.lower_bound[steps], certificate.upper_bound[steps]
    seen = certificate.pair[steps] >= 0
    below = [(lower < limit) & (seen | (upper >= limit)) for limit in (limits.fail, limits.warn)]
    return np.select([upper <= 0.0, *below], [3, 2, 1], default=0)


def between_of(steps: pa.Table) -> np.ndarray:
    """(n,) True where the status in a table of steps is that of the motion to the next step."""
    if "between" not in steps.column_names:
        return np.zeros(steps.num_rows, dtype=bool)
    return steps["between"].to_numpy()


def step_table(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    found: Measurement,
    *,
    certificate: Certificate | None = None,
    with_error: bool = False,
) -> Iterator[pa.Table]:
    """One row a step; columns as in `Record.steps`, null where only a bound is known. In blocks of steps."""
    names = pair_names(case, pairs)
    n_steps = len(found.clearance)
    bounded = any((found.pair[block] < 0).any() for block in blocks(n_steps))
    for block in blocks(n_steps):
        columns = _measured_columns(names, found, motions[0].times, block)
        codes = _sample_codes(found, case.limits, block)
        if certificate is not None:
            columns |= _proven_columns(found, certificate, block)
            codes, between = _with_motion(found, case.limits, certificate, block, codes)
            columns["between"] = pa.array(between)
        columns["status"] = _names([str(status) for status in STATUSES], codes)
        if certificate is None and bounded:
            columns["lower_bound"] = pa.array(found.lower_bound[block])
        if with_error:
            errors = [motion.tracking_error[block] for motion in motions]
            columns["tracking_error"] = pa.array(np.max(errors, axis=0))
        columns |= no_contact_columns(block.stop - block.start)
        yield pa.table(columns)


def _sample_codes(found: Measurement, limits: Limits, steps: slice) -> np.ndarray:
    """(k,) the status of each of `steps` by itself; -1 where its bound does not decide."""
    undecided = (found.pair[steps] < 0) & (found.lower_bound[steps] < limits.warn)
    return np.where(undecided, -1, status_codes(found.clearance[steps], limits))


def _with_motion(
    found: Measurement, limits: Limits, certificate: Certificate, steps: slice, own: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The status of each of `steps`, or of the motion to the next where that is worse than at both of its ends;
    and whether it is."""
    after = _sample_codes(found, limits, slice(steps.start + 1, steps.stop + 1))
    after = np.append(after, [-1] * (len(own) - len(after)))
    motion = motion_codes(certificate, limits, steps)
    between = (motion > 0) & (motion > np.maximum(own, after))
    return np.where(between, motion, own), between


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


def _measured_columns(
    names: tuple[list[str], list[str]], found: Measurement, times: np.ndarray, block: slice
) -> dict[str, pa.Array]:
    links, obstacles = names
    columns = {
        "step": pa.array(np.arange(block.start, block.stop)),
        "time": pa.array(times[block]),
        "clearance": pa.array(found.clearance[block], from_pandas=True),
        "link": _names(links, found.pair[block]),
        "obstacle": _names(obstacles, found.pair[block]),
    }
    for i_side, side in enumerate(("link", "obstacle")):
        for i_axis, axis in enumerate("xyz"):
            values = found.points[block, i_side, i_axis]
            columns[f"{side}_{axis}"] = pa.array(values, from_pandas=True)
    return columns


class PairMinima(Sequence[PairMinimum]):
    """The least clearance of every pair over the run, least first, found when first looked at.

    Empty if less was asked for. Ties are in the order of the pairs. Of the first few nothing else is measured.
    """

    def __init__(
        self, case: Case, motions: Sequence[Motion], pairs: Sequence[Pair], found: Measurement
    ) -> None:
        self._names = pair_names(case, pairs)
        self._times = motions[0].times
        self._find = found.measure_pair_minima

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
        if self._find is None:
            return ()
        links, obstacles = self._names
        found = self._find(most)
        return tuple(
            PairMinimum(
                link=links[i],
                obstacle=obstacles[i],
                clearance=float(found.clearance[i]),
                step=int(found.step[i]),
                time=float(self._times[found.step[i]]),
                point_link=tuple(found.points[i, 0].tolist()),
                point_obstacle=tuple(found.points[i, 1].tolist()),
            )
            for i in np.argsort(found.clearance, kind="stable")
            if np.isfinite(found.clearance[i])  # the paper's rules can cut a pair at every step
        )


def every_pair(case: Case, pairs: Sequence[Pair], found: Measurement) -> EveryPair | None:
    """The clearance of every pair at every step; None if that was not asked for."""
    return None if found.every is None else EveryPair(*pair_names(case, pairs), found.every)


def cut_throughout(case: Case, pairs: Sequence[Pair], found: Measurement) -> list[Omission]:
    """The pairs of which the paper's method says nothing at any step; none for the exact method."""
    if not found.may_cut_pairs or found.measure_pair_minima is None:
        return []
    links, obstacles = pair_names(case, pairs)
    cut = np.flatnonzero(np.isinf(found.measure_pair_minima(None).clearance))
    reason = "the paper's rules cut every polygon pair at every step"
    return [Omission(links[i], obstacles[i], reason) for i in cut]


def _names(names: Sequence[str], codes: np.ndarray) -> pa.Array:
    return pa.array(names, type=pa.string()).take(pa.array(codes, mask=codes < 0))
