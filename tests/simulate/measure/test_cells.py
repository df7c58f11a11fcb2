"""Whole runs of cells in which everything moves: steps, proofs between them and FCL, against single questions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, NothingToMeasure
from clearance.simulate.measure.sections import section_plan
from clearance.world.case import Clock, Limits
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests import cells
from tests.cells import cell, pose_at
from tests.examples import first_fast


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
