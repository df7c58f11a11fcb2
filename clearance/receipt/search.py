"""Finds evidence: for each item balls, a direction, or how to cut it, by the proof's own bounds.

A direction is that of the nearest points of what holds both parts in the middle of their time, as quantised.
Where it does not do, time is cut if the parts are apart there, else what is largest. Not for:
deciding (`receipt.proof`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput
from clearance.progress import Progress
from clearance.receipt.nearest import nearest_directions
from clearance.receipt.proof.halving import Halves
from clearance.receipt.proof.items import (
    BALLS,
    CUT_A,
    CUT_B,
    CUT_TIME,
    DEEPEST,
    LONG_DIRECTION,
    Items,
    cut,
    first_items,
)
from clearance.receipt.proof.motion_data import UNIT, Shape, Stretch
from clearance.receipt.proof.proving import SIZES, holds_all, one_inside
from clearance.receipt.proof.separation import LONG, directions
from clearance.receipt.proof.stage import Stage, by_balls, by_directions

MOST_ITEMS = 8_000_000
"""Of a receipt: about 10 MB."""

MANY = 3
"""Intervals of an item beyond which some of them are looked at before all are."""

DEEP = 8
"""Halvings of an interval after which a claim that may be lowered is, rather than cut on."""


class LowerableClaims(NamedTuple):
    """Claims (rules, intervals), which are lowered where they cannot be proven, and how far they may be."""

    claims: np.ndarray
    lowest: np.ndarray


class EvidenceList:
    """Evidence as it is found, in the order in which it will be asked for."""

    def __init__(self) -> None:
        self.deeds: list[np.ndarray] = []
        self.codes: dict[int, list[np.ndarray]] = {most: [] for _, most in SIZES}
        self.n_items = 0

    @property
    def all_deeds(self) -> np.ndarray:
        """(items,) what is done with each."""
        return np.concatenate(self.deeds) if self.deeds else np.empty(0, dtype=np.uint8)

    @property
    def all_codes(self) -> dict[int, np.ndarray]:
        """(n, 2) all directions of each size."""
        none = np.empty((0, 2), dtype=np.int64)
        return {most: np.concatenate([none, *rows]) for most, rows in self.codes.items()}

    def and_then(self, other: EvidenceList) -> EvidenceList:
        """This evidence, then other."""
        both = EvidenceList()
        both.deeds, both.n_items = [*self.deeds, *other.deeds], self.n_items + other.n_items
        both.codes = {most: [*rows, *other.codes[most]] for most, rows in self.codes.items()}
        return both

    def add(self, deeds: np.ndarray, codes: dict[int, np.ndarray]) -> None:
        """Adds what is done with the items of a level."""
        self.deeds.append(deeds.astype(np.uint8))
        self.n_items += len(deeds)
        for most, rows in codes.items():
            self.codes[most].append(rows)


def evidence_for(
    stretches: Sequence[Stretch],
    shapes: Sequence[Shape],
    halves: Halves,
    claims: np.ndarray,
    most_items: int = MOST_ITEMS,
    progress: Progress | None = None,
    lowest: np.ndarray | None = None,
) -> EvidenceList:
    """What proves all that is claimed.

    Args:
        lowest: as `claims`, which are then lowered, no further than this, where evidence would be without end.
        progress: told in thousandths of the time of all pairs.

    Raises:
        BadInput: it cannot be proven so, or not in a receipt of any size.
    """
    found, shares = EvidenceList(), _Shares(stretches, progress)
    for stretch in stretches:
        stage = Stage(stretch, shapes, halves, claims)
        items = first_items(len(stretch.pairs), stretch.n_intervals)
        while len(items.pair):
            deeds, codes = _deeds(
                stage, items, None if lowest is None else LowerableClaims(claims, lowest)
            )
            found.add(deeds, codes)
            if found.n_items > most_items:
                raise BadInput(
                    f"a full receipt takes more than {most_items:,} proofs",
                    valid="--receipt sampled",
                )
            shares.tell(items.of(np.flatnonzero(deeds < CUT_TIME)))
            items = cut(items, deeds)
        inside = one_inside(stage)
        if inside is not None:
            raise BadInput(f"no receipt: {_pair_text(stage, inside[0])} are {inside[2]}")
    return found


class _Shares:
    """How much of all is proven: an item is a share of its pair's time, and half for each cut of its bodies."""

    def __init__(self, stretches: Sequence[Stretch], progress: Progress | None) -> None:
        self._total = float(sum(len(one.pairs) * one.n_intervals for one in stretches))
        self._done, self._progress = 0.0, progress

    def tell(self, proven: Items) -> None:
        """Adds some items."""
        if self._progress is None:
            return
        cuts = [np.frexp(nodes + 1.0)[1] - 1 for nodes in (proven.node_a, proven.node_b)]
        self._done += float((proven.span * 0.5 ** (cuts[0] + cuts[1] + proven.depth)).sum())
        self._progress(int(1000 * min(1.0, self._done / self._total)), 1000)


def _pair_text(stage: Stage, pair: int) -> str:
    return " and ".join(stage.shapes[body].name for body in stage.stretch.pairs[pair].tolist())


