"""The four real cases beside the repository, every step against their exact reference clearances."""

import csv

import numpy as np
import pytest

import clearance as cl
from tests.shared_cases import SHARED_NAMES, shared_case

pytestmark = pytest.mark.shared

ROUNDING = 1e-12  # [m] a faceted round shape may never be reported farther away than this


@pytest.fixture(scope="module", params=SHARED_NAMES)
def run_and_reference(request):
    path = shared_case(request.param)
    run = cl.check(cl.load_case(path))
    with path.with_name("reference.csv").open(encoding="utf-8") as file:
        return run, list(csv.DictReader(file))


def excess_of(run, name):
    bodies = [o.body for o in run.record.case.obstacles] + list(
        run.record.case.robots[0].robot.bodies
    )
    return next(body.shape.excess for body in bodies if body.name == name)


def test_every_step_has_its_reference_clearance(run_and_reference):
    run, reference = run_and_reference
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


def test_contact_steps_agree(run_and_reference):
    run, reference = run_and_reference
    ours = [row["status"] == "contact" for row in run.steps.to_pylist()]
    assert ours == [float(truth["clearance"]) == 0.0 for truth in reference]


def test_witness_points_realise_the_clearance(run_and_reference):
    run, _ = run_and_reference
    columns = {
        name: run.steps[name].to_numpy() for name in run.steps.column_names if name[-2:-1] == "_"
    }
    links = np.stack([columns[f"link_{axis}"] for axis in "xyz"], axis=1)
    obstacles = np.stack([columns[f"obstacle_{axis}"] for axis in "xyz"], axis=1)
    realised = np.linalg.norm(links - obstacles, axis=1)
    assert np.abs(realised - run.record.clearances).max() < 1e-14


def test_pair_minima_hold_the_least_of_all_steps(run_and_reference):
    run, _ = run_and_reference
    least = run.pair_minima[0]
    assert least.clearance == run.worst_sample["clearance"]
    assert least.step == run.worst_sample["step"]
    assert [p.clearance for p in run.pair_minima] == sorted(p.clearance for p in run.pair_minima)
