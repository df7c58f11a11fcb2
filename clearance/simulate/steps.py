"""Turns measurements into the table of steps and the list of pair minima that everybody reads."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from functools import cached_property

import numpy as np
import pyarrow as pa

from clearance.simulate.measure import Measurement
from clearance.simulate.record import Certificate, PairMinimum, StepContact
from clearance.world.case import Case, Limits, Unmeasured
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


class Status(StrEnum):
    """How a step stands against the limits, worst last."""

    CLEAR = "clear"
    NEAR = "near"
    VIOLATED = "violated"
    CONTACT = "contact"


STATUSES = tuple(Status)


def status_codes(
    clearance: np.ndarray, limits: Limits, certificate: Certificate | None = None
) -> np.ndarray:
    """(n,) indices into `STATUSES`: contact at 0, violated below `fail`, near below `warn`.

    With a certificate, row i judges the motion from step i to i + 1 by its lower bound; contact is what was
    really seen.
    """
    seen = clearance if certificate is None else certificate.upper_bound
    proven = clearance if certificate is None else certificate.lower_bound
    below = [seen <= 0.0, proven < limits.fail, proven < limits.warn]
    return np.select(below, [3, 2, 1], default=0)


def step_table(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    found: Measurement,
    *,
    certificate: Certificate | None = None,
    with_error: bool = False,
    contacts: Sequence[StepContact] = (),
) -> pa.Table:
    """One row a step; columns as in `Record.steps`, null where only a bound is known."""
    links, obstacles = pair_names(case, pairs)
    columns = {
        "step": pa.array(np.arange(len(found.clearance))),
        "time": pa.array(motions[0].times),
        "clearance": pa.array(found.clearance, from_pandas=True),
        "link": _names(links, found.pair),
        "obstacle": _names(obstacles, found.pair),
    }
    for i_side, side in enumerate(("link", "obstacle")):
        for i_axis, axis in enumerate("xyz"):
            columns[f"{side}_{axis}"] = pa.array(
                found.points[:, i_side, i_axis], from_pandas=True
            )
    codes = status_codes(found.clearance, case.limits, certificate)
    undecided = (found.pair < 0) & (found.lower_bound < case.limits.warn)
    columns["status"] = _names([str(status) for status in STATUSES], np.where(undecided, -1, codes))
    if certificate is not None:
        columns["lower_bound"] = pa.array(certificate.lower_bound)
    elif (found.pair < 0).any():
        columns["lower_bound"] = pa.array(found.lower_bound)
    if with_error:
        columns["tracking_error"] = pa.array(np.max([m.tracking_error for m in motions], axis=0))
    columns |= _contact_columns(len(found.clearance), contacts)
    return pa.table(columns)


def _contact_columns(n_steps: int, contacts: Sequence[StepContact]) -> dict[str, pa.Array]:
    """The penetration of the deepest pair and the volume of all, step by step; null without contact."""
    depth, volume, none = np.zeros(n_steps), np.zeros(n_steps), np.ones(n_steps, dtype=bool)
    for row in contacts:
        depth[row.step] = max(depth[row.step], row.found.penetration)
        volume[row.step] += row.found.volume
        none[row.step] = False
    return {"penetration": pa.array(depth, mask=none), "volume": pa.array(volume, mask=none)}


class PairMinima(Sequence[PairMinimum]):
    """The least clearance of every pair over the run, least first, found when first looked at.

    Empty if less was asked for. Ties are in the order of the pairs.
    """

    def __init__(
        self, case: Case, motions: Sequence[Motion], pairs: Sequence[Pair], found: Measurement
    ) -> None:
        self._names = pair_names(case, pairs)
        self._times = motions[0].times
        self._find = found.find_minima

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, index: int | slice) -> PairMinimum | tuple[PairMinimum, ...]:
        return self._rows[index]

    @cached_property
    def _rows(self) -> tuple[PairMinimum, ...]:
        if self._find is None:
            return ()
        links, obstacles = self._names
        found = self._find()
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


def every_pair_table(case: Case, pairs: Sequence[Pair], found: Measurement) -> pa.Table | None:
    """One row a step and pair: step, link, obstacle, clearance [m]; None if that was not asked for."""
    if found.every is None:
        return None
    n_steps, n_pairs = found.every.shape
    i_pair = pa.array(np.tile(np.arange(n_pairs, dtype=np.int32), n_steps))
    links, obstacles = pair_names(case, pairs)
    return pa.table(
        {
            "step": pa.array(np.repeat(np.arange(n_steps), n_pairs)),
            "link": pa.DictionaryArray.from_arrays(i_pair, links),
            "obstacle": pa.DictionaryArray.from_arrays(i_pair, obstacles),
            "clearance": pa.array(found.every.reshape(-1)),
        }
    )


def cut_throughout(case: Case, pairs: Sequence[Pair], found: Measurement) -> list[Unmeasured]:
    """The pairs of which the paper's method says nothing at any step; none for the exact method."""
    if not found.may_cut_pairs:
        return []
    links, obstacles = pair_names(case, pairs)
    cut = np.flatnonzero(np.isinf(found.find_minima().clearance))
    reason = "the paper's rules cut every polygon pair at every step"
    return [Unmeasured(links[i], obstacles[i], reason) for i in cut]


def pair_names(case: Case, pairs: Sequence[Pair]) -> tuple[list[str], list[str]]:
    """The link and the obstacle of each pair; links carry their robot's name where there are several."""
    several = len(case.robots) > 1
    links = []
    for pair in pairs:
        robot = case.robots[pair.i_robot].robot
        name = robot.bodies[pair.i_body].name
        links.append(f"{robot.name}/{name}" if several else name)
    return links, [case.obstacles[pair.i_obstacle].name for pair in pairs]


def _names(names: Sequence[str], codes: np.ndarray) -> pa.Array:
    return pa.array(names, type=pa.string()).take(pa.array(codes, mask=codes < 0))
