"""The same kernels with every index checked, and as plain Python: same answers, bit for bit."""

import json
import os
import subprocess
import sys
from pathlib import Path

import lane
import pytest

ROOT = Path(__file__).parents[2]


def run_lane(*asked, **settings):
    """What `lane.py` prints in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **settings}
    ran = subprocess.run(
        [sys.executable, str(ROOT / "tests" / "query" / "lane.py"), *asked],
        env=environment, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr[-2000:]
    return json.loads(ran.stdout)


def plain(answers):
    return json.loads(json.dumps(answers))


def test_with_every_index_checked():
    """A quarter of a minute: the compiler types the kernel, and all predicates below it."""
    found = run_lane("meetings", CLEARANCE_KERNELS="jit", NUMBA_BOUNDSCHECK="1")
    assert found["bounds"], "indices were not checked"
    assert found["compiles"], "the kernel was not compiled there"
    assert found["meetings"] == plain(lane.meetings(12))
    assert any(at[0] for at in found["meetings"])


def test_as_plain_python():
    found = run_lane("answers", "2", CLEARANCE_KERNELS="python")
    assert found["bounds"]  # numpy itself checks
    assert found["polygons"] == plain(lane.polygon_answers(2))


@pytest.fixture(scope="module")
def rules():
    return run_lane("rules", CLEARANCE_KERNELS="python")


def test_bodies_as_plain_python(rules):
    assert rules["all"] == plain(lane.body_answers(12))


def test_no_pruning_rule_changes_an_answer(rules):
    """Of several contacts the first that is met is told; rules that bound boxes change which one that is."""
    assert len(rules["without"]) == 5
    for name, answers in rules["without"].items():
        for without, reported in zip(answers, rules["all"], strict=True):
            assert without[-1] == reported[-1], name
            assert without == reported or (
                reported[-1] and without[0] == reported[0] and "boxes" in name
            ), name
