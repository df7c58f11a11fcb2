"""What is hot stays hot: kernels count the work that the table beside this file says, neither more nor less.

A clock says something else on each machine; these numbers are the same on all. A commit that changes the work on
purpose writes the table anew: `python -m tests.simulate.measure.test_counted_work`.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import clearance as cl

SCENES = Path(__file__).parents[3] / "scenes"
NAMES = sorted(path.parent.name for path in SCENES.glob("*/case.yaml"))
TABLE = Path(__file__).with_name("counted_work.json")


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


def checked(name: str) -> cl.Run:
    """A scene's certified run."""
    one_thread = cl.Resources(jobs=1)
    return cl.check(SCENES / name / "case.yaml", resources=one_thread, contact="none")


def counters_of(run: cl.Run) -> dict[str, dict[str, int]]:
    """What the kernels counted: at the steps, and for the proofs of all rules."""
    proofs = [rule.certificate.tally for rule in run.record.rules]
    counters = sorted({counter for tally in proofs for counter in tally})
    proven = {name: sum(tally.get(name, 0) for tally in proofs) for name in counters}
    return {"steps": dict(run.record.tally), "proof": proven}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_kernels_count_what_the_table_says_of_a_scene_whose_verdict_is_the_one_promised(
    name: str,
) -> None:
    run = checked(name)
    assert counters_of(run) == json.loads(TABLE.read_text(encoding="utf-8"))[name]
    statuses = set(run.steps["status"].to_pylist())
    assert statuses == VERDICTS.get(name, statuses)
    assert run.passed == (not statuses & {"violated", "contact"})


if __name__ == "__main__":
    counted = {name: counters_of(checked(name)) for name in NAMES}
    TABLE.write_text(json.dumps(counted, indent=1) + "\n", encoding="utf-8")
