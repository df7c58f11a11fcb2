"""Whole cases against exact references: those that lie here, so that a clone with nothing beside it has a truth to
test, and the four real cases beside the repository.

`make_references` makes the first, with rational arithmetic throughout. The engine may be off by rounding alone:
the README says by less than 1e-15 m.
"""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from tests.examples import some_slow
from tests.golden.make_references import without_rules
from tests.shared_cases import SHARED_NAMES, shared_case

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


@pytest.mark.slow
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


@pytest.mark.slow
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


ROUNDING = 1e-12  # [m] a faceted round shape may never be reported farther away than this


@pytest.fixture(scope="module", params=SHARED_NAMES)
def shared_run(request):
    path = shared_case(request.param)
    run = cl.check(cl.load_case(path))
    with path.with_name("reference.csv").open(encoding="utf-8") as file:
        return run, list(csv.DictReader(file))


def excess_of(run, name):
    bodies = [o.body for o in run.record.case.obstacles] + list(
        run.record.case.robots[0].robot.bodies
    )
    return next(body.shape.excess for body in bodies if body.name == name)


@pytest.mark.shared
def test_every_step_has_its_reference_clearance(shared_run):
    run, reference = shared_run
    rows = run.steps.to_pylist()
    assert len(rows) == len(reference)
    for row, truth in zip(rows, reference, strict=True):
        exact = float(truth["clearance"])
        facets = max(
            excess_of(run, row["link"]) + excess_of(run, row["obstacle"]),
            excess_of(run, truth["link"]) + excess_of(run, truth["obstacle"]),
        )
        if facets == 0.0:
            assert abs(row["clearance"] - exact) <= 1e-9, (row["step"], exact)
        assert row["clearance"] <= exact + ROUNDING, (row["step"], exact)
        assert row["clearance"] >= exact - facets - ROUNDING, (row["step"], exact)


@pytest.mark.shared
def test_contact_steps_agree(shared_run):
    run, reference = shared_run
    ours = [row["status"] == "contact" for row in run.steps.to_pylist()]
    assert ours == [float(truth["clearance"]) == 0.0 for truth in reference]


@pytest.mark.shared
def test_witness_points_realise_the_clearance(shared_run):
    run, _ = shared_run
    columns = {
        name: run.steps[name].to_numpy() for name in run.steps.column_names if name[-2:-1] == "_"
    }
    links = np.stack([columns[f"link_{axis}"] for axis in "xyz"], axis=1)
    obstacles = np.stack([columns[f"obstacle_{axis}"] for axis in "xyz"], axis=1)
    realised = np.linalg.norm(links - obstacles, axis=1)
    assert np.abs(realised - run.record.clearances).max() < 1e-14


@pytest.mark.shared
def test_pair_minima_hold_the_least_of_all_steps(shared_run):
    run, _ = shared_run
    least = run.pair_minima[0]
    assert least.clearance == run.worst_sample["clearance"]
    assert least.step == run.worst_sample["step"]
    assert [p.clearance for p in run.pair_minima] == sorted(p.clearance for p in run.pair_minima)
