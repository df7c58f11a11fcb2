"""A page without a script: head, look and foot around what a page of curves and tables says.

Not for: the page of a report, which moves a replay (`page`).
"""

from __future__ import annotations

from pathlib import Path
from string import Template

from markupsafe import Markup

from clearance import __version__
from clearance.report.head import head_of
from clearance.report.markup import element

_HERE = Path(__file__).parent


def plain_page(title: str, header: Markup, content: Markup, own_style: str = "") -> str:
    """The whole page; `own_style` is of this one alone."""
    page, style = (
        (_HERE / name).read_text(encoding="utf-8") for name in ("plain_page.html", "plain_page.css")
    )
    return Template(page).substitute(
        head=head_of(title, style + own_style),
        header=header,
        content=content,
        footer=element("p", f"clearance {__version__}"),
    )
