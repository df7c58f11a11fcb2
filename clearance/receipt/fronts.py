"""Finds evidence for a front of items: for each balls, a direction, or how to cut it, by the proof's own bounds.

A direction is that of what the item was cut out of, or of the nearest points of what holds both parts in the
middle of their time, as quantised. Where it does not do, time is cut if the parts are apart there, else what is
largest. Not for: how far a search goes (`search`); deciding (`receipt.proof`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.errors import NoReceipt
from clearance.receipt.nearest import nearest_directions
from clearance.receipt.proof.halving import Halves
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
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.proving import SIZES, all_proven, one_inside
from clearance.receipt.proof.separation import LONG, directions
from clearance.receipt.proof.stage import Stage, by_balls, by_directions

MANY = 3
"""Intervals of an item beyond which some of them are looked at before all are."""

DEEP = 8
"""Halvings of an interval after which a claim that may be lowered is, rather than cut on."""


class LowerableClaims(NamedTuple):
    """Claims (rules, intervals), which are lowered where they cannot be proven, and how far, if at all."""

    claims: np.ndarray
    lowest: np.ndarray | None

    def copy(self) -> LowerableClaims:
        """The same with claims of its own."""
        return LowerableClaims(self.claims.copy(), self.lowest)


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


class Front:
    """What is still to be proven of a stretch, and what was found before.

    Attributes:
        stage: of the stretch. items: still to be proven. hints: (3, k) unit vectors along which they might be.
        found: what is said of all before.
    """

    def __init__(
        self, stage: Stage, items: Items | None = None, hints: np.ndarray | None = None
    ) -> None:
        stretch = stage.stretch
        self.stage, self.found = stage, EvidenceList()
        self.items = (
            first_items(len(stretch.pairs), stretch.n_intervals) if items is None else items
        )
        unit = np.repeat([[1.0], [0.0], [0.0]], self.n_open, axis=1)
        self.hints = unit if hints is None else hints

    @property
    def n_open(self) -> int:
        """How many items are still to be proven."""
        return len(self.items.pair)

    def advance(self, claims: LowerableClaims) -> None:
        """Proves the items or cuts them in two.

        Raises:
            BadInput: one that cannot be cut any further.
        """
        deeds, codes, u = _deeds(self.stage, self.items, self.hints, claims)
        self.found.add(deeds, codes)
        self.hints = np.repeat(u[:, deeds >= CUT_TIME], 2, axis=1)
        self.items = cut(self.items, deeds)

    def require_outside(self) -> None:
        """Nothing, if no body is inside another.

        Raises:
            BadInput: the first pair of which that is not proven.
        """
        inside = one_inside(self.stage)
        if inside is not None:
            raise NoReceipt(f"no receipt: {_pair_text(self.stage, inside[0])} are {inside[2]}")


def _pair_text(stage: Stage, pair: int) -> str:
    return " and ".join(stage.shapes[body].name for body in stage.stretch.pairs[pair].tolist())


def _deeds(
    stage: Stage, items: Items, hints: np.ndarray, claims: LowerableClaims
) -> tuple[np.ndarray, dict[int, np.ndarray], np.ndarray]:
    """What to do with items, the codes of the directions among it, and (3, k) a direction of each that may do for
    what it is cut into.
    """
    found = _Deeds(stage, items, hints.copy())
    rest = found.try_balls(np.arange(len(items.pair)))
    rest = found.try_hints(rest)
    found.u[:, rest], slack = nearest_directions(stage, items.of(rest), found.u[:, rest])
    found.try_all_along(rest[slack > 0.0])
    to_cut = found.deeds[rest] == CUT_TIME
    rest, slack = rest[to_cut], slack[to_cut]
    if len(rest):
        found.deeds[rest] = _cuts(stage, items.of(rest), slack)
        if claims.lowest is not None:
            found.lower(rest, claims)
    stage.note_separate(items.of(np.flatnonzero(found.deeds < CUT_TIME)))
    codes = {most: found.codes[found.deeds == deed] for deed, most in SIZES}
    return found.deeds, codes, found.u


class _Deeds:
    """What is done with items as far as is known; all are cut in time at first."""

    def __init__(self, stage: Stage, items: Items, u: np.ndarray) -> None:
        self.stage, self.items, self.u = stage, items, u
        self.deeds = np.full(len(items.pair), CUT_TIME)
        self.codes = np.zeros((len(items.pair), 2), dtype=np.int64)

    def try_balls(self, rows: np.ndarray) -> np.ndarray:
        """Proves what it can of some items, as `holds`; returns the others."""
        own = self.items.of(rows)
        proven = all_proven(own, by_balls(self.stage, own))
        self.deeds[rows[proven]] = BALLS
        return rows[~proven]

    def try_along(self, rows: np.ndarray, deed: int) -> np.ndarray:
        """The same along `u`, by directions of a size."""
        if not len(rows):
            return rows
        own, most = self.items.of(rows), dict(SIZES)[deed]
        coded = codes_of(self.u[:, rows], most)
        proven = all_proven(own, by_directions(self.stage, own, directions(coded, most)))
        self.deeds[rows[proven]], self.codes[rows[proven]] = deed, coded[proven]
        return rows[~proven]

    def try_all_along(self, rows: np.ndarray) -> None:
        """The same by the shortest directions that do."""
        rows = rows[_may_prove(self.stage, self.items.of(rows), self.u[:, rows])]
        self.try_along(rows, LONG_DIRECTION)
        proven = rows[self.deeds[rows] == LONG_DIRECTION]
        self.try_along(self.try_along(proven, BYTE_DIRECTION), SHORT_DIRECTION)

    def try_hints(self, rows: np.ndarray) -> np.ndarray:
        """The same along what is in `u` from what they were cut out of."""
        may = _may_prove(self.stage, self.items.of(rows), self.u[:, rows])
        return np.sort(np.concatenate([rows[~may], self.try_along(rows[may], BYTE_DIRECTION)]))

    def lower(self, rows: np.ndarray, claims: LowerableClaims) -> None:
        """Lowers the claims of those items that would be cut in time once more after many times."""
        proven, coded = _lowered(
            self.stage, self.items.of(rows), self.u[:, rows], self.deeds[rows], claims
        )
        self.deeds[rows[proven]], self.codes[rows[proven]] = LONG_DIRECTION, coded


def _may_prove(stage: Stage, items: Items, u: np.ndarray) -> np.ndarray:
    """(k,) False for items that are not proven along u (3, k) at both ends or in the middle of their time."""
    proven = np.ones(len(items.pair), dtype=bool)
    for place in (items.span // 2, np.zeros_like(items.span), items.span - 1):
        many = np.flatnonzero(proven & (items.span > MANY))
        some = items.of(many)
        one = some._replace(start=some.start + place[many], span=np.ones_like(some.span))
        proven[many] = by_directions(stage, one, u[:, many]) >= 0.0
    return proven


def _lowered(
    stage: Stage, items: Items, u: np.ndarray, deeds: np.ndarray, claims: LowerableClaims
) -> tuple[np.ndarray, np.ndarray]:
    """Lowers the claims of items that would be cut in time once more after many times.

    Returns:
        which of the items are proven then, along directions u (3, k), and the codes of these.
    """
    deep = np.flatnonzero((deeds == CUT_TIME) & (items.depth >= DEEP))
    coded = codes_of(u[:, deep], LONG)
    own, along = items.of(deep), directions(coded, LONG)
    assert claims.lowest is not None
    short = np.minimum(by_directions(stage, own, along), 0.0)
    rules, interval = stage.stretch.rules[own.pair], own.start
    at = rules, stage.stretch.first + interval
    wanted = claims.claims[at] - np.ceil(-short / UNIT).astype(np.int64) - 1
    may = np.flatnonzero(np.isfinite(short) & (wanted >= claims.lowest[at]))
    np.minimum.at(claims.claims, (at[0][may], at[1][may]), wanted[may])
    for rule, step in {*zip(rules[may].tolist(), interval[may].tolist(), strict=True)}:
        pairs = stage.stretch.rules == rule
        claim = claims.claims[rule, stage.stretch.first + step]
        stage.wanted[pairs, step] = claim * UNIT + stage.stretch.padding[pairs]
    proven = np.zeros(len(deep), dtype=bool)
    proven[may] = by_directions(stage, own.of(may), along[:, may]) >= 0.0
    return deep[proven], coded[proven]


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
        raise NoReceipt(
            f"no receipt: {_pair_text(stage, int(items.pair[row]))} cannot be proven separate in interval "
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
