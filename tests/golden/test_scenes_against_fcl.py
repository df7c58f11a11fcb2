"""Every scene of ours, held against FCL to 1e-9 m: at every step, of the longest two at every fourth."""

from dataclasses import replace
from pathlib import Path

import pytest

import clearance as cl

pytestmark = pytest.mark.peer

SCENES = Path(__file__).parents[2] / "scenes"
VERDICTS = {  # the statuses that occur, as scenes/README.md promises
    "box_box": {"clear"},
    "box_pipe": {"clear", "near", "violated"},
    "hot_cell": {"clear", "near"},
    "iiwa_pipe_rack": {"clear", "near"},
    "panda_shelf": {"clear", "near", "contact"},
    "dual_arm_handover": {"clear"},
    "turntable_cell": {"clear", "near"},
    "door_and_arm": {"clear", "near"},
    "welding_cell": {"clear", "near"},
    "palletising_cell": {"clear", "near"},
}


LONGEST = {"palletising_cell", "welding_cell"}


@pytest.fixture(scope="module", params=sorted(VERDICTS))
def run(request):
    case = cl.load_case(SCENES / request.param / "case.yaml")
    return cl.check(case, cross_check=request.param not in LONGEST)


def thinned(case: cl.Case, n: int) -> cl.Case:
    """The case with every n-th sample of its robots."""
    robots = []
    for placed in case.robots:
        asked = placed.trajectory
        rows = cl.Trajectory(asked.times[::n], asked.joint_names, asked.positions[::n])
        robots.append(replace(placed, trajectory=rows))
    return replace(case, robots=tuple(robots))


@pytest.mark.slow
def test_fcl_agrees(run):
    if run.cross_check is None:
        run = cl.check(thinned(run.record.case, 4), cross_check=True, certify=False)
    assert run.steps.num_rows >= 200
    assert run.cross_check.n_steps == run.steps.num_rows
    assert run.cross_check.disagreements == ()
    assert run.cross_check.greatest_difference <= 1e-9
    assert run.cross_check.worst_witness_error <= 1e-9


@pytest.mark.slow
def test_the_verdict_is_the_one_promised(run):
    statuses = set(run.steps["status"].to_pylist())
    assert statuses == VERDICTS[run.record.case.name]
    assert run.passed == (not statuses & {"violated", "contact"})
