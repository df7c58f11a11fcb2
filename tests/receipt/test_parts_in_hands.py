"""Receipts of parts that are gripped by what is off: proven with the errors of that moment, and of now."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadSyntax
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.stage import by_balls, by_directions
from tests.budget.part_cases import carried, off_by, quarter_turn, slid
from tests.budget.sampled_machine import HandlingMachine
from tests.budget.test_budget_sound import handling
from tests.receipt.receipts import saved, stage_of
from tests.receipt.test_error_terms import distance, names_in, rows_of

ROUNDING = 1e-12
FAR = 100.0
LEAST = "default, with tolerances"
SAMPLES = 8


def in_the_world(stage) -> np.ndarray:
    """(pairs,) True where the pair is seen in the world."""
    joints, carriers = stage.stretch.joints, stage.stretch.carriers

    def root(link: int) -> int:
        while link >= 0 and joints.parents[link] >= 0:
            link = int(joints.parents[link])
        return link

    roots = np.array([root(int(link)) for link in carriers])[stage.stretch.pairs]
    return (roots[:, 0] != roots[:, 1]) | (roots < 0).any(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_no_error_of_any_moment_brings_parts_nearer_than_is_proven(seed):
    case, rng = handling(seed), np.random.default_rng(seed)
    data, machine, names = case_data(case), HandlingMachine(case), names_in(case)
    half = len(data.stretches) // 2
    for i in range(half, 2 * half):
        stage = stage_of(data, i, FAR)
        items, u = rows_of(stage, 0, rng)
        items = items._replace(start=np.full(len(u.T), stage.stretch.n_intervals - 1))
        world = in_the_world(stage)
        along = by_directions(stage, items, u) + FAR
        apart = by_balls(stage, items) + stage.stretch.padding + UNIT
        start, times = stage.stretch.times[0], stage.stretch.times[-2:]
        for _ in range(SAMPLES):
            errors = {
                moment: machine.random(rng) for moment in [*machine.moments(start), machine.NOW]
            }
            parts = machine.parts_at(start, errors)
            poses = machine.poses(float(rng.uniform(*times)), errors[machine.NOW], parts)
            for k, pair in enumerate(stage.stretch.pairs.tolist()):
                one, other = (names[body] for body in pair)
                assert apart[k] <= distance(machine, poses, one, other) + ROUNDING
                if world[k]:
                    a, b = (
                        machine.shapes[name].vertices @ (poses[name][:3, :3].T @ u[:, k])
                        + poses[name][:3, 3] @ u[:, k]
                        for name in (one, other)
                    )
                    least = b.min() - a.max()
                    assert along[k] <= least + ROUNDING


@pytest.mark.slow
def test_a_receipt_proves_what_the_errors_of_both_moments_leave(tmp_path):
    case = slid(off_by(0.004), carried("bar", 0.0))
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven
    assert 0.092 - 0.04 * 0.008 <= found.bounds[LEAST] <= 0.092


@pytest.mark.parametrize(("how", "taken"), [({}, 0.008), ({"exact_grasp": True}, 0.004)])
def test_along_a_slide_both_errors_are_taken_and_of_an_exact_grasp_one(how, taken):
    data = case_data(slid(off_by(0.004), carried("bar", 0.0, **how)))
    pairs = [{data.shapes[body].name for body in pair} for pair in data.stretches[0].pairs.tolist()]
    zero, one = np.zeros(1, dtype=np.int64), np.ones(1, dtype=np.int64)
    items = Items(zero + pairs.index({"part", "wall"}), zero, zero, zero, one, zero, zero)
    for u in np.array([[[1.0], [0.0], [0.0]], [[-1.0], [0.0], [0.0]]]):
        nominal, left = (by_directions(stage_of(data, i, FAR), items, u)[0] for i in (0, 1))
        assert nominal - left == pytest.approx(taken, abs=ROUNDING)


@pytest.mark.slow
def test_a_receipt_of_an_exact_grasp_is_not_one_of_another(tmp_path):
    saved(quarter_turn(0.1, 0.03, exact_grasp=True), tmp_path)
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(tmp_path, quarter_turn(0.1, 0.03))
