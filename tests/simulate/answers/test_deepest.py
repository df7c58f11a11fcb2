"""Of bodies in contact the worst are those that are deepest in each other, not the first by name or time."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.rules import Rule
from tests.made_cases import at, flying


def block(name: str, pose: np.ndarray, **more) -> cl.Obstacle:
    return cl.Obstacle(cl.Body(name, cl.box((0.2, 0.2, 0.2))), pose, **more)


def passing(xs: list[float], *obstacles: cl.Obstacle) -> cl.Case:
    """A cube of 0.2 m that goes along x."""
    positions = np.zeros((len(xs), 6))
    positions[:, 0] = xs
    case = flying("passing", cl.box((0.2, 0.2, 0.2)), [], positions)
    return replace(case, obstacles=obstacles)


def told(run: cl.Run) -> tuple:
    worst = run.worst
    return worst["step"], worst["obstacle"], worst["penetration"]


@pytest.mark.parametrize(("depth", "worst"), [(0.03, (3, "b", 0.03)), (0.001, (1, "a", 0.005))])
def test_the_deepest_of_two_at_different_steps(depth, worst):
    """`a` comes first, by name and in time, 5 mm deep; then `b`."""
    xs = [0.0, 0.005, 0.0, -0.3 - depth, 0.0]
    run = cl.check(passing(xs, block("a", at(0.2)), block("b", at(-0.5))))
    assert told(run)[:2] == worst[:2]
    assert told(run)[2] == pytest.approx(worst[2], abs=1e-12)
    assert (run.worst["clearance"], run.worst["status"], run.status) == (0.0, "contact", "contact")
    deepest = run.record.worst.depth
    assert deepest.exact and deepest.at_least == pytest.approx(worst[2], abs=1e-12)


def test_the_deepest_of_two_at_one_step():
    """Both are hit at once: the table names the first, the verdict the deeper."""
    case = passing([0.0, 0.01], block("a", at(0.2, 0.15)), block("b", at(-0.17, -0.15)))
    run = cl.check(case)
    assert told(run)[:2] == (0, "b")
    assert told(run)[2] == pytest.approx(0.03, abs=1e-12)
    assert run.record.worst is run.record.worst_sample is run.record.nearest
    (reason, *_) = run.verdict.reasons
    assert reason.startswith("contact 30.00 mm deep: l6 - b at 0.000 s, step 0")


def test_without_depth_the_first_is_named_and_said_to_have_none():
    case = passing([0.0, 0.01], block("a", at(0.2, 0.15)), block("b", at(-0.17, -0.15)))
    run = cl.answer(cl.Question(case, contact="none"))
    assert run.worst["obstacle"] in ("a", "b") and run.worst["penetration"] is None
    assert "depth not computed" in run.verdict.reasons[0]


def test_each_rule_has_its_own_deepest():
    case = passing([0.0, 0.01, 0.02], block("a", at(0.2, 0.15)), block("b", at(-0.17, -0.15)))
    limits = replace(case.limits, rules=(Rule(("l6", "a"), fail=0.001, warn=0.002, name="of a"),))
    run = cl.check(replace(case, limits=limits))
    record = run.record
    assert (record.worst.obstacle, record.worst.rule) == ("b", "default")
    own = run.session.worst_among([record.rule("of a")])
    assert (own.obstacle, own.step) == ("a", 2)
    assert own.depth.penetration == pytest.approx(0.02, abs=1e-12)


def test_a_waived_contact_does_not_hide_the_deepest_that_decides():
    case = passing([0.0, 0.01, 0.02], block("a", at(0.2, 0.15)), block("b", at(-0.17, -0.15)))
    session = cl.check(case).session
    some = session.of_pairs(lambda rule, one, other: "a" in other)
    assert session.worst_among(some).obstacle == "a"
    assert session.worst_among(some).depth.penetration == pytest.approx(0.02, abs=1e-12)


def test_a_cloud_has_no_depth_and_a_body_that_has_is_worse():
    cloud = cl.Obstacle(cl.Body("a scan", cl.PointCloud([[0.0, 0.0, 0.0]], 0.01)))
    alone = cl.check(passing([0.0, 0.01], cloud))
    assert alone.worst["obstacle"] == "a scan" and alone.worst["penetration"] is None
    both = cl.check(passing([0.0, 0.01], cloud, block("b", at(0.2))))
    assert told(both)[:2] == (1, "b")
