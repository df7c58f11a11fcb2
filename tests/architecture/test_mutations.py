"""The tables of seeded faults fit the tree: each can be seeded, and the tests that find it are there."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
FAULTS = {
    f"{table.stem}/{name}": row
    for table in sorted((ROOT / "scripts" / "mutations").glob("*.toml"))
    for name, row in tomllib.loads(table.read_text(encoding="utf-8")).items()
}


def text_of(room: str) -> str:
    return "\0".join(path.read_text(encoding="utf-8") for path in (ROOT / room).rglob("*.py"))


def test_each_fault_is_listed_once_and_says_what_is_wrong():
    assert len(FAULTS) >= 60 and len({name.partition("/")[2] for name in FAULTS}) == len(FAULTS)
    assert [name for name, row in FAULTS.items() if not row["fault"].endswith(".")] == []
    assert [name for name, row in FAULTS.items() if row["before"] == row["after"]] == []


def test_the_text_that_a_fault_replaces_is_in_the_package_once():
    package = text_of("clearance")
    counts = {name: package.count(row["before"]) for name, row in FAULTS.items()}
    assert {name: n for name, n in counts.items() if n != 1} == {}


def test_the_tests_that_find_a_fault_are_there():
    """A test that is renamed is renamed in the tables too; one that goes leaves its faults to another."""
    known = set(re.findall(r"^def (test_\w+)\(", text_of("tests"), re.MULTILINE))
    missing = {name: set(row["killed_by"]) - known for name, row in FAULTS.items()}
    assert {name: tests for name, tests in missing.items() if tests} == {}
    assert all(row["killed_by"] for row in FAULTS.values())
