"""Two curves of clearance over time as one SVG, drawn here: no script, no library, the same bytes again.

Not for: the page around it (`comparison_page`), nor the curve of a report, which moves the replay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from clearance.report.markup import element

WIDTH, HEIGHT = 1000, 340
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 14, 12, 40  # room around the plot

MOST_POINTS = 2000
"""Of a curve; of each stretch the least is kept."""


@dataclass(frozen=True, eq=False)
class ClearanceCurve:
    """Clearance over time: (n,) [s] and (n,) [m], NaN where nothing is known."""

    name: str
    times: np.ndarray
    clearances: np.ndarray

    @property
    def thinned(self) -> ClearanceCurve:
        """The curve with at most `MOST_POINTS`: of each stretch its least, at the time where that is."""
        n = len(self.times)
        if n <= MOST_POINTS:
            return self
        starts = np.arange(MOST_POINTS) * n // MOST_POINTS
        ends = np.append(starts[1:], n)
        far = np.where(np.isnan(self.clearances), np.inf, self.clearances)
        least = np.array([a + np.argmin(far[a:b]) for a, b in zip(starts, ends, strict=True)])
        return ClearanceCurve(self.name, self.times[least], self.clearances[least])


def chart(curves: Sequence[ClearanceCurve], fail: float, called: str = "fail") -> Markup:
    """The curves in one picture, in seconds and millimetres, with a limit [m] and what it is called."""
    thinned = [curve.thinned for curve in curves]
    axes = _Axes.of(thinned, fail)
    marks: list[Markup] = [*axes.grid()]
    if fail > 0.0:
        y = axes.y(fail)
        marks.append(_line(_LEFT, y, WIDTH - _RIGHT, y, class_="limit"))
        marks.append(_text(WIDTH - _RIGHT - 4, y - 4, f"{called} {fail * 1000:g} mm", "end"))
    for i, curve in enumerate(thinned):
        for part in axes.parts(curve):
            marks.append(element("polyline", points=part, class_=f"curve c{i}"))
    title = element("title", f"Clearance over time: {' and '.join(curve.name for curve in curves)}")
    return element(
        "svg", title, *marks, viewBox=f"0 0 {WIDTH} {HEIGHT}", role="img", class_="chart"
    )


@dataclass(frozen=True)
class _Axes:
    """What the plot shows: times [s] and clearances [m]."""

    start: float
    end: float
    low: float
    high: float

    @staticmethod
    def of(curves: Sequence[ClearanceCurve], fail: float) -> _Axes:
        times = np.concatenate([curve.times for curve in curves])
        values = np.concatenate([curve.clearances for curve in curves])
        known = values[np.isfinite(values)]
        high = max(float(known.max()) if len(known) else 0.0, fail, 1e-6)
        low = min(0.0, float(known.min()) if len(known) else 0.0)
        start, end = float(times.min()), float(times.max())
        return _Axes(start, end if end > start else start + 1.0, low, 1.06 * high)

    def x(self, time: float) -> float:
        return _LEFT + (time - self.start) / (self.end - self.start) * (WIDTH - _LEFT - _RIGHT)

    def y(self, clearance: float) -> float:
        share = (clearance - self.low) / (self.high - self.low)
        return HEIGHT - _BOTTOM - share * (HEIGHT - _TOP - _BOTTOM)

    def parts(self, curve: ClearanceCurve) -> list[str]:
        """The corners of each stretch in which something is known."""
        known = np.isfinite(curve.clearances)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
        return [
            " ".join(
                f"{self.x(t):.1f},{self.y(c):.1f}"
                for t, c in zip(
                    curve.times[a:b].tolist(), curve.clearances[a:b].tolist(), strict=True
                )
            )
            for a, b in edges.reshape(-1, 2)
        ]

    def grid(self) -> list[Markup]:
        """Lines and figures of both axes."""
        found = []
        for time in _ticks(self.start, self.end, 8):
            x = self.x(time)
            found += [
                _line(x, _TOP, x, HEIGHT - _BOTTOM),
                _text(x, HEIGHT - _BOTTOM + 16, f"{time:g}"),
            ]
        for value in _ticks(self.low * 1000.0, self.high * 1000.0, 6):
            y = self.y(value / 1000.0)
            found += [
                _line(_LEFT, y, WIDTH - _RIGHT, y),
                _text(_LEFT - 6, y + 4, f"{value:g}", "end"),
            ]
        found.append(_text(WIDTH / 2, HEIGHT - 6, "time, s"))
        turned = {"transform": f"rotate(-90 14 {HEIGHT / 2:g})"}
        found.append(_text(14, HEIGHT / 2, "clearance, mm", **turned))
        return found


def _ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers in a range, at most so many."""
    raw = (high - low) / most
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * m for m in (1, 2, 5, 10) if power * m >= raw)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [float(f"{i * step:.12g}") for i in range(first, last + 1)]


def _line(x0: float, y0: float, x1: float, y1: float, class_: str = "grid") -> Markup:
    at = {"x1": f"{x0:.1f}", "y1": f"{y0:.1f}", "x2": f"{x1:.1f}", "y2": f"{y1:.1f}"}
    return element("line", class_=class_, **at)


def _text(x: float, y: float, text: str, anchor: str = "middle", **more: str) -> Markup:
    return element("text", text, x=f"{x:.1f}", y=f"{y:.1f}", text_anchor=anchor, **more)
