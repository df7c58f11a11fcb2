"""Help, guide, codes and templates have no long sentence, and no word of the list of unclear words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import click

from clearance.cli.commands import clearance as command_line
from clearance.codes import entries
from tests.docs.code_blocks import PAGES, ROOT
from tests.docs.plain_words import unclear

TEMPLATES = ROOT / "clearance" / "report" / "templates"


def helps(command: click.Command, name: str) -> Iterator[tuple[str, str]]:
    """The name and the text of each command and option, in one line each."""
    yield name, " ".join((command.help or "").split())
    for parameter in command.params:
        if text := getattr(parameter, "help", None):
            yield f"{name} {parameter.opts[0]}", text
    if isinstance(command, click.Group):
        for word, below in command.commands.items():
            yield from helps(below, f"{name} {word}")


def prose_of(page: Path) -> str:
    """A page without blocks, addresses and code; the lines of a sentence are one."""
    text = re.sub(
        r"```.*?```|\]\([^)]*\)|`[^`\n]*`", "CODE", page.read_text("utf-8"), flags=re.DOTALL
    )
    return re.sub(r"(?<=[\w,;:.)])\n *(?=[\w(*\[])", " ", text)


def texts() -> Iterator[tuple[str, str]]:
    """Where each text for users stands, and the text."""
    yield from helps(command_line, "clearance")
    for page in PAGES:
        yield from ((f"{page.name}", line) for line in prose_of(page).splitlines())
    for code, entry in entries().items():
        yield from (
            (code, text) for text in (entry.title, entry.means, entry.matters, entry.remedy)
        )
    for page in TEMPLATES.rglob("*.html"):
        labels = re.findall(r">([^<>{}]+)<", page.read_text("utf-8"))
        yield from ((page.name, " ".join(label.split())) for label in labels)


def test_texts_for_users_are_plain():
    read = list(texts())
    faults = [f"{where}: {fault}" for where, text in read for fault in unclear(text)]
    assert len(read) > 2000 and faults == []