def _deeds(
    stage: Stage, items: Items, lowest: LowerableClaims | None
) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """What to do with items, and the codes of the directions among it."""
    deeds = np.full(len(items.pair), CUT_TIME)
    done = holds_all(items, by_balls(stage, items))
    deeds[done] = BALLS
    rest = np.flatnonzero(~done)
    codes = np.zeros((len(items.pair), 2), dtype=np.int64)
    own = items.of(rest)
    u, slack = nearest_directions(stage, own)
    tried = _may_hold(stage, own, u)
    cut_u, cut_slack, cut_rows = u[:, ~tried], slack[~tried], rest[~tried]
    rest, u, slack, own = rest[tried], u[:, tried], slack[tried], own.of(tried)
    for deed, most in SIZES:
        if not len(rest):
            break
        coded = codes_of(u, most)
        held = holds_all(own, by_directions(stage, own, directions(coded, most)))
        deeds[rest[held]], codes[rest[held]] = deed, coded[held]
        left = ~held
        rest, u, slack, own = rest[left], u[:, left], slack[left], own.of(np.flatnonzero(left))
    rest, u = np.concatenate([cut_rows, rest]), np.concatenate([cut_u, u], axis=1)
    if len(rest):
        own = items.of(rest)
        deeds[rest] = _cuts(stage, own, np.concatenate([cut_slack, slack]))
        if lowest is not None:
            held, coded = _lowered(stage, own, u, deeds[rest], lowest)
            deeds[rest[held]], codes[rest[held]] = LONG_DIRECTION, coded
    stage.note_apart(items.of(np.flatnonzero(deeds < CUT_TIME)))
    return deeds, {most: codes[deeds == deed] for deed, most in SIZES}


def _may_hold(stage: Stage, items: Items, u: np.ndarray) -> np.ndarray:
    """(k,) False for items that are not proven along u (3, k) at both ends or in the middle of their time."""
    held = np.ones(len(items.pair), dtype=bool)
    for place in (items.span // 2, np.zeros_like(items.span), items.span - 1):
        many = np.flatnonzero(held & (items.span > MANY))
        some = items.of(many)
        one = some._replace(start=some.start + place[many], span=np.ones_like(some.span))
        held[many] = by_directions(stage, one, u[:, many]) >= 0.0
    return held


def _lowered(
    stage: Stage, items: Items, u: np.ndarray, deeds: np.ndarray, lowest: LowerableClaims
) -> tuple[np.ndarray, np.ndarray]:
    """Lowers the claims of items that would be cut in time once more after many times.

    Returns:
        which of the items are proven then, along directions u (3, k), and the codes of these.
    """
    deep = np.flatnonzero((deeds == CUT_TIME) & (items.depth >= DEEP))
    coded = codes_of(u[:, deep], LONG)
    own, along = items.of(deep), directions(coded, LONG)
    short = np.minimum(by_directions(stage, own, along), 0.0)
    rules, interval = stage.stretch.rules[own.pair], own.start
    at = rules, stage.stretch.first + interval
    wanted = lowest.claims[at] - np.ceil(-short / UNIT).astype(np.int64) - 1
    may = np.flatnonzero(np.isfinite(short) & (wanted >= lowest.lowest[at]))
    np.minimum.at(lowest.claims, (at[0][may], at[1][may]), wanted[may])
    for rule, step in {*zip(rules[may].tolist(), interval[may].tolist(), strict=True)}:
        pairs = stage.stretch.rules == rule
        claim = lowest.claims[rule, stage.stretch.first + step]
        stage.wanted[pairs, step] = claim * UNIT + stage.stretch.padding[pairs]
    held = np.zeros(len(deep), dtype=bool)
    held[may] = by_directions(stage, own.of(may), along[:, may]) >= 0.0
    return deep[held], coded[held]


def _cuts(stage: Stage, items: Items, slack: np.ndarray) -> np.ndarray:
    """How to cut items that no direction proves: in time where they are apart in its middle, else what is largest,
    a part or the way that the parts go against each other.

    Args:
        slack: (k,) [m] by how much they are apart beyond what is wanted in the middle of their time.
    """
    bodies = stage.stretch.pairs[items.pair]
    sides = [(bodies[:, k], nodes) for k, nodes in enumerate((items.node_a, items.node_b))]
    sizes = np.array([stage.halves.sizes(*side) for side in sides])
    lengths = np.where(sizes > 1, [_lengths(stage.halves, *side) for side in sides], -1.0)
    in_time = (slack > 0.0) | (stage.ways(items) >= lengths.max(axis=0))
    in_time |= (sizes == 1).all(axis=0)
    stuck = np.flatnonzero(in_time & (items.depth >= DEEPEST))
    if len(stuck):
        row = int(stuck[0])
        raise BadInput(
            f"no receipt: {_pair_text(stage, int(items.pair[row]))} cannot be proven apart in interval "
            f"{stage.stretch.first + int(items.start[row])}"
        )
    return np.where(in_time, CUT_TIME, np.where(lengths[0] >= lengths[1], CUT_A, CUT_B))


def _lengths(halves: Halves, bodies: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """(k,) [m] the longest side of nodes."""
    at = halves.first_node[bodies] + nodes
    return (halves.high[:, at] - halves.low[:, at]).max(axis=0)


def codes_of(u: np.ndarray, most: int) -> np.ndarray:
    """(k, 2) the codes of the nearest directions to vectors (3, k), as `separation.directions` reads them."""
    size = np.abs(u).sum(axis=0)
    x, y, z = most * u / np.where(size > 0.0, size, 1.0)
    fold = z < 0.0
    a = np.where(fold, (most - np.abs(y)) * np.where(x < 0.0, -1, 1), x)
    b = np.where(fold, (most - np.abs(x)) * np.where(y < 0.0, -1, 1), y)
    return np.clip(np.rint(np.stack([a, b], axis=1)), -most, most).astype(np.int64)
