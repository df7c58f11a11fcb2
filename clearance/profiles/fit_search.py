"""The search for a fitted sketch from one start: Gauss-Newton, then linear programs in a trust region.

Not for: choosing starts (`fit`), or what is wanted (`fit_target`).
"""

from __future__ import annotations

import numpy as np

from clearance.planar.hausdorff import Hausdorff, hausdorff
from clearance.profiles.fit_rows import Rows, Slope, joined_rows
from clearance.profiles.fit_shape import Placed, SketchShape
from clearance.profiles.fit_target import Found, Places, Target

MOST_ROWS = 700
"""Rows of a linear program: those nearest to mattering."""

MOST_NEAR = 60
"""Places of the outline whose pieces are looked at more closely once the shape is near them."""

SAMPLES = 16
"""Places on each piece of the shape."""


class Search:
    """The search from a start."""

    def __init__(self, shape: SketchShape, target: Target, drawn: Placed) -> None:
        self.shape, self.target = shape, target
        self.samples = drawn.pieces.spread(SAMPLES)
        self.tiny = 1e-12 * shape.size

    def run(self, start: np.ndarray, beat: float = np.inf) -> Found | None:
        """The shape that the search ends with; None where it is not what was asked, or no better than the
        score `beat` once it has come near.
        """
        here = self.shape.at(start)
        if here is None:
            return None
        if self.target.mode == "nearest":
            return self._minimax(self._least_squares(here))
        return self._bounded(here, beat)

    # --- nearest ---

    def _least_squares(self, here: Placed) -> Placed:
        """Levenberg and Marquardt on all distances: fast where they vanish together."""
        damping, rows = 1e-3, self._rows(here)
        for _ in range(25):
            scaled = rows.slope * self.shape.scale
            normal = scaled.T @ scaled
            ridge = damping * np.diag(np.diag(normal) + 1e-12 * np.trace(normal) + 1e-300)
            step = np.linalg.lstsq(normal + ridge, -scaled.T @ rows.distance, rcond=None)[0]
            moved = self.shape.at(here.numbers + step * self.shape.scale)
            fresh = None if moved is None else self._distances(moved)
            if fresh is not None and fresh @ fresh < rows.distance @ rows.distance:
                before = rows.distance @ rows.distance
                here, damping, rows = moved, max(1e-12, 0.1 * damping), self._rows(moved)
                if np.abs(step).max() < 1e-13 or 0.99 * before < fresh @ fresh > 1e-12 * before:
                    break
            else:
                damping *= 10.0
                if damping > 1e4 or np.abs(step).max() < 1e-13:
                    break
        return here

    def _minimax(self, here: Placed) -> Found:
        """Linear programs for the least greatest distance; the distance itself is certified each time."""
        whole, reach = self._distance(here), 0.05
        for _ in range(30):
            if whole.distance <= self.tiny or reach < 1e-9:
                break
            rows, _ = self._with_witness(here, whole)
            step, predicted, _ = self._greatest_program(rows, reach)
            hoped = whole.distance - predicted
            if hoped <= 1e-9 * whole.distance + self.tiny:
                break
            moved = self.shape.at(here.numbers + step)
            there = None if moved is None else self._distance(moved)
            if there is not None and there.distance < whole.distance:
                gained = (whole.distance - there.distance) / hoped
                here, whole = moved, there
                reach *= 2.0 if gained > 0.7 else 1.0 if gained > 0.2 else 0.4
            else:
                reach *= 0.25
        rows, used = self._with_witness(here, whole)
        marginals = self._greatest_program(rows, 1e-6)[2]
        return Found(here, whole.distance, None, rows, marginals, *used)

    def _distance(self, here: Placed) -> Hausdorff:
        return hausdorff(here.curve, self.target.outline.curve)

    def _with_witness(self, here: Placed, whole: Hausdorff):
        """The rows that matter most, the certified witnesses among them, and which they are."""
        own = np.stack([whole.point_a, whole.directed["a_to_b"].point_a])
        samples = self._with_places(here, own, self.samples)
        theirs = np.stack([whole.point_b, whole.directed["b_to_a"].point_a])
        given = np.vstack([self.target.given, theirs])
        slopes = self.shape.slopes(here)
        rows = joined_rows(*self.target.rows(here.pieces, slopes, samples, given))
        chosen = np.sort(np.argsort(-np.abs(rows.distance), kind="stable")[:MOST_ROWS])
        return Rows(*(column[chosen] for column in rows)), (samples, given, chosen)

    def _greatest_program(self, rows: Rows, reach: float):
        """Step, predicted greatest distance and marginals of: least t with |distance + slope step| <= t."""
        from scipy.optimize import linprog

        scaled = rows.slope * self.shape.scale
        n, one = scaled.shape[1], -np.ones((len(scaled), 1))
        matrix = np.vstack([np.hstack([scaled, one]), np.hstack([-scaled, one])])
        right = np.concatenate([-rows.distance, rows.distance])
        unit = max(float(np.abs(rows.distance).max()), 1e-300)
        solved = linprog(
            np.append(np.zeros(n), 1.0), matrix, right / unit,
            bounds=[(-reach / unit, reach / unit)] * n + [(0.0, None)], method="highs",
        )  # fmt: skip
        if solved.x is None:
            return np.zeros(n), unit, np.zeros(len(right))
        step = solved.x[:n] * unit * self.shape.scale
        return step, float(solved.x[n]) * unit, solved.ineqlin.marginals

    # --- outside and inside ---

    def _bounded(self, here: Placed, beat: float) -> Found | None:
        """Least (outside) or greatest (inside) area with every gap at least the margin, then certified."""
        target, wanted = self.target, self.target.margin
        extra, samples = np.zeros((0, 2)), self.samples
        for k in range(7):
            reach = 0.1 if k == 0 else 1e-3
            here, rows, marginals, used = self._area_steps(here, wanted, samples, extra, reach)
            if k == 0 and target.score(here) > beat + 1e-6 * abs(beat):
                return None
            gap, least = target.clearance(here)
            if gap >= target.margin and (gap > 0.0 or target.margin > 0.0):
                return Found(here, target.score(here), gap, rows, marginals, *used)
            if gap < 0.0 and least.distance > 1e-6 * self.shape.size:
                return None
            extra = np.vstack([extra, least.point_b, self._near_points(here, wanted)])
            samples = self._with_places(here, least.point_a[None], samples)
            wanted += 1.05 * (target.margin - max(gap, 0.0)) + 4.0**k * 1e-9 * self.shape.size
        return None

    def _area_steps(
        self, here: Placed, wanted: float, samples: Places, extra: np.ndarray, reach: float
    ):
        """Linear programs until none promises more; with the rows of the last and which they are."""
        target, price = self.target, 10.0 * self.shape.size
        given = np.vstack([target.given, extra])
        for _ in range(30):
            slopes = self.shape.slopes(here)
            rows = target.gaps(target.rows(here.pieces, slopes, samples, given))
            merit = target.score(here) + price * max(0.0, wanted - float(rows.distance.min()))
            chosen = np.sort(np.argsort(rows.distance, kind="stable")[:MOST_ROWS])
            rows = Rows(*(column[chosen] for column in rows))
            sign = 1.0 if target.mode == "outside" else -1.0
            change = sign * np.array([slope.area for slope in slopes])
            step, predicted, marginals = self._area_program(rows, change, wanted, reach, price)
            if predicted <= 1e-10 * self.shape.size**2 or reach < 1e-10:
                break
            moved = self.shape.at(here.numbers + step)
            gained = -np.inf
            if moved is not None:
                least = target.gaps(self._flat(moved, samples, given)).distance.min()
                gained = merit - target.score(moved) - price * max(0.0, wanted - float(least))
            if gained > 0.0:
                here = moved
                share = gained / predicted
                reach = min(0.5, reach * (2.0 if share > 0.7 else 1.0 if share > 0.2 else 0.4))
            else:
                reach *= 0.25
        return here, rows, marginals, (samples, given, chosen)

    def _area_program(
        self, rows: Rows, change: np.ndarray, wanted: float, reach: float, price: float
    ):
        """Step, predicted gain and marginals of: least area and missing gap, to first order."""
        from scipy.optimize import linprog

        scaled, size = rows.slope * self.shape.scale, self.shape.size
        n = scaled.shape[1]
        matrix = np.hstack([-scaled / size, -np.ones((len(scaled), 1))])
        cost = np.append(change * self.shape.scale, price * size) / size**2
        # In units of `reach`, so that late small steps are not lost in the solver's tolerances.
        solved = linprog(
            cost, matrix, (rows.distance - wanted) / (size * reach),
            bounds=[(-1.0, 1.0)] * n + [(0.0, None)], method="highs",
        )  # fmt: skip
        if solved.x is None:
            return np.zeros(n), 0.0, np.zeros(len(scaled))
        missing = max(0.0, wanted - float(rows.distance.min()))
        predicted = price * missing - solved.fun * size**2 * reach
        return solved.x[:n] * reach * self.shape.scale, predicted, solved.ineqlin.marginals

    def _near_points(self, here: Placed, wanted: float) -> np.ndarray:
        """Many points of those pieces of the outline that come near the shape: where it may touch."""
        outline = self.target.pieces
        piece, share = outline.spread(2)
        points = outline.point(piece, share)
        _, _, foot = here.pieces.feet(points)
        off = np.hypot(*(points - foot).T)
        near = piece[np.argsort(off, kind="stable")[:MOST_NEAR]]
        near = np.unique(near[np.sort(off)[:MOST_NEAR] <= wanted + 2e-3 * self.shape.size])
        dense = np.tile((np.arange(24) + 0.5) / 24.0, len(near))
        return outline.point(np.repeat(near, 24), dense)

    # --- both ---

    def _rows(self, here: Placed) -> Rows:
        slopes = self.shape.slopes(here)
        return joined_rows(*self.target.rows(here.pieces, slopes, self.samples, self.target.given))

    def _flat(self, here: Placed, samples: Places, given: np.ndarray) -> tuple[Rows, Rows]:
        return self.target.rows(here.pieces, [Slope(here.pieces, here.pieces, 0.0)], samples, given)

    def _distances(self, here: Placed) -> np.ndarray:
        return joined_rows(*self._flat(here, self.samples, self.target.given)).distance

    def _with_places(self, here: Placed, points: np.ndarray, samples: Places) -> Places:
        """The samples and the places of more points of the shape."""
        piece, share, _ = here.pieces.feet(points)
        return np.append(samples[0], piece), np.append(samples[1], share)
