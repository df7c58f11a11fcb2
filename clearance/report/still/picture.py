"""A PNG of the worst moment: what the page shows first, the gap from near in a corner, and what it is in words.

An adapter of matplotlib, which sets the words. Not for: drawing bodies (`drawing`), nor the motion (`page`).
"""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING

import numpy as np

from clearance.extras import importing
from clearance.findings.verdict import Verdict, moment_line, verdict_of
from clearance.record.record import Record
from clearance.record.replay import Replay
from clearance.record.wording import limits_text
from clearance.report.still.camera import at_gap, overview
from clearance.report.still.drawing import drawn, edges_of
from clearance.report.still.scene import COLOURS, Still, still_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 1280, 800
"""[pixels]"""

INSET_WIDTH, INSET_HEIGHT, MARGIN = 400, 250, 20
"""[pixels] of the gap from near."""

_INK, _FAINT, _SUSPECT = "#17202b", "#5d6975", "#6b2fa0"
_DOTS_PER_INCH = 100
_MOST_LETTERS = 150


def png_of(record: Record, replay: Replay) -> bytes:
    """The picture; the same record gives the same bytes.

    Raises:
        Unavailable: matplotlib is not installed.
    """
    with importing("report", "a picture"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure((WIDTH / _DOTS_PER_INCH, HEIGHT / _DOTS_PER_INCH), _DOTS_PER_INCH)
    canvas = FigureCanvasAgg(figure)
    figure.figimage(_drawn(still_of(replay)), origin="upper")
    _write_words(figure, record, verdict_of(record))
    file = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a letter that the font has not is a box
        canvas.print_png(file, metadata={"Software": None})
    return file.getvalue()


def _drawn(still: Still) -> np.ndarray:
    """(HEIGHT, WIDTH, 3) uint8 the moment, and the gap from near in a frame in the lower left corner."""
    edges = edges_of(still)
    image = drawn(still, overview(still), WIDTH, HEIGHT, edges)
    bottom = HEIGHT - MARGIN
    framed = image[bottom - INSET_HEIGHT - 2 : bottom, MARGIN : MARGIN + INSET_WIDTH + 2]
    framed[:] = (118, 130, 143)
    framed[1:-1, 1:-1] = drawn(still, at_gap(still), INSET_WIDTH, INSET_HEIGHT, edges)
    return image


def _write_words(figure: Figure, record: Record, verdict: Verdict) -> None:
    """The verdict, the moment, and the limits and what was not checked, one below the other."""
    hue = COLOURS.get(verdict.status)
    limits = record.case.limits
    rest = [
        limits_text(limits.fail, limits.warn),
        *verdict.scope,
    ]
    lines = (
        (
            f"{verdict.text(str.upper)}   {record.case.name}",
            15,
            _SUSPECT if hue is None else f"#{hue:06x}",
            "bold",
        ),
        (moment_line(record, record.worst), 12, _INK, "normal"),
        (", ".join(rest), 10, _FAINT, "normal"),
    )
    top = MARGIN
    for text, size, colour, weight in lines:
        figure.text(
            MARGIN / WIDTH, 1.0 - top / HEIGHT, _short(text), va="top", parse_math=False, fontsize=size,
            color=colour, weight=weight, family="DejaVu Sans",
            bbox={"facecolor": "#fafbfc", "alpha": 0.8, "edgecolor": "none", "pad": 2},
        )  # fmt: skip
        top += round(size * _DOTS_PER_INCH / 72 * 1.5)
    below = HEIGHT - MARGIN - INSET_HEIGHT - 8
    figure.text(
        MARGIN / WIDTH, 1.0 - below / HEIGHT, "the gap from near", va="bottom", fontsize=9, color=_FAINT,
        family="DejaVu Sans",
    )  # fmt: skip


def _short(text: str) -> str:
    return text if len(text) <= _MOST_LETTERS else f"{text[: _MOST_LETTERS - 1]}…"
