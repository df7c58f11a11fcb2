"""A stretch ready for questions: its views, what is claimed of each pair, and places that were worked out before.

Not for: evidence (`proof`), nor the geometry of one row (`separation`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.receipt.proof.halving import Halves
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.joint_paths import IntervalPieces, arcs_of
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT, Shape, Stretch
from clearance.receipt.proof.placing import PlacedViews, placed
from clearance.receipt.proof.separation import Sides, along, as_balls, centre_of, dot
from clearance.receipt.proof.views import views_of
from clearance.receipt.proof.ways import Balls

BLOCK = 2**13
"""Rows that are worked out together: their numbers stay in a core's cache."""

PIECES = 2**10
"""Pieces of intervals that are placed together."""


class Stage:
    """A stretch of the run, of which pairs are to be proven apart.

    Args:
        shapes: of all bodies. halves: their nodes. claims: (rules, intervals of the run) in `UNIT`s.
    """

    def __init__(
        self, stretch: Stretch, shapes: Sequence[Shape], halves: Halves, claims: np.ndarray
    ) -> None:
        self.stretch, self.shapes, self.halves = stretch, shapes, halves
        self.views, self.arcs = views_of(stretch), arcs_of(stretch)
        self.balls = _balls(halves, self.views.bodies)
        span = slice(stretch.first, stretch.first + stretch.n_intervals)
        claimed = claims[stretch.rules, span]
        far = claimed == NOT_CLAIMED
        self.wanted = np.where(far, -np.inf, claimed * UNIT + stretch.padding[:, None])
        n = stretch.n_intervals
        whole = IntervalPieces(np.arange(n), np.zeros(n), np.ones(n))
        self.whole = self._placed(whole, np.ones(len(self.views.frames), dtype=bool))
        self.separate = np.zeros(self.wanted.shape, dtype=bool)

    def bounds(self, items: Items, directed: np.ndarray, u: np.ndarray) -> np.ndarray:
        """(r,) [m] what is proven of each of `items.rows()` beyond what is wanted of it.

        Args:
            directed: (k,) True for items that are looked at along u (3, k), False for balls.
        """
        item, interval = items.rows()
        found = np.empty(len(item))
        for rows, pieces, at in self._blocks(items, item, interval):
            own = item[rows]
            for some in (np.flatnonzero(directed[own]), np.flatnonzero(~directed[own])):
                if not len(some):
                    continue
                which, here = own[some], rows[some]
                sides = self._sides(items, which, pieces[some], at)
                wanted = self.wanted[items.pair[which], interval[here]]
                if directed[which[0]]:
                    shown = along(self.halves, at, *sides, u[:, which], wanted)
                else:
                    shown = as_balls(self.halves, at, *sides)
                found[here] = np.where(wanted <= 0.0, 0.0, shown - wanted)
        return found

    def middles(self, items: Items) -> Iterator[tuple[np.ndarray, PlacedViews, Sides, Sides]]:
        """Some of the items in the middle of their time: rows, where all is then, and both sides."""
        middle = items._replace(start=items.start + items.span // 2, span=np.ones_like(items.span))
        everything = np.arange(len(items.pair))
        for block, pieces, at in self._blocks(middle, everything, middle.start):
            yield block, at, *self._sides(items, block, pieces, at)

    def ways(self, items: Items) -> np.ndarray:
        """(k,) [m] about how far the parts of items move against each other in their time."""
        n = self.stretch.n_intervals
        centres = []
        for interval in (items.start, items.start + items.span - 1):
            sides = self._sides(items, np.arange(len(interval)), interval, self.whole)
            a, b = (centre_of(self.halves, self.whole, side) for side in sides)
            centres.append(b - a)
        far = np.sqrt(dot(centres[1] - centres[0], centres[1] - centres[0]))
        pairs = self.views.pairs[items.pair]
        way = sum(self.whole.way[pairs[:, k] * n + items.start] for k in (0, 1))
        return np.where(items.span > 1, far, way * 0.5**items.depth)

    def note_separate(self, items: Items) -> None:
        """Notes the intervals of items that are proven of whole bodies: these are not inside each other there."""
        whole = items.of(np.flatnonzero((items.node_a == 0) & (items.node_b == 0)))
        item, interval = whole.rows()
        self.separate[whole.pair[item], interval] = True

    def _sides(
        self, items: Items, own: np.ndarray, pieces: np.ndarray, at: PlacedViews
    ) -> tuple[Sides, Sides]:
        pair = items.pair[own]
        views, bodies = self.views.pairs[pair], self.stretch.pairs[pair]
        nodes = items.node_a[own], items.node_b[own]
        n_pieces = len(at.way) // len(self.views.frames)
        a, b = (Sides(views[:, k] * n_pieces + pieces, bodies[:, k], nodes[k]) for k in (0, 1))
        return a, b

    def _blocks(self, items: Items, item: np.ndarray, interval: np.ndarray):
        """Rows of whole intervals, then those of parts: rows, the piece of each, and where the pieces are."""
        whole = np.flatnonzero(items.depth[item] == 0)
        for start in range(0, len(whole), BLOCK):
            rows = whole[start : start + BLOCK]
            yield rows, interval[rows], self.whole
        parts = np.flatnonzero(items.depth[item] > 0)
        if len(parts):
            yield from self._part_blocks(items, item, parts)

    def _part_blocks(self, items: Items, item: np.ndarray, rows: np.ndarray):
        own = items.of(item[rows])
        number = (2**own.depth + own.part) * self.stretch.n_intervals + own.start
        order = np.argsort(number, kind="stable")
        rows, own, number = rows[order], own.of(order), number[order]
        first_of = np.flatnonzero(np.diff(number, prepend=-1))
        which = np.repeat(np.arange(len(first_of)), np.diff(first_of, append=len(rows)))
        parts, bounds = own.of(first_of), [*first_of[::PIECES].tolist(), len(rows)]
        for start, first, last in zip(
            range(0, len(first_of), PIECES), bounds[:-1], bounds[1:], strict=True
        ):
            here = parts.of(slice(start, start + PIECES))
            size = 0.5**here.depth
            pieces = IntervalPieces(here.start, here.part * size, (here.part + 1) * size)
            at = self._placed(pieces, self._seen(own.pair[first:last]))
            for begin in range(first, last, BLOCK):
                some = slice(begin, min(begin + BLOCK, last))
                yield rows[some], which[some] - start, at

    def _seen(self, pairs: np.ndarray) -> np.ndarray:
        seen = np.zeros(len(self.views.frames), dtype=bool)
        seen[self.views.pairs[pairs]] = True
        return seen

    def _placed(self, pieces: IntervalPieces, wanted: np.ndarray) -> PlacedViews:
        return placed(self.stretch, self.arcs, self.views, self.balls, pieces, wanted)


def _balls(halves: Halves, bodies: np.ndarray) -> Balls:
    """Balls that hold whole bodies."""
    node = halves.first_node[bodies]
    low, high = halves.low[:, node].T, halves.high[:, node].T
    half = 0.5 * (high - low)
    return Balls(0.5 * (low + high), np.sqrt((half * half).sum(axis=1)) + halves.radius[bodies])


def by_balls(stage: Stage, items: Items) -> np.ndarray:
    """(r,) [m] of each row, as `Stage.bounds`."""
    return stage.bounds(items, np.zeros(len(items.pair), dtype=bool), np.zeros((3, 0)))


def by_directions(stage: Stage, items: Items, u: np.ndarray) -> np.ndarray:
    """(r,) [m] of each row, as `Stage.bounds`, along directions (3, items)."""
    return stage.bounds(items, np.ones(len(items.pair), dtype=bool), u)


def all_of_item(items: Items, row_holds: np.ndarray) -> np.ndarray:
    """(k,) True for items all of whose rows hold."""
    item, _ = items.rows()
    return np.bincount(item[~row_holds], minlength=len(items.pair)) == 0
