"""The search for the sketch nearest to an outline, from one start: Gauss and Newton, then linear programs."""

from __future__ import annotations

import numpy as np

from clearance.planar.hausdorff import Hausdorff, hausdorff
from clearance.profiles.fit_program import least_greatest
from clearance.profiles.fit_rows import FitRows, Gaps, rows_of
from clearance.profiles.fit_shape import PlacedShape
from clearance.profiles.fit_target import MOST_ROWS, STEPS, FitCandidate, FitSearch, Places


class NearestFit(FitSearch):
    """The search for the least Hausdorff distance."""

    def run(self, start: np.ndarray, beat: float = np.inf) -> FitCandidate | None:
        """The shape that the search ends with; None where it cannot be drawn at its start."""
        here = self.shape_at(start)
        return None if here is None else self._minimax(self._least_squares(here))

    def _least_squares(self, here: PlacedShape) -> PlacedShape:
        """Levenberg and Marquardt on all distances: fast where they vanish together."""
        damping, rows = 1e-3, self._rows(here)
        for _ in range(25):
            scaled = rows.slope * self.shape.scale
            normal = scaled.T @ scaled
            ridge = damping * np.diag(np.diag(normal) + 1e-12 * np.trace(normal) + 1e-300)
            step = np.linalg.lstsq(normal + ridge, -scaled.T @ rows.distance, rcond=None)[0]
            step = np.clip(step, *self.bounds(here, np.inf))
            moved = self.shape_at(here.numbers + step * self.shape.scale)
            fresh = rows.distance if moved is None else self._gaps(moved).distance
            if moved is not None and fresh @ fresh < rows.distance @ rows.distance:
                before = rows.distance @ rows.distance
                here, damping, rows = moved, max(1e-12, 0.1 * damping), self._rows(moved)
                if np.abs(step).max() < 1e-13 or 0.99 * before < fresh @ fresh > 1e-12 * before:
                    break
            else:
                damping *= 10.0
                if damping > 1e4 or np.abs(step).max() < 1e-13:
                    break
        return here

    def _minimax(self, here: PlacedShape) -> FitCandidate:
        """Linear programs for the least greatest distance; the distance itself is certified each time."""
        whole, reach, places = self._distance(here), 0.05, (self.samples, self.target.given)
        slopes = self.shape.slopes(here)
        places = self._with_witness(here, whole, *places)
        rows, chosen = self._chosen_rows(here, slopes, *places)
        for _ in range(STEPS):
            if whole.distance <= self.tiny or reach < 1e-9:
                break
            step, predicted, _ = least_greatest(rows, self.shape.scale, *self.bounds(here, reach))
            hoped = whole.distance - predicted
            if hoped <= 1e-9 * whole.distance + self.tiny:
                break
            moved = self.shape_at(here.numbers + step)
            gained, there = -1.0, whole
            if moved is not None:
                there = self._distance(moved)
                places = self._with_witness(moved, there, *places)
                gained = (whole.distance - there.distance) / hoped
            if moved is not None and gained > 0.0:
                here, whole = moved, there
                slopes = self.shape.slopes(here)
                reach *= 2.0 if gained > 0.7 else 1.0 if gained > 0.2 else 0.4
            else:
                reach *= 0.25
            rows, chosen = self._chosen_rows(here, slopes, *places)
        last = least_greatest(rows, self.shape.scale, *self.bounds(here, 1e-6))
        return FitCandidate(here, whole.distance, None, rows, last.marginals, *places, chosen)

    def _distance(self, here: PlacedShape) -> Hausdorff:
        return hausdorff(here.curve, self.target.outline.curve)

    def _with_witness(
        self, here: PlacedShape, whole: Hausdorff, samples: Places, given: np.ndarray
    ) -> tuple[Places, np.ndarray]:
        """The places that give rows and the certified witnesses: of steps that failed as well."""
        own = np.stack([whole.point_a, whole.directed["a_to_b"].point_a])
        theirs = np.stack([whole.point_b, whole.directed["b_to_a"].point_a])
        return self.with_places(here, own, samples), np.vstack([given, theirs])

    def _chosen_rows(
        self, here: PlacedShape, slopes: list, samples: Places, given: np.ndarray
    ) -> tuple[FitRows, np.ndarray]:
        """The rows that matter most, and which they are."""
        gaps = self.target.distances(here.pieces, samples, given)
        chosen = np.sort(np.argsort(-np.abs(gaps.distance), kind="stable")[:MOST_ROWS])
        return rows_of(gaps.at(chosen), here.pieces, slopes), chosen

    def _gaps(self, here: PlacedShape) -> Gaps:
        return self.target.distances(here.pieces, self.samples, self.target.given)

    def _rows(self, here: PlacedShape) -> FitRows:
        return rows_of(self._gaps(here), here.pieces, self.shape.slopes(here))
