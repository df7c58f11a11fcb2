"""HTML from values: what every part of the page is built with. Text from outside is escaped here
only."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any


class Html(str):
    """Text that is already HTML."""

    __slots__ = ()


def element(tag: str, *content: object, **attributes: object) -> Html:
    """`<tag ...>content</tag>` with everything escaped that is not `Html`; `_` in a name becomes
    `-`."""
    inner = "".join(part if isinstance(part, Html) else escape(str(part)) for part in content)
    pairs = ((name.rstrip("_").replace("_", "-"), value) for name, value in attributes.items())
    given = "".join(f' {name}="{escape(str(value))}"' for name, value in pairs if value is not None)
    return Html(f"<{tag}{given}>{inner}</{tag}>")


def section(title: str, *content: Html) -> Html:
    """A part of the page with its title."""
    return element("section", element("h2", title), *content)


def table(
    heads: Iterable[str], rows: list[Html], class_: str | None = None, *, tall: bool = False
) -> Html:
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


def step_link(step: int) -> Html:
    """A link that moves the replay to a step."""
    return element("a", f"step {step:,}", href="#stage", data_step=step)


def moment_link(moment: dict[str, Any], text: str) -> Html:
    """A link that moves the replay to a step, or to a moment between two."""
    at = {"data_time": moment["time"]} if moment["between"] else {"data_step": moment["step"]}
    return element("a", text, href="#stage", **at)
