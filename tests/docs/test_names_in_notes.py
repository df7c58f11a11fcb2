"""What design notes and guide put in backticks is there: files, modules, functions, classes, attributes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.docs.code_blocks import PAGES, ROOT
from tests.docs.names import is_name, is_path

NOTES = sorted((ROOT / "clearance").rglob("*.md"))
SHOWN = re.compile(r"`([^`\n]+)`")
FENCED = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)

MADE = {
    "html",
    "json",
    "parquet",
    "csv",
    "md",
    "xml",
    "glb",
    "stl",
    "svg",
    "dxf",
    "urdf",
    "yaml",
    "bin",
}
"""Endings of what a run writes or a user has: no file of ours needs to be called so."""

FOREIGN = {
    "clearance/batch/NOTES.md": {"model.config"},
    "clearance/view/NOTES.md": {"zmq.py", "InterpolateDiscrete"},
    "scripts/docs/tutorials/python.md": {"run.steps", "run.events", "run.summary"},
    "scripts/docs/contributing.md": {"out/guide"},
    "scripts/docs/tutorials/gain.md": {"moved/"},
    "scripts/docs/adding_a_shape.md": {"cone.py"},
    "scripts/docs/walks.md": {"cone.py", "trajectory_parquet.py", "ball_bound.py"},
}
"""Names of other packages and robots, what a walk or a build makes, and what a variable of a page has."""

PAST = {"CHANGELOG.md", "HISTORY.md"}
"""Pages that may name what is no longer there."""


def absent_names(page: Path) -> list[str]:
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    known = FOREIGN.get(str(page.relative_to(ROOT)), set())
    return [shown for shown in SHOWN.findall(text) if not is_there(shown) and shown not in known]


def is_there(shown: str) -> bool:
    """True also for what is no name: a formula, a command, a value."""
    if shown.rpartition(".")[2] in MADE:
        return True
    if re.fullmatch(r"[\w-]+(\.[\w-]+)*(/[\w.-]+)*/?", shown) and (
        "/" in shown or shown.endswith((".py", ".js"))
    ):
        return is_path(shown) or is_path_with_name(shown)
    if re.fullmatch(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", shown):
        return is_name(shown)
    return True


def is_path_with_name(shown: str) -> bool:
    """True for `room/file.name`."""
    place, _, name = shown.rpartition(".")
    return is_path(place) and is_name(f"{Path(place).name}.{name}")


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    [page for page in (*NOTES, *PAGES) if page.name not in PAST],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_the_names_of_a_page_are_there(page):
    assert absent_names(page) == []


@pytest.mark.slow
def test_a_name_that_is_gone_is_found():
    assert is_there("descent.descend") and is_there("kernels/search/descent.py")
    assert is_there("Query.distances") and is_there("world.kinematic_chain")
    for gone in ("descent.ascend", "kernels/search/ascent.py", "no_such_name", "search/descent.up"):
        assert not is_there(gone)
