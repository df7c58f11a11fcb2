"""A page of curves and tables: head, look and foot around what it says, and the script that draws the curves.

Not for: the page of a report, which moves a replay (`page`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np
from markupsafe import Markup

from clearance import __version__
from clearance.report.embedded import json_inside_script, script
from clearance.report.head import head_of
from clearance.report.markup import element

_HERE = Path(__file__).parent

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


@dataclass(frozen=True, eq=False)
class CurvesWithLimit:
    """Curves that one chart shows, and a limit [m] with what it is called."""

    curves: Sequence[ClearanceCurve]
    limit: float
    called: str = "fail"

    def told(self) -> dict[str, object]:
        """What the chart is drawn from: seconds and, rounded down, millimetres."""
        thinned = [curve.thinned for curve in self.curves]
        return {
            "limit": self.limit * 1000.0,
            "called": self.called,
            "curves": [
                {
                    "name": one.name,
                    "times": one.times.round(6).tolist(),
                    "clearances": _millimetres(one.clearances),
                }
                for one in thinned
            ],
        }


def _millimetres(clearances: np.ndarray) -> list[float | None]:
    known = np.isfinite(clearances)
    down = np.floor(np.where(known, clearances, 0.0) * 1e6) / 1e3
    return [
        value if is_known else None for value, is_known in zip(down.tolist(), known, strict=True)
    ]


def plain_page(
    title: str, header: Markup, content: Markup, chart: CurvesWithLimit | None = None
) -> str:
    """The whole page; the chart is drawn into the element `curves` of the content."""
    drawn = Markup("")
    if chart is not None:
        drawn = (
            element("script", json_inside_script(chart.told()), id="data", type="application/json")
            + element("script", script("chart.js"))
            + element("script", Markup(_DRAW))
        )
    page = (_HERE / "plain_page.html").read_text(encoding="utf-8")
    return Template(page).substitute(
        head=head_of(title),
        header=header,
        content=content,
        scripts=drawn,
        footer=element("p", f"clearance {__version__}"),
    )


_DRAW = (
    'Chart.ofCurves(document.getElementById("curves"), '
    'JSON.parse(document.getElementById("data").textContent));'
)
