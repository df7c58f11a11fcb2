"""What is asked for changes the work, not the answer: all needs agree, and each does less than more would.

Cases made to defeat every bound: the answers are still those of FCL.
"""

from __future__ import annotations

import os
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.crosscheck.triangles import triangle_soup
from clearance.errors import BadInput
from clearance.geometry.shapes import box, cylinder
from clearance.simulate.measure import resources
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources, in_order
from clearance.world.case import Case, Limits
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import measured_pairs
from tests.made_cases import WORST, arm, at, dented, flying, spindle, torus
from tests.profiles.moving import slab, sliding
from tests.simulate.answers.test_contact_modes import channel
from tests.strategies import rotations

SCENES = Path(__file__).parents[3] / "scenes"


@pytest.fixture(scope="module")
def runs() -> dict[str, cl.Run]:
    case = cl.load_case(SCENES / "box_pipe" / "case.yaml")
    return {
        need: cl.check(case, need=need, certify=False)
        for need in ("steps", "pairs", "limit", "minimum")
    }


def test_pairs_have_the_same_steps_and_their_least_is_the_step(runs: dict[str, cl.Run]) -> None:
    steps, pairs = runs["steps"].steps, runs["pairs"].steps
    assert steps.equals(pairs)
    every = runs["pairs"].pairs
    matrix = every["clearance"].to_numpy().reshape(steps.num_rows, -1)
    assert (matrix.min(axis=1) == steps["clearance"].to_numpy()).all()


def test_pair_minima_are_the_least_of_the_matrix(runs: dict[str, cl.Run]) -> None:
    lazy, known = runs["steps"].pair_minima, runs["pairs"].pair_minima
    numbers = (1, 2, 5, 20, 60, 1000)
    first = [lazy[:most] for most in numbers]  # before all are known: only these are measured
    assert list(lazy) == list(known)
    assert first == [known[:most] for most in numbers]
    every = runs["pairs"].pairs.to_pydict()
    least: dict[tuple[str, str], float] = {}
    for link, obstacle, clearance in zip(
        every["link"], every["obstacle"], every["clearance"], strict=True
    ):
        least[link, obstacle] = min(clearance, least.get((link, obstacle), np.inf))
    assert {(m.link, m.obstacle): m.clearance for m in lazy} == least


