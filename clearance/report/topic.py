"""A topic: one thing that reports tell, from its keys in the summary to its rows in a terminal and its section."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from clearance.report.blocks import Section
from clearance.report.model import PageContent, ReportModel

Line = tuple[str, str]
"""A line in a terminal: its label, and what it says."""


class TerminalTable(NamedTuple):
    """A table in a terminal; a heading that begins with `>` stands over numbers, to the right."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


class Topic(NamedTuple):
    """What a topic has to tell, and where.

    Attributes:
        data: its keys of `summary.json`. lines: in a terminal. sections: of the page.
    """

    data: Callable[[ReportModel], dict[str, Any]] | None = None
    lines: Callable[[ReportModel], Iterable[Line | TerminalTable]] | None = None
    sections: Callable[[PageContent], Iterable[Section]] | None = None


def labelled(label: str, lines: Iterable[str]) -> Iterable[Line]:
    """Lines under one label."""
    return ((label if i == 0 else "", line) for i, line in enumerate(lines))
