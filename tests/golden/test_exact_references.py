"""Whole cases against exact references that lie here, so that a clone with nothing beside it has a truth to test.

`make_references` makes them, with rational arithmetic throughout. The engine may be off by its rounding alone:
sixteen roundings of the scene's size a joint, for where the link is, and as many for the distance.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import clearance as cl

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
REFERENCES = sorted((HERE / "references").glob("*.json"))
ROUNDING = 2.0**-53


@pytest.fixture(scope="module", params=REFERENCES, ids=lambda path: path.stem)
def run_and_reference(request):
    reference = json.loads(request.param.read_text(encoding="utf-8"))
    return cl.check(cl.load_case(ROOT / reference["case"]), certify=False), reference["steps"]


def rounding_of(case: cl.Case) -> float:
    """[m] What the engine's clearance may be off by."""
    corners = [np.abs(one.world_from_body @ _ends(one.body.shape)).max() for one in case.obstacles]
    (placed,) = case.robots
    lengths = [np.abs(_ends(body.shape)).max() for body in placed.robot.bodies]
    lengths += [np.abs(joint.parent_from_joint[:3, 3]).max() for joint in placed.robot.joints]
    return 16 * (len(placed.robot.joints) + 1) * ROUNDING * max(*corners, sum(lengths))


def _ends(shape: cl.Polyhedron) -> np.ndarray:
    """(4, 2) the two ends of a shape's box, as homogeneous columns."""
    return np.vstack([np.asarray(shape.bounds).reshape(2, 3).T, np.ones(2)])


def test_the_clearance_is_the_exact_one(run_and_reference):
    run, reference = run_and_reference
    rounding = rounding_of(run.record.case)
    assert rounding < 1e-13
    for truth in reference:
        found = run.steps.slice(truth["step"], 1).to_pylist()[0]
        exact = Fraction(truth["clearance"])
        assert abs(Fraction(found["clearance"]) - exact) <= rounding, (truth, found["clearance"])
        assert (found["status"] == "contact") == (exact == 0)


def test_the_nearest_pair_is_one_of_the_exact_ones(run_and_reference):
    run, reference = run_and_reference
    for truth in reference:
        if Fraction(truth["clearance"]) > 0:  # of pairs in contact the reference has one
            found = run.steps.slice(truth["step"], 1).to_pylist()[0]
            assert [found["link"], found["obstacle"]] in truth["pairs"]


def test_there_are_references_of_scenes_and_of_robots_from_packages():
    cases = {
        json.loads(path.read_text(encoding="utf-8"))["case"].split("/")[0] for path in REFERENCES
    }
    assert cases == {"scenes", "tests"}
