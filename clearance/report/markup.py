"""HTML from values: what every part of the page is built with. Text that is no `Markup` is escaped here only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from markupsafe import Markup, escape


def element(tag: str, *content: object, **attributes: object) -> Markup:
    """`<tag ...>content</tag>` with everything escaped that is not `Markup`; `_` in a name becomes `-`."""
    inner = Markup("".join(map(escape, content)))
    pairs = ((name.rstrip("_").replace("_", "-"), value) for name, value in attributes.items())
    given = "".join(f' {name}="{escape(str(value))}"' for name, value in pairs if value is not None)
    return Markup(f"<{tag}{given}>{inner}</{tag}>")


def section(title: str, *content: Markup) -> Markup:
    """A part of the page with its title."""
    return element("section", element("h2", title), *content)


def table(
    heads: Iterable[str], rows: list[Markup], class_: str | None = None, *, tall: bool = False
) -> Markup:
    """A table that scrolls in a box of its own where it is too wide; a heading that begins with `>` stands over
    numbers, to the right. One that is `tall` scrolls where it is too high as well."""
    cells = [
        element(
            "th", name.lstrip(">"), scope="col", class_="number" if name.startswith(">") else None
        )
        for name in heads
    ]
    head = element("tr", *cells)
    body = element("table", element("thead", head), element("tbody", *rows), class_=class_)
    return element("div", body, class_="scroll tall" if tall else "scroll")


def step_link(step: int) -> Markup:
    """A link that moves the replay to a step."""
    return element("a", f"step {step:,}", href="#stage", data_step=step)


def moment_link(moment: dict[str, Any], text: str) -> Markup:
    """A link that moves the replay to a step, or to a moment between two."""
    at = {"data_time": moment["time"]} if moment["between"] else {"data_step": moment["step"]}
    return element("a", text, href="#stage", **at)
