"""Every scene of ours, held against FCL to 1e-9 m: at every step, of the longest two at every fourth."""

from dataclasses import replace
from pathlib import Path

import pytest

import clearance as cl

pytestmark = pytest.mark.peer

SCENES = Path(__file__).parents[2] / "scenes"
LONGEST = {"palletising_cell", "welding_cell"}
NAMES = LONGEST | {
    "box_box", "box_pipe", "door_and_arm", "dual_arm_handover", "hot_cell", "iiwa_pipe_rack", "panda_shelf",
    "turntable_cell",
}  # fmt: skip


def thinned(case: cl.Case, n: int) -> cl.Case:
    """The case with every n-th sample of its robots."""
    robots = []
    for placed in case.robots:
        asked = placed.trajectory
        rows = cl.Trajectory(asked.times[::n], asked.joint_names, asked.positions[::n])
        robots.append(replace(placed, trajectory=rows))
    return replace(case, robots=tuple(robots))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(NAMES))
def test_fcl_agrees(name):
    case = cl.load_case(SCENES / name / "case.yaml")
    run = cl.check(thinned(case, 4) if name in LONGEST else case, cross_check=True, certify=False)
    assert run.steps.num_rows >= 200
    assert run.cross_check.n_steps == run.steps.num_rows
    assert run.cross_check.disagreements == ()
    assert run.cross_check.greatest_difference <= 1e-9
    assert run.cross_check.worst_witness_error <= 1e-9
