"""Receipts of whole runs: proven again, and nothing that is changed goes unseen."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadSyntax, MissingFile
from clearance.receipt import fronts
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.items import CUT_TIME
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.proof.proving import failure_in
from clearance.receipt.receipt_file import FILE_NAME, read_receipt
from clearance.report.withdrawn import withdraw_report
from tests.receipt.receipts import (
    Said,
    everything_moves,
    evidence_for,
    rewritten,
    saved,
    turning_arm,
)

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    saved(turning_arm(), folder)
    return folder


def verified(folder, case=None):
    return cl.verify(folder, case or turning_arm())


@pytest.mark.slow
def test_the_bound_of_a_run_is_proven_again(folder):
    found = verified(folder)
    told = json.loads((folder / "summary.json").read_text())["certified"]["lower_bound"]
    assert found.proven and found.headline.startswith("PROVEN: at least")
    assert told - 3 * UNIT < found.bounds["default"] <= told
    assert (found.n_pairs, found.n_intervals, found.n_claimed) == (2, 4, 4)


@pytest.mark.slow
def test_the_headline_says_what_the_verdict_does_not_cover(tmp_path):
    case = turning_arm()
    placed = case.robots[0]
    late = replace(placed.trajectory, times=placed.trajectory.times + 0.5, has_way_in=True)
    case = replace(case, robots=(replace(placed, trajectory=late),))
    saved(case, tmp_path)
    told = (
        "; verdict clear; self-collision not checked [CL531]; warning: not measured: how robot 'arm' comes to its "
        "first point at 0.5 s; "
    )
    assert told in cl.verify(tmp_path, case).headline


@pytest.mark.slow
def test_cubics_mounts_tables_and_parts_in_hands_are_covered(tmp_path):
    saved(everything_moves(0), tmp_path)
    assert cl.verify(tmp_path, everything_moves(0)).proven


@pytest.mark.slow
def test_the_same_run_gives_the_same_bytes(folder, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    saved(turning_arm(), other)
    assert (other / FILE_NAME).read_bytes() == (folder / FILE_NAME).read_bytes()


@pytest.mark.slow
def test_no_raised_bound_is_proven(folder):
    claims = read_receipt(folder / FILE_NAME).claims
    for interval in range(claims.shape[1]):
        raised = claims.copy()
        raised[0, interval] += round(2e-4 / UNIT)  # beyond the gap of the certificate
        rewritten(folder, claims=raised)
        found = verified(folder)
        assert not found.proven and f"interval {interval} " in found.headline


def test_a_receipt_of_less_than_the_report_tells_of_proves_no_report(folder):
    receipt = read_receipt(folder / FILE_NAME)
    rewritten(folder, claims=receipt.claims - 100)
    assert "the report certifies up to 0.00009" in verified(folder).failure


def test_no_item_can_be_left_out(folder):
    receipt = read_receipt(folder / FILE_NAME)
    for i in np.random.default_rng(0).integers(0, len(receipt.deeds), 12):
        rewritten(folder, deeds=np.delete(receipt.deeds, i))
        assert not verified(folder).proven


def test_no_claim_can_be_left_out_and_no_interval(folder):
    receipt = read_receipt(folder / FILE_NAME)
    claims = receipt.claims.copy()
    claims[0, 2] = NOT_CLAIMED
    rewritten(folder, claims=claims)
    assert "nothing is claimed" in verified(folder).failure
    rewritten(folder, claims=receipt.claims[:, :-1])
    with pytest.raises(BadSyntax, match="damaged"):
        verified(folder)


def test_evidence_that_goes_on_is_not_of_this_case(folder):
    receipt = read_receipt(folder / FILE_NAME)
    rewritten(folder, deeds=np.append(receipt.deeds, CUT_TIME))
    assert "left over" in verified(folder).failure


def test_random_directions_and_deeds_prove_nothing_false(folder):
    receipt, rng = read_receipt(folder / FILE_NAME), np.random.default_rng(0)
    raised = receipt.claims + round(1e-3 / UNIT)
    for _ in range(5):
        deeds = rng.integers(0, 8, len(receipt.deeds))
        codes = {m: rng.integers(-m - 1, m + 2, (200, 2)) for m in receipt.codes}
        rewritten(folder, claims=raised, deeds=deeds, codes=codes)
        assert not verified(folder).proven


@pytest.mark.parametrize(
    "other",
    [
        turning_arm(turn=1.1),
        turning_arm(far=0.91),
        turning_arm(n_steps=6),
        replace(turning_arm(), allow=(("bar", "plate"),)),
        replace(turning_arm(), obstacles=turning_arm().obstacles[:1]),
        replace(turning_arm(), limits=cl.Limits(rules=(cl.Rule(("bar", "plate")),))),
    ],
)
def test_a_receipt_is_of_its_own_case_only(folder, other):
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(folder, other)


NEEDED = "summary.json", "steps.csv", "findings.json", "report.html"


@pytest.mark.parametrize("name", [*NEEDED, "steps.parquet", "worst_moments.yaml"])
def test_a_report_that_was_changed_is_found(folder, name):
    path = folder / name
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(BadSyntax, match=f"{name}: it is not as it was"):
        verified(folder)
    path.unlink()
    if name in NEEDED:
        with pytest.raises(MissingFile, match=name):
            verified(folder)


def test_a_report_that_a_later_run_has_withdrawn_is_told(folder):
    withdraw_report(folder)
    with pytest.raises(MissingFile, match="later run into this folder has not come to its end"):
        verified(folder)


@pytest.mark.slow
def test_intervals_in_which_bodies_touch_are_told(tmp_path):
    case = turning_arm(far=0.8)
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven and found.n_contact == 2
    assert found.headline.startswith(
        "CONTACT, as the report says. PROVEN EXCEPT in 2 intervals, in which bodies may touch: at least"
    )


@pytest.mark.slow
def test_a_body_inside_another_is_not_proven_apart(tmp_path, monkeypatch):
    case = turning_arm()
    inside = cl.Obstacle(cl.Body("hall", cl.box((9.0, 9.0, 9.0))))
    saved(replace(case, obstacles=case.obstacles[1:]), tmp_path)
    held = replace(case, obstacles=(inside,))
    with pytest.raises(BadInput):
        cl.verify(tmp_path, held)
    data = case_data(held)
    halves, claims = halves_of(data.shapes), np.full((1, data.n_intervals), round(0.1 / UNIT))
    with pytest.raises(BadInput, match="not proven outside each other"):
        evidence_for(data.stretches, data.shapes, halves, claims)
    monkeypatch.setattr(fronts, "one_inside", lambda stage: None)  # who forges it does not ask
    forged = Said(evidence_for(data.stretches, data.shapes, halves, claims))
    found = failure_in(data.stretches, data.shapes, halves, claims, forged)
    assert found is not None and found.reason == "not proven outside each other"


@pytest.mark.slow
def test_a_sampled_receipt_is_called_one(tmp_path):
    case = turning_arm(n_steps=80)
    saved(case, tmp_path, kind="sampled")
    found = cl.verify(tmp_path, case)
    assert found.proven and found.kind == "sampled"
    assert 1 < found.n_claimed < 20 and found.headline.startswith("SAMPLED: PROVEN")
    receipt = read_receipt(tmp_path / FILE_NAME)
    rewritten(tmp_path, head=receipt.head | {"kind": "full"})
    assert "nothing is claimed" in cl.verify(tmp_path, case).failure
    claimed = np.flatnonzero(receipt.claims[0] != NOT_CLAIMED)
    claims = receipt.claims.copy()
    claims[0, claimed] = NOT_CLAIMED
    rewritten(tmp_path, claims=claims)
    assert "nothing is claimed" in cl.verify(tmp_path, case).failure


def test_runs_without_a_proof_have_no_receipt(tmp_path):
    run = cl.check(turning_arm(), certify=False)
    run.save(tmp_path)
    with pytest.raises(BadInput, match="not certified"):
        cl.write_receipt(run, tmp_path)
    untied = replace(turning_arm(), clock=cl.Clock(0.5))
    with pytest.raises(BadInput, match="clocks"):
        cl.write_receipt(cl.check(untied), tmp_path)


def test_a_newer_report_takes_the_receipt_of_the_older_one_away(folder):
    cl.check(turning_arm()).save(folder)
    with pytest.raises(MissingFile):
        verified(folder)


@pytest.mark.slow
def test_padding_and_rules_are_part_of_what_is_proven(tmp_path):
    case = turning_arm()
    padded = tuple(replace(one, padding=0.005) for one in case.obstacles)
    rules = (cl.Rule(("bar", "plate"), name="near", fail=0.1),)
    case = replace(case, obstacles=padded, limits=cl.Limits(0.01, 0.02, rules=rules))
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven and set(found.bounds) == {"default", "near"}
    assert found.bounds["near"] == pytest.approx(0.195, abs=2e-4)


@pytest.mark.slow
def test_clouds_are_balls(tmp_path):
    case = turning_arm()
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.05, 0.05, (40, 3)) + [0.9, 0.0, 0.0]
    cloud = cl.Obstacle(cl.Body("scan", cl.PointCloud(points, 0.01)))
    case = replace(case, obstacles=(cloud, case.obstacles[1]))
    saved(case, tmp_path)
    assert cl.verify(tmp_path, case).proven


PROVES = """
import sys
import clearance.receipt.proof.proving, clearance.receipt.proof.items
rooms = ("kernels", "compile", "query", "simulate", "world")
barred = {"numba", *("clearance." + room for room in rooms)}
print(*sorted(barred & {".".join(name.split(".")[:2]) for name in sys.modules}))
"""


@pytest.mark.cold
def test_the_proof_brings_nothing_that_measures():
    done = subprocess.run([sys.executable, "-c", PROVES], capture_output=True, text=True, cwd=ROOT)
    assert (done.returncode, done.stdout.strip()) == (0, ""), done.stderr


def test_a_search_is_no_input_file(folder):
    found = verified(folder)
    file, search = ("meshes/a.obj", "0" * 64), ("(lookup) mesh package://meshes/a.obj", "1" * 64)
    found = replace(found, inputs=(search, file))
    assert found.files == (file,) and "; 1 input of" in found.headline
