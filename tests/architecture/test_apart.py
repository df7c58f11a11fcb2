"""Tests and benchmarks import nothing of each other; what both draw is made in `scripts/makers`."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]


def imported(text: str) -> Iterator[str]:
    """The modules that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def ties(room: str, other: str) -> list[str]:
    """The files of a room that import something of another."""
    texts = {path: path.read_text(encoding="utf-8") for path in sorted((ROOT / room).rglob("*.py"))}
    top = other.partition(".")[0]  # to parse all files takes seconds
    return [
        path.relative_to(ROOT).as_posix()
        for path, text in texts.items()
        if top in text and any(f"{name}.".startswith(f"{other}.") for name in imported(text))
    ]


def test_tests_do_not_import_benchmarks():
    assert ties("tests", "scripts.bench") == []


def test_benchmarks_and_makers_do_not_import_tests():
    assert ties("scripts", "tests") == []


def test_a_tie_is_seen():
    assert list(imported("def f():\n    from scripts.bench import inputs\nimport tests.cells")) == [
        "tests.cells",
        "scripts.bench.inputs",
    ]
    assert ties("tests", "scripts.makers") != []
