"""Answers as they are told, word for word, of runs that are made by hand and of a cell of boxes.

    python -m tests.report.test_golden

writes them anew, for whoever means a change of words, and reads what changed.
"""

from __future__ import annotations

import functools
import html
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

import clearance as cl
from clearance.findings.comparison import compared
from clearance.report.annotations import annotation_lines
from clearance.report.comparison import comparison_page
from clearance.report.junit_cases import write_run_junit
from clearance.report.markdown import markdown
from clearance.report.moveit_moments import moments_text
from clearance.report.summary import json_text
from clearance.report.topics import certainty
from clearance.run import Run
from clearance.world.case import Limits
from tests.findings.test_verdict import CASES, made
from tests.report.cells import cell
from tests.report.made import model_of, page_of, printed, run_of
from tests.report.records import disagreeing, record, with_budget, with_contacts

HERE = Path(__file__).parent / "golden"

SWING = with_contacts(record(cross_check=disagreeing()))
OPEN = with_budget(made(Limits(warn=0.02)), 0.0025)
SUSPECT = CASES["suspect and contact"][0]


@functools.cache
def cell_run() -> Run:
    """Measured, and all that is told of it can be worked out by hand."""
    return cl.check(cell(), need="pairs")


def test_notes_that_begin_as_one_before_them_are_counted_behind_it():
    corners = [
        f"a.src: corner zone of 20 mm after LIN {i}, {i}.5 s: up to {i} mm" for i in range(1, 19)
    ]
    made = record(
        notes=(*corners, "a.src: IF is taken as true", "arm.urdf: 1 link without any shape")
    )
    told = [
        text for label, text in certainty.lines(model_of(run_of(made))) if label in ("note", "")
    ]
    folded = f"{corners[0]}; and 17 more notes like it, see --json"
    assert told[-3:] == [folded, *made.notes[-2:]]


def terminal(one) -> str:
    return "\n".join([*printed(one, Path("out")), ""])


def page(text: str) -> str:
    """What a page says, where its rows lead, and what they say when pointed at."""
    text = re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    text = re.sub(r"<[^>]+?((?: (?:data-\w+|title|href)=\"[^\"]*\")*)[^>]*>", r"\n\1\n", text)
    lines = (" ".join(html.unescape(line).split()) for line in text.split("\n"))
    return "\n".join(filter(None, lines)) + "\n"


def summary(one, *topics: str) -> str:
    """A summary whole, or some topics of it."""
    told = run_of(one).summary
    told |= {"versions": sorted(told["versions"])}
    return json_text({topic: told[topic] for topic in topics} if topics else told)


def junit(one) -> str:
    with tempfile.TemporaryDirectory() as folder:
        write_run_junit(model_of(one), Path(folder, "junit.xml"))
        return Path(folder, "junit.xml").read_text(encoding="utf-8")


def compared_page() -> str:
    lists = [run_of(one).finding_list for one in (record(limits=Limits(0.01, 0.1)), record())]
    return page(comparison_page(compared(*lists), [], ("before", "now")))


def without_versions(text: str) -> str:
    """A text without what other libraries and other ways of measuring change."""
    text = re.sub(r'"tally": \{[^}]*\}', '"tally": {}', text)
    return re.sub(
        r"^(clearance .*, python .*|clearance \d.*|Counted: .*)$", "versions", text, flags=re.M
    )


ANSWERS: dict[str, Callable[[], str]] = {
    "swing.terminal.txt": lambda: terminal(SWING),
    "swing.page.txt": lambda: page(page_of(SWING)),
    "short.summary.json": lambda: summary(record(n_steps=24)),
    "swing.junit.xml": lambda: junit(SWING),
    "swing.moments.yaml": lambda: moments_text(model_of(SWING)),
    "swing.md": lambda: markdown(model_of(SWING)),
    "open.terminal.txt": lambda: terminal(OPEN),
    "open.page.txt": lambda: page(page_of(OPEN)),
    "open.tolerances.json": lambda: summary(OPEN, "verdict", "exit_code", "tolerances"),
    "open.junit.xml": lambda: junit(OPEN),
    "open.annotations.txt": lambda: "\n".join(annotation_lines(model_of(OPEN), HERE)),
    "cell.terminal.txt": lambda: terminal(cell_run()),
    "cell.page.txt": lambda: page(page_of(cell_run())),
    "cell.actors.json": lambda: summary(
        cell_run(), "actors", "carries", "clock", "paddings", "rules"
    ),
    "cell.junit.xml": lambda: junit(cell_run()),
    "suspect.annotations.txt": lambda: "\n".join(annotation_lines(model_of(SUSPECT), HERE)),
    "two_robots.notebook.txt": lambda: page(run_of(record(n_robots=2))._repr_html_()),
    "comparison.page.txt": compared_page,
}


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_is_told_as_ever(name):
    assert without_versions(ANSWERS[name]()) == (HERE / name).read_text(encoding="utf-8")


if __name__ == "__main__":
    for file, answer in ANSWERS.items():
        (HERE / file).write_text(without_versions(answer()), encoding="utf-8")