def test_less_asked_is_less_done(runs: dict[str, cl.Run]) -> None:
    tests = {need: run.record.tally["polygon_tests"] for need, run in runs.items()}
    assert tests["limit"] < tests["steps"] <= tests["pairs"]
    queries = {need: run.record.tally["queries"] for need, run in runs.items()}
    assert queries["minimum"] < queries["steps"] <= queries["pairs"]


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_a_pair_of_which_nothing_has_moved_is_not_asked_again(
    need: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last link of three moves all the time, the others from step 20 to 29 only."""
    swing = 0.4 * np.sin(0.1 * np.arange(60.0))
    positions = np.stack([np.where(np.arange(60) < 20, 0.0, swing)] * 2 + [swing], axis=1)
    positions[30:, :2] = positions[29, :2]
    shapes = [spindle(0.05, 0.1, 6)] * 3
    near, far = (
        (torus(0.12, 0.05, 12, 6), at(0.3, 0.25, 0.2)),
        (spindle(0.1, 0.2, 6), at(0.5, -0.4, 0.3)),
    )
    case = arm("resting", shapes, [near, far], positions)
    run = cl.check(case, need=need, certify=False)
    tally = run.record.tally
    assert tally["queries"] + tally["pairs_skipped"] == 60 * 6
    assert tally["queries"] <= 60 * 2 + 11 * 4
    assert need == "steps" or tally["queries"] == 60 * 2 + 11 * 4
    monkeypatch.setattr(resources, "LONGEST_PART", 1)  # nothing is carried from step to step
    afresh = cl.check(case, need=need, certify=False)
    assert afresh.steps.equals(run.steps)
    assert list(afresh.pair_minima) == list(run.pair_minima)
    assert need == "steps" or afresh.pairs.equals(run.pairs)


def test_needs_that_do_not_go_together_are_refused() -> None:
    case = cl.load_case(SCENES / "box_box" / "case.yaml")
    for asked, told in [
        ({"need": "all"}, "need: 'all' is given; one of steps, pairs"),
        ({"need": "limit", "cross_check": True}, "cross-check needs every step"),
        ({"need": "pairs", "method": "paper"}, "method 'paper' measures every step"),
    ]:
        with pytest.raises(BadInput, match=told):
            cl.answer(cl.Question(case, **asked))
    with pytest.raises(BadInput, match="0 jobs"):
        cl.Resources(jobs=0)


@pytest.mark.parametrize("limits", [cl.Limits(), cl.Limits(fail=0.001, warn=0.15)])
def test_steps_that_are_not_measured_behind_a_contact_have_no_status(limits: cl.Limits) -> None:
    """The slab touches the post at one step, and is asked about no further."""
    post = cl.Obstacle(cl.Body("post", slab([0.6, -0.05, 0.0], [0.7, 0.05, 0.1])))
    way = sliding(slab([0.0, -0.05, 0.0], [0.1, 0.05, 0.1]), [0.0, 0.3, 0.5, 0.3, 0.1, 0.0])
    case = replace(way, obstacles=(post,), limits=limits)
    run = cl.check(case, need="minimum")
    told = {row["step"]: row["status"] for row in run.steps.to_pylist()}
    true = {row["step"]: row["status"] for row in cl.check(case).steps.to_pylist()}
    assert told[2] == true[2] == "contact"
    assert all(told[step] in (None, true[step]) for step in true)
    assert [told[step] for step in (3, 4, 5)] == [None] * 3
    assert run.summary["status_counts"]["contact"] == 1


SOME_STEPS = (0, 7, 23)


@pytest.fixture(scope="module", params=WORST)
def run(request):
    return cl.check(WORST[request.param](), need="pairs", certify=False)


def placed_bodies(run, step):
    """Shape and `world_from_body` of every link, and of every obstacle."""
    case = run.record.case
    (placed,) = case.robots
    poses = link_poses(placed, placed.trajectory.positions[step : step + 1])[0]
    names = placed.robot.link_names
    links = [(body.name, body.shape, poses[names.index(body.name)]) for body in placed.robot.bodies]
    return links, [(o.body.name, o.body.shape, o.world_from_body) for o in case.obstacles]


def pair_rows(run, step):
    rows = run.pairs.to_pydict()
    keys = zip(rows["step"], rows["link"], rows["obstacle"], rows["clearance"], strict=True)
    return {(link, obstacle): clearance for i, link, obstacle, clearance in keys if i == step}


@pytest.mark.peer
@pytest.mark.parametrize("step", SOME_STEPS)
def test_fcl_in_millimetres_says_the_same_of_every_pair(run, step):
    fcl = pytest.importorskip("fcl")

    def in_millimetres(shape, pose):
        soup = triangle_soup(shape)
        model = fcl.BVHModel()
        model.beginModel(len(soup.vertices), len(soup.triangles))
        model.addSubModel(soup.vertices * 1e3, soup.triangles)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform(pose[:3, :3], pose[:3, 3] * 1e3))

    links, obstacles = placed_bodies(run, step)
    theirs = [in_millimetres(shape, pose) for _, shape, pose in obstacles]
    found = pair_rows(run, step)
    for name, shape, pose in links:
        ours = in_millimetres(shape, pose)
        for (obstacle, *_), other in zip(obstacles, theirs, strict=True):
            said = fcl.distance(ours, other, fcl.DistanceRequest(), fcl.DistanceResult()) * 1e-3
            assert found[name, obstacle] == pytest.approx(max(0.0, said), abs=1e-9)


def measured(case, motion, steps, need="steps"):
    """What is found of some steps of a motion that is nothing else."""
    part = Motion(motion.placed, motion.times[steps], motion.positions[steps], np.zeros(len(steps)))
    return measure(PairsInMotion(case, (part,), measured_pairs(case)[0]), need, Resources(jobs=1))


def ball_through_wall():
    """A faceted ball that slides into a channel, askew, so that many faces meet at once."""
    positions = np.zeros((100, 6))
    positions[:, 0] = np.linspace(-0.3, 1.7, 100)
    turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    wall = channel(), at(0.7, 0.05, 0.02, turned=turned)
    return flying("ball", cl.sphere(0.15), [wall], positions)


def whole_run(need):
    """The ball's case and motion, what is measured of all its steps, and those in contact."""
    case = ball_through_wall()
    motion = kinematic_motion(case.robots[0])
    whole = measured(case, motion, np.arange(motion.n_steps), need)
    return case, motion, whole, np.flatnonzero(whole.clearance == 0.0)


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_every_row_before_in_and_after_contact_is_that_of_its_step_alone(need):
    case, motion, whole, touching = whole_run(need)
    assert 5 < touching[0] < touching[-1] < motion.n_steps - 5 and len(touching) > 20
    for step in range(motion.n_steps):
        alone = measured(case, motion, np.array([step]), need)
        assert alone.clearance[0] == whole.clearance[step]
        assert np.array_equal(alone.points[0], whole.points[step])


def test_of_several_pairs_in_contact_the_least_is_named():
    """Three links in a row, and two balls that both the last two go through."""
    balls = [(cl.sphere(0.1, tolerance=0.01), at(x)) for x in (0.35, 0.6)]
    case = arm(
        "through", [cl.box((0.2, 0.1, 0.1))] * 3, balls, np.linspace([-1, 0, 0], [1, 0, 0], 60)
    )
    motion = kinematic_motion(case.robots[0])
    steps, every = (
        measured(case, motion, np.arange(motion.n_steps), need) for need in ("steps", "pairs")
    )
    touching = np.flatnonzero(steps.clearance == 0.0)
    assert ((every.every[touching] == 0.0).sum(axis=1) > 1).any()
    for step in touching:
        assert steps.pair[step] == np.flatnonzero(every.every[step] == 0.0)[0]


def test_nothing_is_worked_on_any_more_when_no_more_is_wanted() -> None:
    started, done = [], []

    def work(span: slice) -> None:
        started.append(span.start)
        time.sleep(0.01)
        done.append(span.start)

    results = in_order(work, [slice(i, i + 1) for i in range(20)], 2)
    next(results)
    results.close()
    assert sorted(started) == sorted(done)
    assert len(done) < 10


@pytest.mark.cold
@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks here")
def test_a_process_forked_after_a_run_on_threads_runs_on_threads_of_its_own() -> None:
    spans = [slice(i, i + 1) for i in range(4)]
    list(in_order(lambda span: span.start, spans, 2))
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        os._exit(0 if list(in_order(lambda span: span.start, spans, 2)) == [0, 1, 2, 3] else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.parametrize("fails", [0, 1, 7, 19])
def test_an_error_comes_after_the_results_before_it(fails) -> None:
    def work(span: slice) -> int:
        if span.start == fails:
            raise ValueError(fails)
        time.sleep(0.001)
        return span.start

    results = in_order(work, [slice(i, i + 1) for i in range(20)], 2)
    assert [next(results) for _ in range(fails)] == list(range(fails))
    with pytest.raises(ValueError, match=str(fails)):
        next(results)


def test_progress_of_a_section_ends_with_its_steps_however_its_measurement_counts() -> None:
    seen = []
    own = Resources(progress=lambda done, of: seen.append((done, of))).of_section(1, (10, 20), 30)
    for done in (1, 5, 19):
        own.progress(done, 19)
    assert seen == [(10, 30), (12, 30), (20, 30)]
    assert Resources().of_section(0, (0, 10), 30).progress is None


def swaying_arm(random: np.random.Generator) -> Case:
    """Up to four links whose joints sway each at its own pace, some that rest or jerk, among obstacles."""
    n_links, n_steps = int(random.integers(1, 5)), int(random.integers(2, 500))
    pace = random.choice([0.001, 0.01, 0.1, 1.0], (1, n_links))
    sway = np.sin(np.arange(n_steps)[:, None] * pace + random.uniform(0.0, 6.0, (1, n_links)))
    positions = random.uniform(-2.0, 2.0, (1, n_links)) + random.choice([0.1, 0.5, 2.0]) * sway
    positions += random.choice([0.0, 1e-9, 0.05]) * random.normal(size=positions.shape)
    positions[:, random.integers(n_links)] *= random.choice([0.0, 1.0])
    shapes = {
        "spindle": lambda: spindle(0.05, 0.1, 5),
        "dented": lambda: dented(random, 0, 0.4, 0.08),
        "box": lambda: box(random.uniform(0.02, 0.2, 3)),
        "cylinder": lambda: cylinder(0.04, 0.2),
        "ring": lambda: torus(0.1, 0.04, 9, 5),
    }
    some = [shapes[kind]() for kind in random.choice(list(shapes), n_links + random.integers(1, 5))]
    around = random.choice([0.35, 0.8])
    obstacles = [
        (shape, at(*around * random.normal(size=3), turned=rotations(random, 1)[0]))
        for shape in some[n_links:]
    ]
    warn = random.choice([1e-3, 0.02, 0.1, 0.4])
    return replace(
        arm("swaying", some[:n_links], obstacles, positions), limits=Limits(warn / 2.0, warn)
    )


@pytest.mark.parametrize("seed", range(16))
def test_bodies_with_clocks_of_their_own_miss_nothing(seed):
    case = swaying_arm(np.random.default_rng(seed))
    runs = {
        need: cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=1))
        for need in ("steps", "limit", "minimum")
    }
    truth = runs["steps"].steps["clearance"].to_numpy()
    told = runs["limit"].steps["clearance"].to_numpy()
    known = ~np.isnan(told)
    assert (told[known] == truth[known]).all()
    assert known[truth < case.limits.warn].all()
    assert runs["limit"].steps["status"].equals(runs["steps"].steps["status"])
    assert runs["limit"].worst["step"] == runs["steps"].worst["step"]
    assert runs["minimum"].worst["clearance"] == truth.min()
    assert runs["minimum"].worst["step"] == truth.argmin()
    for need in ("limit", "minimum"):
        if "lower_bound" in runs[need].steps.column_names:  # not if every step is known
            assert (runs[need].steps["lower_bound"].to_numpy() <= truth).all()
