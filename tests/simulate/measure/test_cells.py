"""Whole runs of cells in which everything moves, and of clouds of points.

Steps, proofs between them and FCL, against single questions and arithmetic on every point.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadShape, NothingToMeasure
from clearance.profiles.sweep import swept_profile
from clearance.simulate.measure.sections import section_plan
from clearance.world.case import Clock, Limits
from clearance.world.motion import kinematic_motion
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests import cells
from tests.cells import cell, pose_at
from tests.examples import first_fast
from tests.made_cases import at, flying


def questions(run):
    """Of each phase: its first and last time, and of each pair the names, shapes, rule and padding."""
    case = run.record.case
    found = {}
    for section in section_plan(run.record.timeline).sections:
        rows = found.setdefault(section.phase.span, [])
        for pair in section.pairs:
            names = pair.a.name_in(case), pair.b.name_in(case)
            shapes = pair.a.shape_in(case), pair.b.shape_in(case)
            rows.append((names, shapes, case.limits.rule_names[section.rule], section.padding))
    return found


def least_at(case, rows, t, *, left=False):
    """By rule: the least clearance [m] at a time and the names of its pair."""
    poses = {name: pose_at(case, name, t, left=left) for names, *_ in rows for name in names}
    best = {}
    for names, (a, b), rule, padding in rows:
        near = cl.distance(a, b, pose_a=poses[names[0]], pose_b=poses[names[1]]).distance - padding
        if rule not in best or near < best[rule][0]:
            best[rule] = near, names
    return best


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 2, 4, 6])
def test_every_step_and_the_motion_between(seed):
    case = cell(seed, apart=2.0)
    run = cl.check(case)
    times = run.steps["time"].to_numpy()
    told, lower = run.steps["clearance"].to_numpy(), run.certificate.lower_bound
    for (start, end), rows in questions(run).items():
        first, last = np.searchsorted(times, [start, end])
        for k in range(first, last):
            true, _ = least_at(case, rows, float(times[k]))["default"]
            assert told[k] <= true + 1e-9
            if k > first:
                assert told[k] == pytest.approx(true, abs=1e-9)
            for share in np.linspace(0.0, 1.0, 6)[:-1]:
                t = float(times[k] + share * (times[k + 1] - times[k]))
                true, _ = least_at(case, rows, t)["default"]
                assert lower[k] <= true + 1e-9
            assert (
                lower[k]
                <= least_at(case, rows, float(times[k + 1]), left=True)["default"][0] + 1e-9
            )
    worst = run.record.worst
    assert run.certificate.lower_bound.min() >= worst.clearance - 1.001e-4


@pytest.mark.peer
@pytest.mark.parametrize("seed", range(3))
def test_fcl_agrees_at_every_step(seed):
    run = cl.check(cell(seed, apart=2.0), cross_check=True, certify=False)
    assert run.cross_check.agrees
    assert run.cross_check.n_steps >= run.steps.num_rows


def ruled(seed):
    """The same with rules, one of a window and one while a part is carried, and with padding."""
    case = cell(seed, apart=1.0)
    padded = replace(case.robots[0], padding={"tool": 0.003})
    rules = (
        Rule(("left/*", "*"), name="left", fail=0.02, warn=0.3),
        Rule(("left/*", "post"), Window(2.0, 3.0), name="at the post", fail=0.001, warn=0.002),
        Rule(("part", "*"), while_carried="part", name="carried", fail=0.1, warn=0.2),
    )
    return replace(case, robots=(padded, *case.robots[1:]), limits=Limits(0.01, 0.05, rules=rules))


@pytest.mark.parametrize("seed", first_fast(range(3), 1))
def test_each_rule_has_its_own_least(seed):
    case = ruled(seed)
    run = cl.check(case, certify=False)
    times, steps = run.steps["time"].to_numpy(), run.steps.to_pylist()
    limits = dict(zip(case.limits.rule_names, map(case.limits.of_rule, range(4)), strict=True))
    for (start, end), rows in questions(run).items():
        first, last = np.searchsorted(times, [start, end])
        for k in range(first + 1, last):
            best = least_at(case, rows, float(times[k]))
            for rule in run.record.rules:
                own = rule.measurement.clearance[k]
                assert np.isnan(own) == (rule.name not in best)
                if rule.name in best:
                    assert own == pytest.approx(best[rule.name][0], abs=1e-9)
            standing = {
                name: (standing_of(near, limits[name]), near - limits[name].fail)
                for name, (near, _) in best.items()
            }
            worst = max(code for code, _ in standing.values())
            margin = min(own for code, own in standing.values() if code == worst)
            code, own = standing[steps[k]["rule"]]
            assert code == worst and own == pytest.approx(margin, abs=1e-9)
            nearest = min(near for near, _ in best.values())
            assert steps[k]["nearest_clearance"] == pytest.approx(nearest, abs=1e-9)


def standing_of(near, limits):
    """How a clearance stands: 0 clear to 3 contact."""
    if near <= -0.003:  # the only padding there is
        return 3
    if near < limits.fail or near <= 0.0:
        return 2
    return int(near < limits.warn)


@pytest.mark.parametrize("need", first_fast(["limit", "minimum"], 1))
def test_other_needs_know_the_same_worst(need):
    case = ruled(0)
    whole, run = cl.check(case), cl.check(case, need=need)
    assert run.record.worst.clearance == pytest.approx(whole.record.worst.clearance, abs=1e-4)
    assert run.status == whole.status
    for rule in whole.record.rules:
        found = run.record.rule(rule.name)
        assert found.worst_sample.clearance == pytest.approx(rule.worst_sample.clearance, abs=1e-9)


def answered(case, **asked):
    return cl.answer(cl.Question(case, certify=False, **asked)).record


def variants(case):
    rule = Rule(("left/*", "door"), Window(1.0, 4.0), name="at the door", fail=0.02)
    padded = tuple(replace(o, padding=0.01) if o.name == "post" else o for o in case.obstacles)
    return {
        "phases": case,
        "rules": replace(case, limits=Limits(0.01, 0.05, rules=(rule,))),
        "padding": replace(case, obstacles=padded),
    }


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["phases", "rules", "padding"])
@pytest.mark.parametrize("seed", [0])
def test_it_says_what_the_exact_method_says_where_it_is_right(seed, kind):
    case = variants(cells.cell(seed))[kind]
    exact, paper = answered(case), answered(case, method="paper")
    apart = exact.steps["clearance"].to_numpy() > 0.02
    assert apart.sum() > 10
    for column in ("clearance", *exact.sides[:2]):
        found, wanted = (record.steps[column].to_numpy()[apart] for record in (paper, exact))
        same = (
            found == pytest.approx(wanted, abs=1e-12) if column == "clearance" else found == wanted
        )
        assert np.all(same)
    assert [rule.name for rule in paper.rules] == [rule.name for rule in exact.rules]


def test_a_step_of_which_it_says_nothing_is_named_as_the_run_counts_it():
    case = cells.cell(0)
    with pytest.raises(
        NothingToMeasure, match=r"method 'paper' says nothing of step \d+: its rules"
    ) as caught:
        answered(case, method="paper", paper_tolerance=0.056)
    step = int(str(caught.value).split("step ")[1].split(":")[0])
    assert answered(case).steps["clearance"].to_numpy()[step] > 0.056
    assert "a tolerance above 0.056 m may do" in str(caught.value)


def test_clocks_that_are_not_tied_are_refused():
    case = replace(cells.cell(0), clock=Clock(np.inf), carries=())
    with pytest.raises(BadInput, match="method 'paper' asks about one time"):
        cl.Question(case, method="paper")


HALF = np.array([0.15, 0.1, 0.05])
RADIUS = 0.02


def way(n_steps: int, reach: float = 1.0) -> np.ndarray:
    """(n, 6) a box goes past the points, turning."""
    share = np.linspace(0.0, 1.0, n_steps)[:, None]
    return share * [2.0 * reach, 0.1, 0.05, 1.0, 0.7, 2.0] - [reach, 0.0, 0.0, 0.0, 0.0, 0.0]


def scan(n: int = 4000, gap: float = 0.25) -> np.ndarray:
    """(n, 3) a wavy wall beside the way, and a few points that none is near."""
    u, v = np.random.default_rng(4).uniform(-1.0, 1.0, (2, n))
    wall = np.stack([u, gap + 0.05 * np.sin(9.0 * u) * np.cos(7.0 * v), v], axis=1)
    return np.concatenate([wall, [[0.0, 0.0, 3.0], [0.0, 0.0, -3.0]]])


def case_of(points: np.ndarray, positions: np.ndarray, **more) -> cl.Case:
    case = flying("scanned", cl.box(2.0 * HALF), [], positions)
    obstacle = cl.Obstacle(cl.Body("scan", cl.PointCloud(points, RADIUS)), **more)
    return replace(case, obstacles=(*case.obstacles, obstacle))


def true_clearances(case: cl.Case, points: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """(n,) [m] of the box to the balls, 0 where a ball is in it."""
    links = np.array([case.robots[0].robot.link_names.index("l6")])
    motion = case.with_trajectory(np.arange(len(positions)) * 0.01, positions)
    poses = kinematic_motion(motion.robots[0]).poses()[:, links[0]]
    found = []
    for pose in poses:
        seen = (points - pose[:3, 3]) @ pose[:3, :3]
        away = np.linalg.norm(np.maximum(np.abs(seen) - HALF, 0.0), axis=1)
        found.append(max(0.0, away.min() - RADIUS))
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.4, 0.2, 0.0])
def test_every_step_and_what_is_proven_between(gap):
    points, positions = scan(gap=gap), way(41)
    case = case_of(points, positions)
    run = cl.check(case)
    found = run.record.steps["clearance"].to_numpy()
    assert np.abs(found - true_clearances(case, points, positions)).max() <= 1e-12
    checker = cl.Checker(case)
    alone = [checker.distance(row).distance for row in positions]
    assert np.abs(found - alone).max() <= 1e-12
    shares = np.linspace(0.0, 1.0, 20)[:, None]
    finer = positions[:-1, None] + shares * np.diff(positions, axis=0)[:, None]
    between = true_clearances(case, points, finer.reshape(-1, 6)).reshape(-1, 20).min(axis=1)
    proven = run.certificate.lower_bound[:-1]
    assert (proven <= between + 1e-12).all()
    assert (between - proven <= 1e-4 + 1e-3).all()  # samples are not the least
    assert (found == 0.0).any() == (gap < 0.3)


def test_a_point_deep_in_a_link_is_a_contact_at_every_need():
    """Nothing is near the surface: only the winding number sees it."""
    positions = way(9)
    case = case_of(np.array([[0.0, 0.0, 0.03], [0.0, 9.0, 0.0]]), positions)
    middle = flying("inside", cl.box(2.0 * HALF), [], np.zeros((3, 6)))
    middle = replace(middle, obstacles=case.obstacles)
    for need in ("steps", "pairs", "limit", "minimum"):
        run = cl.check(middle, need=need)
        assert (run.worst["clearance"], run.status) == (0.0, "contact")


def test_a_cloud_that_moves_by_a_clock_of_its_own():
    """Every step of one clock against every step of the other, by arithmetic."""
    points, positions = scan(300), way(15)
    times = np.linspace(0.0, 1.0, 12)
    poses = np.tile(np.eye(4), (12, 1, 1))
    poses[:, 1, 3] = np.linspace(0.0, 0.8, 12)
    moves = cl.PoseTable(times, poses[:, :3, 3], np.tile([0.0, 0.0, 0.0, 1.0], (12, 1)))
    case = replace(case_of(points, positions, moves=moves), clock=cl.Clock(float("inf")))
    least = min(
        true_clearances(case, points + [0.0, y, 0.0], positions).min() for y in poses[:, 1, 3]
    )
    record = cl.check(case).record
    assert abs(np.nanmin(record.steps["clearance"].to_numpy()) - least) <= 1e-12
    assert record.certificate.lower_bound.min() <= least + 1e-12


def test_contact_with_a_cloud_is_said_to_have_no_depth():
    case = case_of(scan(gap=0.0), way(15))
    run = cl.check(case)
    told = [notice.text for notice in run.record.notices if notice.kind == "contact"]
    assert told == [
        "contact with scan has no depth, volume or separation vector here: clouds of points"
    ]
    assert not len(run.record.contacts)
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])))
    both = cl.check(replace(case, obstacles=(*case.obstacles, block))).record
    assert {row.obstacle for row in both.contacts} == {"block"}
    assert both.deepest.penetration > 0.05


@pytest.mark.peer
@pytest.mark.parametrize("gap", [0.4, 0.0])
def test_the_cross_check_asks_fcl_about_the_cloud_too(gap):
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])), at(0.3, -0.25))
    case = case_of(scan(gap=gap), way(15))
    for one in (case, replace(case, obstacles=(*case.obstacles, block))):
        record = cl.check(one, cross_check=True).record
        assert record.cross_check.agrees and record.cross_check.n_steps == 15
        assert record.cross_check.greatest_difference <= record.cross_check.tolerance < 1e-8
        assert not [notice for notice in record.notices if notice.kind == "cross-check"]


@pytest.mark.peer
def test_a_cloud_that_is_too_large_for_fcl_is_left_out_and_named(monkeypatch):
    monkeypatch.setattr("clearance.crosscheck.pairs.MOST_POINTS", 4000)
    case = case_of(scan(), way(15))
    alone = cl.check(case, cross_check=True).record
    assert alone.cross_check is None
    (told,) = [notice.text for notice in alone.notices if notice.kind == "cross-check"]
    assert told.startswith("1 pairs with clouds of points are not cross-checked")
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])), at(0.3, -0.25))
    both = cl.check(replace(case, obstacles=(*case.obstacles, block)), cross_check=True).record
    assert both.cross_check.n_steps == 15
    assert not both.cross_check.disagreements


def test_what_needs_a_surface_is_refused_by_name():
    case = case_of(scan(10), way(3))
    with pytest.raises(BadInput, match="'scan' is a cloud of points"):
        cl.Question(case, method="paper")
    with pytest.raises(BadShape, match="'scan' is a cloud of points, which has no outline"):
        swept_profile(case, "xy", obstacles=["scan"])
    robot = case.robots[0].robot
    cloud = replace(robot, bodies=(cl.Body("l6", cl.PointCloud([[0, 0, 0]], 0.1)),))
    with pytest.raises(BadShape, match="link 'l6' of robot 'flying' is a cloud of points"):
        replace(case, robots=(replace(case.robots[0], robot=cloud),))
