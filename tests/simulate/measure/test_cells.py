"""Whole runs of cells in which everything moves: steps, proofs between them and FCL, against single questions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.record.rows import resumable as resumable_rows
from clearance.simulate.measure.sections import section_plan
from clearance.world.case import Limits
from clearance.world.rules import Rule
from clearance.world.timing import Window
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


@pytest.mark.parametrize("need", first_fast(["limit", "pairs", "minimum"], 1))
@pytest.mark.parametrize("seed", [0])
def test_other_needs_know_the_same_worst(seed, need):
    case = ruled(seed)
    whole, run = cl.check(case), cl.check(case, need=need)
    assert run.record.worst.clearance == pytest.approx(whole.record.worst.clearance, abs=1e-4)
    assert run.status == whole.status
    for rule in whole.record.rules:
        found = run.record.rule(rule.name)
        assert found.worst_sample.clearance == pytest.approx(rule.worst_sample.clearance, abs=1e-9)


@pytest.mark.parametrize("seed", [0])
def test_threads_change_no_byte(seed):
    case = ruled(seed)
    one, two = (cl.check(case, resources=cl.Resources(jobs=jobs)) for jobs in (1, 2))
    assert one.steps.equals(two.steps)
    assert one.certificate.lower_bound.tobytes() == two.certificate.lower_bound.tobytes()


class Broken(Exception):
    """What breaks a run off."""


@pytest.mark.slow
@pytest.mark.parametrize("after", [17])
def test_a_run_that_was_broken_off_goes_on_to_the_same_bytes(tmp_path, after, monkeypatch):
    monkeypatch.setattr(resumable_rows, "SAVE_AFTER", 0.0)
    case, left = ruled(2), [after]
    whole = cl.check(case)

    def progress(done, of):
        left[0] -= 1
        if left[0] < 0:
            raise Broken

    place, told = tmp_path / "rows", []
    with pytest.raises(Broken), resumable_rows.open_resumable_rows(place, told.append) as rows:
        cl.check(case, resources=cl.Resources(1, progress, rows))
    with resumable_rows.open_resumable_rows(place, told.append) as rows:
        again = cl.check(case, resources=cl.Resources(1, None, rows))
        assert again.steps.equals(whole.steps)
        for name in ("lower_bound", "upper_bound", "share", "pair"):
            assert np.array_equal(
                getattr(again.certificate, name), getattr(whole.certificate, name)
            )
    assert after < 5 or any("resuming" in line for line in told)
