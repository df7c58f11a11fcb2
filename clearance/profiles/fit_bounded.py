"""The search for the least sketch around an outline, or the largest clear of it, from one start.

Linear programs in a trust region, each answer certified; where it is too small, the next program asks for more
margin. Not for: choosing starts (`fit`), or the nearest sketch (`fit_nearest`).
"""

from __future__ import annotations

import numpy as np

from clearance.profiles.fit_program import AreaGoal, least_area
from clearance.profiles.fit_rows import FitRows, Gaps, rows_of
from clearance.profiles.fit_shape import PlacedShape
from clearance.profiles.fit_target import MOST_ROWS, STEPS, FitCandidate, FitSearch, Places

MOST_NEAR = 60
"""Places of the outline whose pieces get more rows once the shape is near them."""

ENDLESS = 3.0
"""[-] A shape still growing after all steps, and so many times the outline's size, has nothing to stop it."""

ROUNDS = 7
"""Times that a search is resumed with the certified witnesses."""


class BoundedFit(FitSearch):
    """The search for the least (outside) or greatest (inside) area with every gap at least the margin.

    Attributes:
        endless: whether a shape grew outside the outline without end.
    """

    endless = False

    def run(self, start: np.ndarray, beat: float = np.inf) -> FitCandidate | None:
        """The shape that the search ends with; None where it does not meet the request, or is no better than the
        score `beat` once it has come near.
        """
        here = self.shape_at(start)
        return None if here is None else self._certified(here, beat)

    def _certified(self, here: PlacedShape, beat: float) -> FitCandidate | None:
        target, wanted, near = self.target, self.target.margin, 1e-6 * self.shape.size
        extra, samples = np.zeros((0, 2)), self.samples
        for k in range(ROUNDS):
            reach = 0.1 if k == 0 else 1e-3
            here, rows, marginals, used, grown = self._steps(here, wanted, samples, extra, reach)
            self.endless |= grown
            if grown or float(rows.distance.min()) < wanted - near:
                return None
            if k == 0 and target.score(here) > beat + 1e-6 * abs(beat):
                return None
            gap, least = target.clearance(here)
            if gap >= target.margin and (gap > 0.0 or target.margin > 0.0):
                return FitCandidate(here, target.score(here), gap, rows, marginals, *used)
            if gap < 0.0 and least.distance > near:
                return None
            extra = np.vstack([extra, least.point_b, self._near_points(here, wanted)])
            samples = self.with_places(here, least.point_a[None], samples)
            wanted += 1.05 * (target.margin - max(gap, 0.0)) + 4.0**k * 1e-9 * self.shape.size
        return None

    def _steps(
        self, here: PlacedShape, wanted: float, samples: Places, extra: np.ndarray, reach: float
    ):
        """Linear programs until none promises more: the shape, the rows of the last, which they are, and whether
        it was still growing, far beyond the outline.
        """
        target, size = self.target, self.shape.size
        most = 0.5 * max(1.0, target.pieces.size / size)  # a sketch drawn far too small can grow
        price, given = 10.0 * max(size, target.pieces.size), np.vstack([target.given, extra])
        gaps = target.gaps(here.pieces, samples, given)
        rows, chosen, change = self._rows(here, gaps)
        for _ in range(2 * STEPS):
            merit = target.score(here) + price * max(0.0, wanted - float(gaps.distance.min()))
            within = np.where(self.shape.angular, min(reach, 0.5), reach)
            bounds = self.bounds(here, within)
            goal = AreaGoal(change, wanted, price)
            found = least_area(rows, goal, size, reach, self.shape.scale, *bounds)
            if found.value <= 1e-10 * size**2 or reach < 1e-10:
                break
            moved, gained = self.shape_at(here.numbers + found.step), -np.inf
            if moved is not None:
                fresh = target.gaps(moved.pieces, samples, given)
                missing = max(0.0, wanted - float(fresh.distance.min()))
                gained = merit - target.score(moved) - price * missing
            if moved is not None and gained > 0.0:
                here, gaps = moved, fresh
                rows, chosen, change = self._rows(here, gaps)
                share = gained / found.value
                reach = min(most, reach * (2.0 if share > 0.7 else 1.0 if share > 0.2 else 0.4))
            else:
                reach *= 0.25
        else:
            far = here.pieces.size > ENDLESS * target.pieces.size
            return here, rows, found.marginals, (samples, given, chosen), far and self._outside
        return here, rows, found.marginals, (samples, given, chosen), False

    @property
    def _outside(self) -> bool:
        return self.target.mode == "inside" and not self.target.within

    def _rows(self, here: PlacedShape, gaps: Gaps) -> tuple[FitRows, np.ndarray, np.ndarray]:
        """The rows nearest to mattering, which they are, and the change of the score by each number."""
        chosen = np.sort(np.argsort(gaps.distance, kind="stable")[:MOST_ROWS])
        slopes = self.shape.slopes(here)
        sign = 1.0 if self.target.mode == "outside" else -1.0
        change = sign * np.array([slope.area for slope in slopes])
        return rows_of(gaps.at(chosen), here.pieces, slopes), chosen, change

    def _near_points(self, here: PlacedShape, wanted: float) -> np.ndarray:
        """Many points of those pieces of the outline that come near the shape: where it may touch."""
        outline = self.target.pieces
        piece, share = outline.spread(2)
        points = outline.point(piece, share)
        gaps = self.target.gaps_of_given(here.pieces, self.samples, points)
        least = np.argsort(gaps, kind="stable")[:MOST_NEAR]
        near = np.unique(piece[least[gaps[least] <= wanted + 2e-3 * self.shape.size]])
        dense = np.tile(np.linspace(0.0, 1.0, 24), len(near))
        return outline.point(np.repeat(near, 24), dense)
