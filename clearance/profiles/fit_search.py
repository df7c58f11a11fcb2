"""The search for a fitted sketch: Gauss-Newton to come near, then linear programs in a trust region.

`Target` says what is wanted and certifies it; `Search` finds it from one start. Not for: choosing starts (`fit`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import minimum_distance
from clearance.profiles.fit_rows import Rows, Sides, Table, joined_rows, outline_rows, shape_rows
from clearance.profiles.fit_shape import Placed, SketchShape
from clearance.profiles.outline_file import Drawn
from clearance.profiles.region import holds

MOST_ROWS = 400
"""Rows of a linear program: those nearest to mattering."""

MOST_GIVEN = 3000
"""Points of the outline that are looked at."""


@dataclass(frozen=True, eq=False)
class Found:
    """A shape at the end of a search.

    Attributes:
        score: Hausdorff distance [m], or area [m^2] with a sign; least is best.
        rows, marginals: of the last linear program; samples, given, chosen: which rows they are.
    """

    placed: Placed
    score: float
    clearance: float | None
    rows: Rows
    marginals: np.ndarray
    samples: np.ndarray
    given: np.ndarray
    chosen: np.ndarray


class Target:
    """An outline, and what a shape should be to it."""

    def __init__(self, outline: Drawn, shape: SketchShape, mode: str, margin: float) -> None:
        self.outline, self.mode, self.margin = outline, mode, margin
        curve = outline.curve
        self.table = Table(curve, max(2, min(16, 4000 // curve.n_pieces)))
        self.sides = Sides(curve, outline.name)
        low, high = curve.limits.T
        points = np.concatenate([curve.point(low + share * (high - low)) for share in (0.0, 0.5)])
        self.given = points[:: max(1, len(points) // MOST_GIVEN)]
        drawn = shape.sketch.curves()
        self.shape_sides = Sides(drawn, "sketch")
        start = drawn.point(drawn.limits[:1, 0])
        self.room = (
            mode == "inside"
            and outline.profile is None
            and bool(holds(outline.region, start).all())
        )

    def rows(
        self, here: Placed, slopes, samples: np.ndarray, given: np.ndarray
    ) -> tuple[Rows, Rows]:
        """Rows of the shape's points and of the outline's, positive inside the other."""
        return (
            outline_rows(here, slopes, self.table, self.sides, samples),
            shape_rows(here, slopes, self.shape_sides, given),
        )

    def gaps(self, pair: tuple[Rows, Rows]) -> Rows:
        """One set of rows whose distance must be at least the margin."""
        own, other = pair
        one = 1.0 if self.room else -1.0
        two = 1.0 if self.mode == "outside" else -1.0
        turned = [
            Rows(sign * r.distance, sign * r.slope, r.point)
            for sign, r in ((one, own), (two, other))
        ]
        return joined_rows(turned)

    def clearance(self, here: Placed):
        """Proven lower bound of the gap and the witnesses; -1 where the shape is on the wrong side."""
        least = minimum_distance(here.curve, self.outline.curve)
        region = Drawn("sketch", here.curve).region
        theirs = holds(region, _starts_of(self.outline.curve))
        ours = holds(self.outline.region, _starts_of(here.curve))
        right = (theirs.all() if self.mode == "outside" else not theirs.any()) and (
            ours.all() if self.room else not ours.any()
        )
        gap = least.distance - least.error_bound
        return (gap if right else -1.0), least

    def better(self, one: Found, two: Found) -> bool:
        """True if `one` beats `two` by more than rounding; equal areas are told apart by distance."""
        scale = max(abs(two.score), 1e-300)
        if abs(one.score - two.score) > 1e-9 * scale:
            return one.score < two.score
        if self.mode == "nearest":
            return one.score < two.score
        far = [hausdorff(f.placed.curve, self.outline.curve).distance for f in (one, two)]
        return far[0] < far[1] * (1.0 - 1e-9)


class Search:
    """The search from one start."""

    def __init__(self, shape: SketchShape, target: Target) -> None:
        self.shape, self.target = shape, target
        pieces = shape.sketch.curves().limits
        share = np.linspace(0.0, 1.0, 17)[:-1]
        self.samples = np.append(
            (pieces[:, :1] + (pieces[:, 1:] - pieces[:, :1]) * share).ravel(), pieces[-1, 1]
        )
        self.tiny = 1e-12 * shape.size

    def run(self, start: np.ndarray) -> Found | None:
        """The shape that the search ends with; None where it is not what was asked."""
        here = self.shape.at(start)
        if here is None:
            return None
        if self.target.mode == "nearest":
            return self._minimax(self._least_squares(here))
        return self._bounded(here)

    # --- nearest ---

    def _least_squares(self, here: Placed) -> Placed:
        """Levenberg and Marquardt on all distances: quadratic where they vanish together."""
        target, damping = self.target, 1e-3
        rows = joined_rows(list(self._rows(here)))
        for _ in range(25):
            scaled = rows.slope * self.shape.scale
            normal = scaled.T @ scaled
            ridge = damping * np.diag(
                np.maximum(np.diag(normal), 1e-12 * np.trace(normal) + 1e-300)
            )
            step = np.linalg.lstsq(normal + ridge, -scaled.T @ rows.distance, rcond=None)[0]
            moved = self.shape.at(here.numbers + step * self.shape.scale)
            fresh = None if moved is None else self._distances(moved, target.given)
            if fresh is not None and fresh @ fresh < rows.distance @ rows.distance:
                here, damping = moved, max(1e-12, 0.1 * damping)
                rows = joined_rows(list(self._rows(here)))
                if np.abs(step).max() < 1e-13:
                    break
            else:
                damping *= 10.0
                if damping > 1e6 or np.abs(step).max() < 1e-13:
                    break
        return here

    def _minimax(self, here: Placed) -> Found:
        """Linear programs for the least greatest distance; the distance itself is certified each time."""
        whole = hausdorff(here.curve, self.target.outline.curve)
        reach = 0.05
        for _ in range(40):
            rows, _ = self._with_witness(here, whole)
            if whole.distance <= self.tiny or reach < 1e-10:
                break
            step, predicted, _ = self._greatest_program(rows, reach)
            if whole.distance - predicted <= 1e-10 * whole.distance + self.tiny:
                break
            moved = self.shape.at(here.numbers + step)
            there = None if moved is None else hausdorff(moved.curve, self.target.outline.curve)
            if there is not None and there.distance < whole.distance:
                gained = (whole.distance - there.distance) / (whole.distance - predicted)
                here, whole = moved, there
                reach *= 2.0 if gained > 0.7 else 1.0 if gained > 0.2 else 0.4
            else:
                reach *= 0.25
        rows, used = self._with_witness(here, whole)
        marginals = self._greatest_program(rows, 1e-6)[2]
        return Found(here, whole.distance, None, rows, marginals, *used)

    def _with_witness(self, here: Placed, whole):
        """The rows that matter most, the certified witnesses among them, and which they are."""
        slopes = self.shape.slopes(here)
        samples = np.append(
            self.samples, [one.parameter_a for one in (whole, whole.directed["a_to_b"])]
        )
        given = np.vstack([self.target.given, whole.point_b, whole.directed["b_to_a"].point_a])
        rows = joined_rows(list(self.target.rows(here, slopes, samples, given)))
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

    def _bounded(self, here: Placed) -> Found | None:
        """Least (outside) or greatest (inside) area with every gap at least the margin, then certified."""
        wanted, found = self.target.margin, None
        extra = np.zeros((0, 2))
        parameters = np.zeros(0)
        for _ in range(7):
            here, rows, marginals, used = self._area_steps(here, wanted, parameters, extra)
            gap, least = self.target.clearance(here)
            if gap >= self.target.margin:
                found = Found(here, self._score(here), gap, rows, marginals, *used)
                break
            if gap < 0.0 and least.distance > 1e-6 * self.shape.size:
                return None
            extra = np.vstack([extra, least.point_b])
            parameters = np.append(parameters, least.parameter_a)
            wanted += 1.05 * (self.target.margin - max(gap, 0.0)) + 1e-9 * self.shape.size
        return found

    def _score(self, here: Placed) -> float:
        return abs(here.area) if self.target.mode == "outside" else -abs(here.area)

    def _area_steps(self, here: Placed, wanted: float, parameters, extra):
        target, reach, price = self.target, 0.1, 10.0 * self.shape.size
        samples = np.append(self.samples, parameters)
        given = np.vstack([target.given, extra])
        rows, marginals = None, np.zeros(0)
        for _ in range(60):
            slopes = self.shape.slopes(here)
            rows = target.gaps(target.rows(here, slopes, samples, given))
            missing = max(0.0, wanted - float(rows.distance.min()))
            chosen = np.sort(np.argsort(rows.distance, kind="stable")[:MOST_ROWS])
            rows = Rows(*(column[chosen] for column in rows))
            change = self._area_slope(slopes)
            step, predicted, marginals = self._area_program(rows, change, wanted, reach, price)
            moved = self.shape.at(here.numbers + step)
            gained = -np.inf
            if moved is not None:
                left = target.gaps(self._flat(moved, samples, given)).distance.min()
                after = self._score(moved) + price * max(0.0, wanted - float(left))
                gained = self._score(here) + price * missing - after
            if gained > 0.0:
                here = moved
                reach = min(
                    0.5,
                    reach
                    * (
                        2.0
                        if gained > 0.7 * predicted
                        else 1.0
                        if gained > 0.2 * predicted
                        else 0.4
                    ),
                )
                if gained < 1e-13 * self.shape.size**2:
                    break
            else:
                reach *= 0.25
            if reach < 1e-11:
                break
        return here, rows, marginals, (samples, given, chosen)

    def _area_slope(self, slopes) -> np.ndarray:
        found = []
        for behind, ahead, width in slopes:
            found.append((self._score(ahead) - self._score(behind)) / width if width else 0.0)
        return np.array(found)

    def _area_program(
        self, rows: Rows, change: np.ndarray, wanted: float, reach: float, price: float
    ):
        """Step, predicted gain and marginals of: least area and missing gap, to first order."""
        from scipy.optimize import linprog

        scaled, size = rows.slope * self.shape.scale, self.shape.size
        n = scaled.shape[1]
        matrix = np.hstack([-scaled, -size * np.ones((len(scaled), 1))])
        cost = np.append(change * self.shape.scale, price * size) / size**2
        right = rows.distance - wanted
        # In units of `reach`, so that late small steps are not lost in the solver's tolerances.
        solved = linprog(
            cost, matrix / size, right / (size * reach),
            bounds=[(-1.0, 1.0)] * n + [(0.0, None)], method="highs",
        )  # fmt: skip
        if solved.x is None:
            return np.zeros(n), 0.0, np.zeros(len(right))
        missing = max(0.0, wanted - float(rows.distance.min()))
        predicted = price * missing - solved.fun * size**2 * reach
        return solved.x[:n] * reach * self.shape.scale, predicted, solved.ineqlin.marginals

    # --- both ---

    def _rows(self, here: Placed) -> tuple[Rows, Rows]:
        return self.target.rows(here, self.shape.slopes(here), self.samples, self.target.given)

    def _flat(self, here: Placed, samples: np.ndarray, given: np.ndarray) -> tuple[Rows, Rows]:
        return self.target.rows(here, [(here, here, 1.0)], samples, given)

    def _distances(self, here: Placed, given: np.ndarray) -> np.ndarray:
        return joined_rows(list(self._flat(here, self.samples, given))).distance

    def told(self, best: Found):
        """What holds the fit: held dimensions with their multipliers, sensitivities, and where it touches."""
        rows, n = best.rows, len(self.shape.free)
        nearest = self.target.mode == "nearest"
        k = len(rows.distance)
        weight = best.marginals if len(best.marginals) else np.zeros(2 * k if nearest else k)
        sign = np.where(rows.distance < 0.0, -1.0, 1.0) if nearest else np.ones(k)
        far = np.abs(rows.distance).max() if nearest else rows.distance.min()
        level = np.abs(rows.distance) if nearest else rows.distance
        tight = np.abs(level - far) <= 1e-6 * max(self.shape.size * 1e-2, abs(far))
        rates = sign[tight, None] * rows.slope[tight]
        up = rates.max(axis=0) if nearest else rates.min(axis=0)
        down = (-rates).max(axis=0) if nearest else (-rates).min(axis=0)
        sensitivity = {
            name: (float(up[i]), float(down[i])) for i, name in enumerate(self.shape.free[:n])
        }
        return self._held(best, weight), sensitivity, rows.point[tight][:32]

    def _held(self, best: Found, weight: np.ndarray) -> dict[str, float]:
        """How the objective changes with each held dimension, by the multipliers of the last program."""
        names, slopes = [], []
        for name in self.shape.held:
            step = 1e-6 * self.shape.size
            behind = self.shape.changed(name, -step, best.placed.numbers)
            ahead = self.shape.changed(name, step, best.placed.numbers)
            if ahead is not None and behind is not None:
                names.append(name)
                slopes.append((behind, ahead, 2.0 * step))
        here = self.shape.at(best.placed.numbers)
        if not names or here is None:
            return {}
        pair = self.target.rows(here, slopes, best.samples, best.given)
        rows = joined_rows(list(pair)) if self.target.mode == "nearest" else self.target.gaps(pair)
        slope, k = rows.slope[best.chosen], len(best.chosen)
        if self.target.mode == "nearest":
            rates = weight[k:] @ slope - weight[:k] @ slope
        else:  # the program counts gaps in units of size and areas in units of its square
            rates = self._area_slope(slopes) + (weight @ slope) * self.shape.size
        unit = 1.0 if self.target.mode == "nearest" else self.shape.size
        found = {name: float(rate) for name, rate in zip(names, rates, strict=True)}
        found = {name: rate for name, rate in found.items() if abs(rate) > 1e-6 * unit}
        return dict(sorted(found.items(), key=lambda item: -abs(item[1])))


def _starts_of(curve) -> np.ndarray:
    """(k, 2) the first point of each contour."""
    firsts = np.flatnonzero(np.diff(curve.contour, prepend=-1))
    return curve.point(curve.limits[firsts, 0])
