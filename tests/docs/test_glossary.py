"""The glossary follows the code: the file of each term is there, and has the term and the name of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.docs.code_blocks import GUIDE, ROOT

ROW = re.compile(r"^\| ([^|]+) \| ([^|]+) \| `([^`|]+)` \|$", re.MULTILINE)
TEXT = (GUIDE / "terms.md").read_text(encoding="utf-8")
ROWS = ROW.findall(TEXT)


def sources_of(place: Path) -> str:
    files = sorted(place.rglob("*.py")) if place.is_dir() else [place]
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def parts_of(cell: str) -> tuple[list[str], list[str]]:
    """The terms of a cell and the names of the code in it."""
    names = re.findall(r"`([^`]+)`", cell)
    terms = [part.strip() for part in re.sub(r"`[^`]+`", "", cell).split(",") if part.strip()]
    return terms, names


def test_every_row_names_a_file():
    tables = TEXT[: TEXT.index("## Names in the code")]
    rows = [line for line in tables.splitlines() if line.startswith("| ")]
    assert len(rows) == len(ROWS) + tables.count("| term |")


@pytest.mark.parametrize(("cell", "meaning", "place"), ROWS, ids=[row[0] for row in ROWS])
def test_the_file_of_a_term_holds_it(cell, meaning, place):
    text = place + sources_of(ROOT / place)
    terms, names = parts_of(cell)
    words = {word for term in terms for word in term.removeprefix("to ").split()}
    absent = [word for word in words if word.lower()[:7] not in text.lower()]
    assert (absent, [name for name in names if not re.search(rf"\b{name}\b", text)]) == ([], [])
