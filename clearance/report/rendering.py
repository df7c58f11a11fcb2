"""Pages from templates: all that comes from data is escaped, our own scripts and styles are not.

Not for: the page of a report, which moves a replay (`page`).
"""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from clearance import __version__
from clearance.report.blocks import Header, Section

TEMPLATES = Path(__file__).parent / "templates"


def render(template: str, **values: Any) -> str:
    """The text of a template."""
    return _environment().get_template(template).render(values)


@functools.cache
def _environment() -> Environment:
    loader = FileSystemLoader(TEMPLATES)
    made = Environment(
        loader=loader,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals |= {"style": own_style, "script": own_script, "version": __version__}
    made.filters["inside_script"] = json_inside_script
    return made


def own_style(name: str) -> Markup:
    """A style of ours."""
    return Markup((TEMPLATES / name).read_text(encoding="utf-8"))


def own_script(name: str) -> Markup:
    """A script of ours."""
    return inside_script((TEMPLATES / name).read_text(encoding="utf-8"))


def inside_script(text: str) -> Markup:
    """A script so that no string in it can end the script element that it stands in."""
    return Markup(re.sub(r"</(?=script)", r"<\\/", text, flags=re.IGNORECASE))


def json_inside_script(value: Any) -> Markup:
    """JSON that holds no `<`, so that nothing in it can be taken for markup."""
    return Markup(json.dumps(value, sort_keys=True, allow_nan=False).replace("<", "\\u003c"))


def plain_page(
    title: str, header: Header, sections: Sequence[Section], chart: Mapping[str, Any] | None = None
) -> str:
    """A page of curves and tables, which moves no replay.

    Args:
        chart: what is drawn where a section has a `Chart`, as `curves.chart_of` gives it.
    """
    return render("curves.html", title=title, header=header, sections=sections, chart=chart)
