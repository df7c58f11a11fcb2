"""What a page says, as data: sections of paragraphs, lists and tables, and links that move the replay.

Each kind of block has a template of its name (`templates/blocks`). Not for: how it looks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple


class At(NamedTuple):
    """What the replay shows after a click: a step, or the moment at a time [s] of the run, which comes first."""

    step: int | None = None
    time: float | None = None


@dataclass(frozen=True)
class Inline:
    """Words in a line that look otherwise, or lead somewhere.

    Attributes:
        kind: class of its style. element: of HTML. at: where a click moves the replay. href: where it leads else.
    """

    text: str
    kind: str = ""
    element: str = "span"
    at: At | None = None
    href: str = ""
    title: str = ""


Content = str | Inline | Sequence[str | Inline]
"""Words of a line, and what stands among them."""


@dataclass(frozen=True)
class Cell:
    """A cell of a table that looks otherwise than others."""

    content: Content
    kind: str = ""
    colspan: int = 1


@dataclass(frozen=True)
class Row:
    """A row of a table; with `at` it moves the replay."""

    cells: Sequence[Content | Cell]
    at: At | None = None
    kind: str = ""


@dataclass(frozen=True)
class Table:
    """A table that scrolls in a box of its own where it is too wide; one that is `tall`, where it is too high too.

    A heading that begins with `>` stands over numbers, to the right.
    """

    template: ClassVar[str] = "table"
    heads: Sequence[str]
    rows: Sequence[Row]
    kind: str = ""
    tall: bool = False


@dataclass(frozen=True)
class Paragraph:
    """Words."""

    template: ClassVar[str] = "paragraph"
    content: Content
    kind: str = ""


@dataclass(frozen=True)
class Bullets:
    """Lines, each with a look of its own or none."""

    template: ClassVar[str] = "bullets"
    lines: Sequence[Content | Cell]
    kind: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture, given as a URL that holds it."""

    template: ClassVar[str] = "picture"
    source: str
    alt: str


@dataclass(frozen=True)
class Chart:
    """Where the curves of a page are drawn, with a key: `a` or `b`, and the name, of each."""

    template: ClassVar[str] = "chart"
    names: Sequence[tuple[str, str]]


Block = Table | Paragraph | Bullets | Picture | Chart
"""What most sections are made of; a topic may have blocks of its own, with a template."""


@dataclass(frozen=True)
class Section:
    """A part of a page with its title; the blocks are `Block`s or a topic's own."""

    title: str
    blocks: Sequence[object]


@dataclass(frozen=True)
class Header:
    """The top of a page: a title, a badge with its look, lines below, and facts with their names."""

    kicker: str
    title: str
    badge: str
    badge_kind: str
    lines: Sequence[Bullets] = ()
    facts: Sequence[tuple[str, Content]] = ()


def number(text: str) -> Cell:
    """A cell to the right."""
    return Cell(text, "number")


def faint(text: str) -> Paragraph:
    """Words that may be passed over."""
    return Paragraph(text, "faint")


def capital(text: str) -> str:
    """A line with its first letter as a capital."""
    return text[0].upper() + text[1:]
