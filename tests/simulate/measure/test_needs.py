"""What is asked for changes the work, not the answer: all needs agree, and each does less than more would."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.simulate.measure import resources
from tests.made_cases import arm, at, spindle, torus
from tests.profiles.moving import slab, sliding

SCENES = Path(__file__).parents[3] / "scenes"


@pytest.fixture(scope="module")
def runs() -> dict[str, cl.Run]:
    case = cl.load_case(SCENES / "box_pipe" / "case.yaml")
    return {
        need: cl.check(case, need=need, certify=False)
        for need in ("steps", "pairs", "limit", "minimum")
    }


def test_pairs_have_the_same_steps_and_their_least_is_the_step(runs: dict[str, cl.Run]) -> None:
    steps, pairs = runs["steps"].steps, runs["pairs"].steps
    assert steps.equals(pairs)
    every = runs["pairs"].pairs
    matrix = every["clearance"].to_numpy().reshape(steps.num_rows, -1)
    assert (matrix.min(axis=1) == steps["clearance"].to_numpy()).all()


def test_pair_minima_are_the_least_of_the_matrix(runs: dict[str, cl.Run]) -> None:
    lazy, known = runs["steps"].pair_minima, runs["pairs"].pair_minima
    numbers = (1, 2, 5, 20, 60, 1000)
    first = [lazy[:most] for most in numbers]  # before all are known: only these are measured
    assert list(lazy) == list(known)
    assert first == [known[:most] for most in numbers]
    every = runs["pairs"].pairs.to_pydict()
    least: dict[tuple[str, str], float] = {}
    for link, obstacle, clearance in zip(
        every["link"], every["obstacle"], every["clearance"], strict=True
    ):
        least[link, obstacle] = min(clearance, least.get((link, obstacle), np.inf))
    assert {(m.link, m.obstacle): m.clearance for m in lazy} == least


def test_less_asked_is_less_done(runs: dict[str, cl.Run]) -> None:
    tests = {need: run.record.tally["polygon_tests"] for need, run in runs.items()}
    assert tests["limit"] < tests["steps"] <= tests["pairs"]
    queries = {need: run.record.tally["queries"] for need, run in runs.items()}
    assert queries["minimum"] < queries["steps"] <= queries["pairs"]


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_a_pair_of_which_nothing_has_moved_is_not_asked_again(
    need: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last link of three moves all the time, the others from step 20 to 29 only."""
    swing = 0.4 * np.sin(0.1 * np.arange(60.0))
    positions = np.stack([np.where(np.arange(60) < 20, 0.0, swing)] * 2 + [swing], axis=1)
    positions[30:, :2] = positions[29, :2]
    shapes = [spindle(0.05, 0.1, 6)] * 3
    near, far = (
        (torus(0.12, 0.05, 12, 6), at(0.3, 0.25, 0.2)),
        (spindle(0.1, 0.2, 6), at(0.5, -0.4, 0.3)),
    )
    case = arm("resting", shapes, [near, far], positions)
    run = cl.check(case, need=need, certify=False)
    tally = run.record.tally
    assert tally["queries"] + tally["pairs_skipped"] == 60 * 6
    assert tally["queries"] <= 60 * 2 + 11 * 4
    assert need == "steps" or tally["queries"] == 60 * 2 + 11 * 4
    monkeypatch.setattr(resources, "LONGEST_PART", 1)  # nothing is carried from step to step
    afresh = cl.check(case, need=need, certify=False)
    assert afresh.steps.equals(run.steps)
    assert list(afresh.pair_minima) == list(run.pair_minima)
    assert need == "steps" or afresh.pairs.equals(run.pairs)


def test_needs_that_do_not_go_together_are_refused() -> None:
    case = cl.load_case(SCENES / "box_box" / "case.yaml")
    for asked, told in [
        ({"need": "all"}, "need: 'all' is given; one of steps, pairs"),
        ({"need": "limit", "cross_check": True}, "cross-check needs every step"),
        ({"need": "pairs", "method": "paper"}, "method 'paper' measures every step"),
    ]:
        with pytest.raises(BadInput, match=told):
            cl.answer(cl.Question(case, **asked))
    with pytest.raises(BadInput, match="0 jobs"):
        cl.Resources(jobs=0)


@pytest.mark.parametrize("limits", [cl.Limits(), cl.Limits(fail=0.001, warn=0.15)])
def test_steps_that_are_not_measured_behind_a_contact_have_no_status(limits: cl.Limits) -> None:
    """The slab touches the post at one step, and is asked about no further."""
    post = cl.Obstacle(cl.Body("post", slab([0.6, -0.05, 0.0], [0.7, 0.05, 0.1])))
    way = sliding(slab([0.0, -0.05, 0.0], [0.1, 0.05, 0.1]), [0.0, 0.3, 0.5, 0.3, 0.1, 0.0])
    case = replace(way, obstacles=(post,), limits=limits)
    run = cl.check(case, need="minimum")
    told = {row["step"]: row["status"] for row in run.steps.to_pylist()}
    true = {row["step"]: row["status"] for row in cl.check(case).steps.to_pylist()}
    assert told[2] == true[2] == "contact"
    assert all(told[step] in (None, true[step]) for step in true)
    assert [told[step] for step in (3, 4, 5)] == [None] * 3
    assert run.summary["status_counts"]["contact"] == 1
