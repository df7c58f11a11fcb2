"""A run in a line, in the few lines that a notebook shows, and its page as a notebook or a browser shows it.

Not for: what is on the page (`page`).
"""

from __future__ import annotations

import html
import os
import sys
import tempfile
import webbrowser
from dataclasses import dataclass
from pathlib import Path

from clearance.errors import BadDimension
from clearance.record.wording import depth_text, limits_text, mm, moment_text
from clearance.report.blocks import Bullets, Row, Table
from clearance.report.model import ReportModel
from clearance.report.moment import BODIES
from clearance.report.topics.pairs import MOST_LINES, PairJudge, pair_figures


def run_text(model: ReportModel) -> str:
    """Name, verdict, least clearance, who and when, in one line."""
    return f"{model.record.case.name}: {model.verdict.headline()}, {_worst(model)}"


def run_html(model: ReportModel) -> str:
    """The same with what must be known beside it, and the closest pairs as a table."""
    from clearance.report.rendering import render

    record, verdict = model.record, model.verdict
    limits = record.rule(verdict.worst.rule).limits
    several, judge = bool(record.case.limits.rules), PairJudge.of(record)
    rows = [
        Row([pair.link, pair.obstacle, *pair_figures(pair, judge), *([pair.rule] * several)])
        for pair in model.session.motion_minima(MOST_LINES)
    ]
    return render(
        "notebook.html",
        title=f"{record.case.name}: {verdict.headline()}",
        worst=f", {_worst(model)} ({limits_text(limits.fail, limits.warn)})",
        beside=Bullets(verdict.reservations),
        nearest=Table(
            (*BODIES[record.sides[0]], ">mm", ">Step", ">s", *(["Rule"] * several)), rows
        ),
    )


@dataclass(frozen=True)
class ShownPage:
    """The page of a report, which a notebook shows as the result of a cell.

    Attributes:
        text: HTML. height: in a notebook [pixels]. path: the file that the browser has opened, if it was asked to.
    """

    text: str
    height: int
    path: Path | None = None

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" width="100%" height="{self.height}" '
            'style="border: 0"></iframe>'
        )

    def __repr__(self) -> str:
        place = "a notebook shows it" if self.path is None else f"opened from {self.path}"
        return f"<ShownPage {place}>"


def shown_page(text: str, height: int) -> ShownPage:
    """The page for a notebook; where none runs, it is opened in the browser, from a temporary file that stays.

    Raises:
        BadDimension: a height below 1.
    """
    if height < 1:
        raise BadDimension(f"the height is {height}", valid="1 or more pixels")
    if _is_notebook():
        return ShownPage(text, height)
    handle, name = tempfile.mkstemp(prefix="clearance-", suffix=".html")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    webbrowser.open(Path(name).as_uri(), new=2)
    return ShownPage(text, height, Path(name))


def _is_notebook() -> bool:
    """True in a kernel of Jupyter; a terminal, also one of IPython, shows no HTML."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def _worst(model: ReportModel) -> str:
    record, worst = model.record, model.verdict.worst
    by = f" (rule {worst.rule!r})" if record.case.limits.rules else ""
    near = depth_text(worst.depth) if worst.touches else f"{mm(worst.clearance)} mm"
    return f"{near}{by}, {worst.link} - {worst.obstacle} at {moment_text(record, worst)}"
