"""Curves of clearance over time, thinned so that a page stays small and the least of every stretch is kept.

Not for: drawing them (`templates/chart.js`), nor the tables of all steps (`tables`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clearance.budget.columns import least_between, least_expected, least_proven
from clearance.errors import BadReport
from clearance.extras import importing
from clearance.record.record import PairMinimum, Record
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows

MOST_PARTS = 2000
"""Stretches that a screen can resolve."""

MOST_NUMBERS = 250_000
"""Numbers of the curves of all pairs together: 1.3 MB on the page."""

_TABLE = "steps.parquet"


@dataclass(frozen=True, eq=False)
class PairCurves:
    """The least clearance of each pair in each stretch of steps.

    Attributes:
        times: (k,) [s] the middle of each stretch; of each step where there are no more.
        clearances: (p, k) float32 [m], rounded down; pairs as in `minima`; NaN while one is not
            measured.
    """

    times: np.ndarray
    clearances: np.ndarray


def pair_curves(
    record: Record, minima: Sequence[PairMinimum], measured: MeasuredRows = IN_MEMORY
) -> PairCurves | None:
    """The curves; None unless every pair was measured at every step."""
    every = record.every_pair
    if every is None:
        return None
    n_pairs = every.clearance.shape[1]
    starts, middles = _stretches(record.motions[0].times, max(1, MOST_NUMBERS // n_pairs))
    least = np.fmin.reduceat(every.clearance, starts, axis=0)
    measured.let_go()
    places = {pair: i for i, pair in enumerate(zip(every.links, every.obstacles, strict=True))}
    order = [places[minimum.link, minimum.obstacle] for minimum in minima]
    return PairCurves(middles, rounded_down(least.T[order]))


def _stretches(times: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """The first steps of at most so many stretches, and the middle of each [s]."""
    n_parts = min(len(times), most)
    starts = np.arange(n_parts) * len(times) // n_parts
    ends = np.append(starts[1:], len(times)) - 1
    return starts, 0.5 * (times[starts] + times[ends])


def rounded_down(values: np.ndarray) -> np.ndarray:
    """The greatest float32 numbers that are not above."""
    near = values.astype(np.float32)
    return np.where(near > values, np.nextafter(near, np.float32(-np.inf)), near)


@dataclass(frozen=True, eq=False)
class MoreCurve:
    """A curve beside that of the clearance: what tolerances leave of it, or what was asked of a recorded run.

    Attributes:
        name: what it is called where it is pointed at. times: (k,) [s]. values: (k,) [m]; NaN where it has none.
        kind: how its line is drawn. filled: whether the space to the curve before it is.
    """

    name: str
    times: np.ndarray
    values: np.ndarray
    kind: str = "solid"
    filled: bool = False


def more_curves(record: Record) -> Iterator[MoreCurve]:
    """The curves; none where there are neither tolerances nor a recording."""
    if record.commanded is not None:
        yield _least("as commanded", record.commanded.times, record.commanded.clearances, "dash")
    if record.budget:
        times, between = record.motions[0].times, least_between(record.budget)
        proven = least_proven(record.budget)
        if between is not None:  # no bound where no pair is measured up to the next step
            proven = np.where(np.isinf(between), np.nan, np.minimum(proven, between))
        expected = np.maximum(least_expected(record.budget), proven)  # as it is told in words
        if between is None:
            yield _least("proven with tolerances, at the samples", times, proven, "dash")
            yield _least("expected, an estimate", times, expected, "dot", filled=True)
        else:
            yield _stairs("proven with tolerances", times, proven)
            yield _stairs("expected, an estimate", times, expected, "dot", filled=True)


def _least(
    name: str, times: np.ndarray, values: np.ndarray, kind: str = "solid", filled: bool = False
) -> MoreCurve:
    starts, middles = _stretches(times, MOST_PARTS)
    return MoreCurve(name, middles, np.fmin.reduceat(values, starts), kind, filled)


def _stairs(
    name: str, times: np.ndarray, values: np.ndarray, kind: str = "solid", filled: bool = False
) -> MoreCurve:
    """The curve of values that hold from each step to the next: level, with both corners where it changes."""
    starts, _ = _stretches(times, MOST_PARTS)
    corners = np.append(np.repeat(times[starts], 2)[1:], times[-1])
    return MoreCurve(name, corners, np.repeat(np.fmin.reduceat(values, starts), 2), kind, filled)


@dataclass(frozen=True, eq=False)
class ClearanceCurve:
    """Clearance over time: (n,) [s] and (n,) [m], NaN where nothing is known."""

    name: str
    times: np.ndarray
    clearances: np.ndarray

    @property
    def thinned(self) -> ClearanceCurve:
        """The curve with at most `MOST_PARTS` points: of each stretch its least, at the time where that is."""
        n = len(self.times)
        if n <= MOST_PARTS:
            return self
        starts = np.arange(MOST_PARTS) * n // MOST_PARTS
        ends = np.append(starts[1:], n)
        far = np.where(np.isnan(self.clearances), np.inf, self.clearances)
        least = np.array([a + np.argmin(far[a:b]) for a, b in zip(starts, ends, strict=True)])
        return ClearanceCurve(self.name, self.times[least], self.clearances[least])


AT_SAMPLES = "Straight lines join the samples: between these, the curves prove nothing."


def chart_of(
    curves: Sequence[ClearanceCurve], limit: float, called: str = "fail"
) -> dict[str, Any]:
    """What a chart of curves side by side is drawn from: seconds and, rounded down, millimetres.

    Args:
        limit: [m] and what it is `called`.
    """
    drawn = [
        {
            "name": one.name,
            "times": one.times.round(6).tolist(),
            "clearances": millimetres(one.clearances),
        }
        for one in (curve.thinned for curve in curves)
    ]
    return {"limit": limit * 1000.0, "called": called, "curves": drawn}


def millimetres(metres: np.ndarray) -> list[float | None]:
    """[mm] to a thousandth, rounded down; None where nothing is known."""
    down = np.floor(metres * 1e6) / 1e3
    return [
        value if known else None
        for value, known in zip(down.tolist(), np.isfinite(down), strict=True)
    ]


def curve_in(name: str, place: Path) -> ClearanceCurve | None:
    """The curve of a report folder; None where there is no table of steps.

    Raises:
        BadInput: a damaged table.
    """
    if not (place / _TABLE).is_file():
        return None
    with importing("tables", "a report's table of steps"):
        import pyarrow as pa
        import pyarrow.parquet as parquet

    try:
        table = parquet.read_table(place / _TABLE)
        return curve_of(name, {key: table[key].to_numpy() for key in table.column_names})
    except (pa.ArrowException, KeyError, OSError, TypeError) as error:
        raise BadReport(
            f"no table of steps: {error!s:.100}", where=str(place / _TABLE), valid="a report folder"
        ) from None


def curve_of(name: str, steps: Mapping[str, Any]) -> ClearanceCurve:
    """The curve of a table of steps: their clearances, or their bounds where only those are known."""
    times, clearances = (np.asarray(steps[key], np.float64) for key in ("time", "clearance"))
    if "lower_bound" in steps:
        clearances = np.where(np.isnan(clearances), steps["lower_bound"], clearances)
    return ClearanceCurve(name, times, clearances)
