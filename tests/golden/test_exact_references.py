"""Whole cases against exact references that lie here, so that a clone with nothing beside it has a truth to test.

`make_references` makes them, with rational arithmetic throughout. The engine may be off by rounding alone:
the README says by less than 1e-15 m.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

import clearance as cl

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
REFERENCES = sorted((HERE / "references").glob("*.json"))
MOST_ROUNDING = 1e-15
"""[m]"""


@pytest.fixture(scope="module", params=REFERENCES, ids=lambda path: path.stem)
def run_and_reference(request):
    reference = json.loads(request.param.read_text(encoding="utf-8"))
    return cl.check(cl.load_case(ROOT / reference["case"]), certify=False), reference["steps"]


def test_the_clearance_is_the_exact_one(run_and_reference):
    run, reference = run_and_reference
    for truth in reference:
        found = run.steps.slice(truth["step"], 1).to_pylist()[0]
        exact = Fraction(truth["clearance"])
        assert abs(Fraction(found["clearance"]) - exact) <= MOST_ROUNDING, (
            truth,
            found["clearance"],
        )
        assert (found["status"] == "contact") == (exact == 0)


def test_the_nearest_pair_is_one_of_the_exact_ones(run_and_reference):
    run, reference = run_and_reference
    for truth in reference:
        if Fraction(truth["clearance"]) > 0:  # of pairs in contact the reference has one
            found = run.steps.slice(truth["step"], 1).to_pylist()[0]
            assert [found["link"], found["obstacle"]] in truth["pairs"]


def test_there_are_references_of_scenes_and_of_robots_from_packages():
    cases = {
        json.loads(path.read_text(encoding="utf-8"))["case"].split("/")[0] for path in REFERENCES
    }
    assert cases == {"scenes", "tests"}
