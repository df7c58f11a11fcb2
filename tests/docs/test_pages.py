"""Pages follow the project: Installing its file, the changelog its release, the glossary the code."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

import clearance
from clearance.geometry import surface_cache
from clearance.geometry.shapes import box
from tests.docs.code_blocks import GUIDE, ROOT

PAGE = (GUIDE / "installing.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ROW = re.compile(r"^\| `([\w.-]+)` \|([^|\n]*)\|", re.MULTILINE)


def rows_of(title: str) -> dict[str, str]:
    """The first two cells of each row of the table under a title; the first is a name."""
    _, _, below = PAGE.partition(f"\n## {title}\n")
    return dict(ROW.findall(below.partition("\n## ")[0]))


def names_of(requirements: list[str]) -> set[str]:
    """The names of libraries; of our own package those of the extras."""
    named = [
        re.fullmatch(r"([\w.-]+)(?:\[([\w,]+)\])?.*", given).groups() for given in requirements
    ]
    return {
        name
        for library, extras in named
        for name in (extras.split(",") if library == "clearance" else [library])
    }


def test_the_page_lists_the_required_libraries():
    assert set(rows_of("Required libraries")) == names_of(PROJECT["dependencies"])


def test_the_page_lists_the_extras_and_the_libraries_of_each():
    listed = {
        extra: set(re.findall(r"`([\w.-]+)`", cell)) for extra, cell in rows_of("Extras").items()
    }
    brought = PROJECT["optional-dependencies"]
    assert listed == {extra: names_of(required) for extra, required in brought.items()}


DOORS = {
    "clearance/view/server.py": {"http.server"},
    "clearance/batch/dask_engine.py": {"distributed"},
}
"""The only files that open a connection: to this machine, and to a scheduler that the user names."""

NETWORK = re.compile(
    r"(socket|ssl|ftplib|smtplib|socketserver|asyncio|requests|httpx|urllib3|urllib\.request"
    r"|http\.client|http\.server|xmlrpc|websockets|zmq|distributed)(\.|$)"
)


def network_imports(path: Path) -> set[str]:
    """The modules for networks that a file imports, wherever in it."""
    text = path.read_text(encoding="utf-8")
    if not re.search("socket|ssl|ftp|smtp|asyncio|request|http|urllib|rpc|zmq|distributed", text):
        return set()
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    matches = map(NETWORK.match, found)
    return {match[1] for match in matches if match}


def test_only_the_viewer_and_workers_of_a_cluster_open_a_connection():
    found = {
        str(path.relative_to(ROOT)): modules
        for path in (ROOT / "clearance").rglob("*.py")
        if (modules := network_imports(path))
    }
    assert found == DOORS


@pytest.mark.cold
def test_the_cache_lies_where_the_page_says(monkeypatch, tmp_path):
    assert "`~/.cache/clearance`" in PAGE and "`XDG_CACHE_HOME`" in PAGE
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    place = surface_cache._path_of(box((1, 1, 1)))
    assert place.is_relative_to(tmp_path / ".cache" / "clearance")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    place = surface_cache._path_of(box((1, 1, 1)))
    assert place.is_relative_to(tmp_path / "caches" / "clearance")
    assert f"{surface_cache.MOST_BYTES // 1_000_000} MB" in PAGE


def test_the_newest_release_is_this_version():
    text = (ROOT / "clearance" / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", text, re.MULTILINE)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert releases[0][0] == project["version"] == clearance.__version__
    assert [date for _, date in releases] == sorted((date for _, date in releases), reverse=True)


TERM = re.compile(r"^\| ([^|]+) \| ([^|]+) \| `([^`|]+)` \|$", re.MULTILINE)
TEXT = (GUIDE / "terms.md").read_text(encoding="utf-8")
ROWS = TERM.findall(TEXT)


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
