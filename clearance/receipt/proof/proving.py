"""Goes through evidence and decides whether it proves what is claimed. Not for: finding evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from clearance.receipt.proof.halving import Halves
from clearance.receipt.proof.inside import (
    closed_faces,
    one_point_each,
    winds_about_none,
)
from clearance.receipt.proof.items import (
    BALLS,
    BYTE_DIRECTION,
    CUT_A,
    CUT_B,
    CUT_TIME,
    DEEPEST,
    LONG_DIRECTION,
    SHORT_DIRECTION,
    Items,
    cut,
    first_items,
)
from clearance.receipt.proof.motion_data import Shape, Stretch
from clearance.receipt.proof.separation import BYTE, LONG, SHORT, directions
from clearance.receipt.proof.stage import Stage, all_of_item

SIZES = ((BYTE_DIRECTION, BYTE), (SHORT_DIRECTION, SHORT), (LONG_DIRECTION, LONG))
"""The deeds that come with directions, and how large these are."""


class Failure(NamedTuple):
    """The first thing that is not proven: of which pair of a stretch, in which of the run's intervals, and why."""

    stretch: int
    pair: int
    interval: int
    reason: str


class Evidence(Protocol):
    """What is said of items, in the order in which they are come to."""

    def deeds(self, n: int) -> np.ndarray:
        """(n,) what is done with the next items."""
        ...

    def codes(self, n: int, most: int) -> np.ndarray:
        """(n, 2) the next directions of a size."""
        ...


class BadEvidence(ValueError):
    """Evidence that says what cannot be done."""


def failure_in(
    stretches: Sequence[Stretch],
    shapes: Sequence[Shape],
    halves: Halves,
    claims: np.ndarray,
    evidence: Evidence,
) -> Failure | None:
    """The first thing that the evidence does not prove; None if it proves all that is claimed.

    Raises:
        BadEvidence: it says what cannot be done.
    """
    for number, stretch in enumerate(stretches):
        stage = Stage(stretch, shapes, halves, claims)
        found = _of_stretch(stage, evidence) or one_inside(stage)
        if found is not None:
            pair, interval, reason = found
            return Failure(number, pair, stretch.first + interval, reason)
    return None


def _of_stretch(stage: Stage, evidence: Evidence) -> tuple[int, int, str] | None:
    stretch = stage.stretch
    items = first_items(len(stretch.pairs), stretch.n_intervals)
    while len(items.pair):
        deeds = evidence.deeds(len(items.pair))
        require_possible(stage, items, deeds)
        found = _first_unproven(stage, items, deeds, evidence)
        if found is not None:
            return found
        items = cut(items, deeds)
    return None


def _first_unproven(
    stage: Stage, items: Items, deeds: np.ndarray, evidence: Evidence
) -> tuple[int, int, str] | None:
    rows = [np.flatnonzero(deeds == deed) for deed in (BALLS, *dict(SIZES))]
    own, n_balls = items.of(np.concatenate(rows)), len(rows[0])
    u = np.zeros((3, len(own.pair)))
    u[:, n_balls:] = _directions(evidence, [len(r) for r in rows[1:]])
    beyond = stage.bounds(own, np.arange(len(own.pair)) >= n_balls, u)
    short = np.flatnonzero(~(beyond >= 0.0))
    if len(short):
        item, interval = own.rows()
        row = short[np.argmin(interval[short])]
        return int(own.pair[item[row]]), int(interval[row]), "not proven separate by its evidence"
    stage.note_separate(own)
    return None


def _directions(evidence: Evidence, counts: Sequence[int]) -> np.ndarray:
    """(3, k) the next so many directions of each size.

    Raises:
        BadEvidence: there are not so many, or one is none.
    """
    found = []
    for (_, most), count in zip(SIZES, counts, strict=True):
        codes = evidence.codes(count, most)
        require_codes(codes, most)
        found.append(directions(codes, most))
    return np.concatenate(found, axis=1)


def require_possible(stage: Stage, items: Items, deeds: np.ndarray) -> None:
    """Nothing, if each deed can be done.

    Raises:
        BadEvidence: with the first that cannot.
    """
    if deeds.max() > CUT_B:
        raise BadEvidence(f"deed {int(deeds.max())}")
    if (items.depth[deeds == CUT_TIME] >= DEEPEST).any():
        raise BadEvidence(f"an interval cut more than {DEEPEST} times")
    bodies = stage.stretch.pairs[items.pair]
    for deed, k, nodes in ((CUT_A, 0, items.node_a), (CUT_B, 1, items.node_b)):
        rows = np.flatnonzero(deeds == deed)
        if (stage.halves.sizes(bodies[rows, k], nodes[rows]) < 2).any():
            raise BadEvidence("a single face cut in two")


def require_codes(codes: np.ndarray, most: int) -> None:
    """Nothing, if codes stand for directions.

    Raises:
        BadEvidence: one does not.
    """
    if len(codes) and np.abs(codes.astype(np.int64)).max() > most:
        raise BadEvidence("a direction out of range")


def one_inside(stage: Stage) -> tuple[int, int, str] | None:
    """The first pair of which it is not proven that neither body is inside the other.

    While surfaces keep apart that does not change, so one moment is enough: one at which whole bodies are proven
    apart, or else the middle of the first interval.
    """
    claimed = stage.wanted > 0.0
    begins = claimed & ~np.pad(claimed, ((0, 0), (1, 0)))[:, :-1]
    for pair, start in np.argwhere(begins).tolist():
        stop = start + int(np.argmin(np.append(claimed[pair, start:], False)))
        if stage.separate[pair, start:stop].any():
            continue
        if not _outside(stage, pair, start):
            return pair, start, "not proven outside each other"
    return None


def _outside(stage: Stage, pair: int, interval: int) -> bool:
    bodies = stage.stretch.pairs[pair].tolist()
    places = (stage.views.pairs[pair] * stage.stretch.n_intervals + interval).tolist()
    poses = [(stage.whole.turn[:, :, place], stage.whole.at[:, place]) for place in places]
    for k in (0, 1):
        shape, other = stage.shapes[bodies[k]], stage.shapes[bodies[1 - k]]
        (turn, at), (other_turn, other_at) = poses[k], poses[1 - k]
        seen = (one_point_each(shape) @ turn.T + at - other_at) @ other_turn
        if not winds_about_none(seen, other.points[closed_faces(other)]):
            return False
    return True


def all_proven(items: Items, beyond: np.ndarray) -> np.ndarray:
    """(k,) True for items of which all rows are proven."""
    return all_of_item(items, beyond >= 0.0)
