"""`clearance schema --results`: what runs write keeps to the printed schema, and what no run writes does not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import clearance as cl
from clearance.findings.findings_file import findings_text
from clearance.run import Run
from tests.case import test_recorded_run as recorded
from tests.report.made import run_of
from tests.report.records import record
from tests.report.schemas import printed_schema
from tests.report.test_golden import OPEN, SUSPECT, SWING, cell_run

DEMO = Path(cl.__file__).parent / "demo"

RUNS: dict[str, Callable[[Path], Run]] = {
    "contact and a dispute": lambda _: run_of(SWING),
    "tolerances": lambda _: run_of(OPEN),
    "suspect": lambda _: run_of(SUSPECT),
    "two robots": lambda _: run_of(record(n_robots=2)),
    "parts and rules": lambda _: cell_run(),
    "a program": lambda _: cl.check(DEMO / "seam.yaml", need="minimum"),
    "gaps": lambda _: cl.check(DEMO / "post.yaml", need="pairs", body_gaps=True, contact="none"),
    "a recorded run": lambda folder: cl.check(
        recorded.case(folder), motion="recorded", recorded=folder / "run.csv"
    ),
}


@pytest.fixture(scope="module")
def errors() -> Callable[[str, dict], list[str]]:
    """Asks the schema of a file, as the command prints it, what it objects to."""
    validators = {name: printed_schema("--results", name)[1] for name in ("summary", "findings")}
    return lambda name, told: [error.message for error in validators[name].iter_errors(told)]


def files(made: Run) -> dict[str, dict]:
    """What the two files of a run hold."""
    summary = json.loads(json.dumps(made.summary))
    return {"summary": summary, "findings": json.loads(findings_text(made.finding_list))}


SLOW = {"a program", "gaps", "parts and rules"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in RUNS]
)
def test_what_a_run_writes_keeps_to_the_schema_that_it_names(name, errors, tmp_path):
    for file, told in files(RUNS[name](tmp_path)).items():
        assert errors(file, told) == []
        assert told["$schema"] == f"urn:clearance:{file}:{told['format']}"


@pytest.mark.slow
def test_a_key_more_or_less_and_another_type_are_refused(errors):
    for file, told in files(cell_run()).items():
        for key in told:
            assert errors(file, {one: told[one] for one in told if one != key}), key
        assert errors(file, told | {"key": 1})
    summary = files(cell_run())["summary"]
    for key, value in {"passed": "no", "worst": {}, "rules": {}, "n_steps": 1.5}.items():
        assert errors("summary", summary | {key: value}), key
