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
from tests.examples import some_slow
from tests.golden.make_references import without_rules

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
REFERENCES = sorted((HERE / "references").glob("*.json"))
MOST_ROUNDING = 1e-15
"""[m]"""


LONG = {"dual_arm_handover", "hot_cell", "iiwa_pipe_rack", "panda_table", "r2d2_gate"}


@pytest.fixture(
    scope="module",
    params=some_slow(REFERENCES, {path for path in REFERENCES if path.stem in LONG}),
    ids=lambda path: path.stem,
)
def run_and_reference(request):
    reference = json.loads(request.param.read_text(encoding="utf-8"))
    case = without_rules(cl.load_case(ROOT / reference["case"]))
    return cl.check(case, certify=False), reference


def test_the_clearance_is_the_exact_one(run_and_reference):
    run, reference = run_and_reference
    for truth in reference["steps"]:
        found = run.steps.slice(truth["step"], 1).to_pylist()[0]
        exact = Fraction(truth["clearance"])
        assert abs(Fraction(found["clearance"]) - exact) <= MOST_ROUNDING, (
            truth,
            found["clearance"],
        )
        assert (found["status"] == "contact") == (exact == 0)


def test_the_nearest_pair_is_one_of_the_exact_ones(run_and_reference):
    run, reference = run_and_reference
    for truth in reference["steps"]:
        if Fraction(truth["clearance"]) > 0:  # of pairs in contact the reference has one
            found = run.steps.slice(truth["step"], 1).to_pylist()[0]
            names = ("link", "obstacle") if "link" in found else ("body_a", "body_b")
            assert [found[name] for name in names] in truth["pairs"]


def test_pairs_of_what_moves_or_is_carried_are_exact_where_they_come_nearest(run_and_reference):
    run, reference = run_and_reference
    minima = {(least.link, least.obstacle): least for least in run.pair_minima}
    for truth in reference.get("parts", []):
        least = minima[tuple(truth["pair"])]
        off = abs(Fraction(least.clearance) - Fraction(truth["clearance"]))
        assert off <= MOST_ROUNDING, (truth, least)
