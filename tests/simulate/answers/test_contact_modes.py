"""Which overlaps a run works out, when, and that the verdict never waits for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.query.contact import BodyPair
from clearance.simulate.answers.contact import contacts as contact_work
from clearance.simulate.answers.contact.events import events_of
from clearance.world.robot import JointKind
from clearance.world.rules import Rule
from tests.made_cases import at, driven, flying

WAY = np.array([0.5, 0.75, 0.8, 0.85, 0.9, 0.82, 0.6, 0.5, 0.79, 0.78, 0.5])
"""Two events: rows 2 to 5 (a wall from 0.9, a cube of 0.2: at 0.9 it is 0.1 deep), and 8 alone; 0.78 is apart."""


def block(name: str, pose: np.ndarray, **more) -> cl.Obstacle:
    return cl.Obstacle(cl.Body(name, cl.box((0.2, 0.2, 0.2))), pose, **more)


def passing(xs: Sequence[float], *obstacles: cl.Obstacle, size: float = 0.2) -> cl.Case:
    """A cube that goes along x."""
    positions = np.zeros((len(xs), 6))
    positions[:, 0] = xs
    case = flying("passing", cl.box((size,) * 3), [], positions)
    return replace(case, obstacles=obstacles)


def sliding(shape):
    """The cube goes into a body whose face is at 0.885."""
    return passing(WAY, cl.Obstacle(cl.Body("wall", shape), at(0.885)))


def wall():
    return cl.box((0.2, 1.0, 1.0)).transformed(at(0.1))


def channel():
    """The wall with a groove in its far side: concave, far from where the cube is."""
    outline = [
        (0.0, -0.5), (0.2, -0.5), (0.2, -0.2), (0.1, -0.2), (0.1, 0.2), (0.2, 0.2), (0.2, 0.5), (0.0, 0.5)
    ]  # fmt: skip
    vertices = np.array([(x, y, z) for z in (-0.5, 0.5) for x, y in outline])
    top = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 7), (4, 5, 7), (5, 6, 7)]
    faces = [*(t[::-1] for t in top), *(tuple(i + 8 for i in t) for t in top)]
    for i in range(8):
        j = (i + 1) % 8
        faces += [(i, j, j + 8), (i, j + 8, i + 8)]
    return cl.Polyhedron.from_triangles(vertices, np.array(faces))


@pytest.fixture
def asked(monkeypatch):
    """How often an overlap at a step was worked out; the search between steps says how its own are bounded."""
    calls = []
    real = BodyPair.contact

    def counted(*given, **named):
        if "bounded" not in named:
            calls.append(1)
        return real(*given, **named)

    monkeypatch.setattr(BodyPair, "contact", counted)
    return calls


@pytest.mark.parametrize("shape", [wall(), channel()], ids=["convex", "concave"])
@pytest.mark.cold
def test_what_is_worked_out_is_none_the_deepest_moments_or_all(asked, shape):
    found = {}
    for how, n_asked in (("none", 0), ("events", 2), ("every", 5)):
        asked.clear()
        run = cl.check(sliding(shape), contact=how)
        found[how] = [(row.step, row.known is not None) for row in run.record.contacts]
        assert len([*run.record.worked_out]) == len(asked) == n_asked
    assert [step for step, _ in found["none"]] == [2, 3, 4, 5, 8]
    assert found["events"] == [(2, False), (3, False), (4, True), (5, False), (8, True)]
    assert all(known for _, known in found["every"]) and not any(
        known for _, known in found["none"]
    )


@pytest.mark.parametrize("shape", [wall(), channel()], ids=["convex", "concave"])
@pytest.mark.cold
def test_the_other_rows_are_worked_out_by_the_session(asked, shape):
    run = cl.check(sliding(shape), contact="none")
    row = run.record.contacts[1]
    assert row.known is None and run.record.deepest is None and asked == []
    found = run.session.overlap(row)
    assert found.penetration == pytest.approx(WAY[3] + 0.1 - 0.885, abs=1e-9)
    assert not found.region.is_empty and len(asked) == 1
    every = cl.check(sliding(shape), contact="every").record.contacts[1].known
    assert every.penetration_at_least <= found.penetration * (1.0 + 1e-12)
    assert found.penetration_at_least <= every.penetration * (1.0 + 1e-12)


def test_the_steps_say_how_deep_only_where_all_is_worked_out():
    run = cl.check(sliding(wall()))
    depths = run.steps["penetration"].to_pylist()
    assert [i for i, depth in enumerate(depths) if depth is not None] == [4, 8]
    assert depths[4] == pytest.approx(0.115, abs=1e-12)
    assert run.steps["volume"].to_pylist()[4] == pytest.approx(0.115 * 0.04, rel=1e-9)
    none = cl.check(sliding(wall()), contact="none").steps
    assert none["penetration"].null_count == none["volume"].null_count == none.num_rows


@pytest.mark.cold
def test_beyond_the_budget_there_are_bounds_and_it_is_said(monkeypatch, asked):
    monkeypatch.setattr(contact_work, "WORK", int(1.5 * contact_work.ROW))
    exact = [row.known for row in cl.check(sliding(channel()), contact="every").record.contacts]
    asked.clear()
    runs = [cl.check(sliding(channel())) for _ in range(2)]
    told = [[row.known for row in run.record.worked_out] for run in runs]
    assert [repr(one) for one in told[0]] == [repr(one) for one in told[1]]
    assert len(told[0]) == 2 and len(asked) == 2  # the first event of each run
    beyond, truth = told[0][1], exact[4]
    assert beyond.penetration >= truth.penetration_at_least and beyond.penetration_at_least == 0.0
    assert beyond.volume >= truth.volume_at_least and beyond.exact == (False, False)
    assert any("beyond the work allowed" in note for note in runs[0].record.contact_notes)


def test_events_are_unbroken_stretches_of_one_pair():
    steps = np.array([3, 3, 4, 4, 5, 7, 7])
    pairs = np.array([0, 2, 0, 2, 0, 0, 1])
    found = [(event.i_pair, steps[event.rows].tolist()) for event in events_of(steps, pairs)]
    assert found == [(0, [3, 4, 5]), (0, [7]), (1, [7]), (2, [3, 4])]
    assert list(events_of(steps[:0], pairs[:0])) == []


@pytest.mark.slow
def test_the_deepest_step_of_a_bar_that_passes_a_ball_is_the_deepest_of_all():
    """A few directions rate hulls, none of them the way out of a ball: the best rated step is not the deepest."""
    bar = driven(cl.box((0.8, 0.05, 0.05)), JointKind.REVOLUTE, np.linspace(-0.13, 0.3, 25))
    ball = cl.Obstacle(cl.Body("ball", cl.sphere(0.1, tolerance=1e-3)), at(0.37, 0.075, 0.03))
    case = cl.Case("pass", (bar,), (ball,))
    every, chosen = (cl.check(case, contact=what).worst for what in ("every", "events"))
    assert chosen["penetration"] == every["penetration"] and chosen["step"] == every["step"]


def test_a_link_in_the_wall_of_a_ring_is_deepest_in_its_middle():
    """Hulls would say: at once, since the hole is inside the hull."""
    shape = cl.pipe(inner_radius=0.7, outer_radius=1.3, length=0.6, sections=48)
    way = np.linspace(0.0, 2.0, 101)
    case = passing(way, cl.Obstacle(cl.Body("ring", shape)), size=0.4)
    (row,) = cl.check(case).record.worked_out
    assert 0.9 <= way[row.step] <= 1.1
    assert 0.0 < row.known.penetration_at_least <= row.known.penetration <= 0.52


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
    every = cl.check(case, contact="every")
    volumes = [row.known.volume for row in every.record.contacts if row.step == 0]
    assert len(volumes) == 2 and every.steps["volume"][0].as_py() == pytest.approx(sum(volumes))
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


def test_a_touch_that_rounding_parts_in_another_frame_is_a_contact_of_depth_0():
    """A slider that ends exactly at a wall, turned: contact in the world, whatever the wall's own frame says."""
    turned = np.eye(4)
    turned[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    near = 0.1 * np.array([1.0, 1e-16, 0.0, -1e-16, -2e-16]) - 0.1
    cube = driven(cl.box((0.2,) * 3), JointKind.PRISMATIC, near, axis=(1, 0, 0), base=turned)
    wall = cl.Obstacle(cl.Body("wall", cl.box((0.2, 1.0, 1.0))), turned @ at(0.2))
    rows = cl.check(cl.Case("touch", (cube,), (wall,))).steps.to_pylist()
    for row in rows:
        assert (row["clearance"] == 0.0) == (row["penetration"] is not None)
    assert all(row["penetration"] < 1e-12 for row in rows if row["clearance"] == 0.0)
