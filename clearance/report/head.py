"""What every page begins with: title, an icon that asks no server for one, and the styles that all share.

Not for: what is on a page.
"""

from __future__ import annotations

from pathlib import Path
from string import Template

from markupsafe import escape

_HERE = Path(__file__).parent


def head_of(title: str, own_style: str = "") -> str:
    """From the first line to the end of the head; `own_style` is of this page alone, after what all share."""
    template = Template((_HERE / "head.html").read_text(encoding="utf-8"))
    style = (_HERE / "page.css").read_text(encoding="utf-8")
    return template.substitute(title=escape(title), style=style + own_style).rstrip("\n")
