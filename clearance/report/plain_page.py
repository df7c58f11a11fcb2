"""A page of curves and tables, which moves no replay: head, look and foot around what it says.

Not for: the page of a report (`page`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from clearance.report.blocks import Header, Section
from clearance.report.rendering import render


@dataclass(frozen=True)
class Chart:
    """Where the curves of a page are drawn, with a key: `a` or `b`, and the name, of each."""

    template: ClassVar[str] = "chart"
    names: Sequence[tuple[str, str]]


def plain_page(
    title: str, header: Header, sections: Sequence[Section], chart: Mapping[str, Any] | None = None
) -> str:
    """The whole page.

    Args:
        chart: what is drawn where a section has a `Chart`, as `curves.chart_of` gives it.
    """
    return render("curves.html", title=title, header=header, sections=sections, chart=chart)
