"""One configuration after another against a run over the same positions, bit for bit, in any order."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadShape, NotFinite, NothingToMeasure
from clearance.world.plausibility import notices_of
from tests.examples import first_fast
from tests.made_cases import arm, at, ball, faces_of, flying

CASES = [f"scenes/{name}/case.yaml" for name in ("box_box", "panda_shelf", "hot_cell")]


@pytest.fixture(scope="module", params=first_fast(CASES, 2))
def run(request):
    return cl.check(cl.load_case(request.param), certify=False)


def assert_row(near, steps, i):
    row = steps.slice(i, 1).to_pylist()[0]
    assert (near.distance, near.link, near.obstacle) == (
        row["clearance"],
        row["body_a"],
        row["body_b"],
    )
    assert near.point_link.tolist() == [row[f"a_{axis}"] for axis in "xyz"]
    assert near.point_obstacle.tolist() == [row[f"b_{axis}"] for axis in "xyz"]
    assert near.contact == (row["clearance"] == 0.0)


@pytest.mark.slow
def test_answers_are_those_of_a_run_in_any_order(run):
    checker = cl.Checker(run.record.case)
    positions = run.record.case.robots[0].trajectory.positions
    order = np.random.default_rng(5).permutation(len(positions))
    for i in [*range(0, len(positions), 3), *order]:
        assert_row(checker.distance(positions[i]), run.steps, int(i))


def test_many_at_once_are_the_same(run):
    checker = cl.Checker(run.record.case)
    found = checker.distances(run.record.case.robots[0].trajectory.positions)
    assert np.array_equal(found.distances, run.record.clearances)
    links = [checker.pairs[i][0] for i in found.pairs]
    assert links == run.steps["link"].to_pylist()
    assert np.array_equal(found.points[:, 0, 0], run.steps["link_x"].to_numpy())


def test_a_configuration_may_name_its_joints(run):
    checker = cl.Checker(run.record.case)
    values = run.record.case.robots[0].trajectory.positions[1]
    named = dict(zip(reversed(checker.joint_names), reversed(values.tolist()), strict=True))
    assert_row(checker.distance(named), run.steps, 1)


def swaying():
    posts = [(cl.box((0.1, 0.1, 2.0)), at(x=0.9)), (cl.sphere(radius=0.2), at(y=-0.8, z=0.3))]
    positions = np.linspace([0.0, 0.1], [1.0, -0.4], 20)
    return arm("swaying", [cl.box((0.5, 0.1, 0.1)), cl.box((0.4, 0.08, 0.08))], posts, positions)


def test_two_robots_are_asked_about_together():
    case = swaying()
    (one,) = case.robots
    other = replace(one, robot=replace(one.robot, name="other"), world_from_base=at(x=0.3, y=0.6))
    both = replace(case, robots=(one, other))
    run, checker = cl.check(both, certify=False), cl.Checker(both)
    assert len(checker.joint_names) == 2 * len(one.trajectory.joint_names)
    for i, row in enumerate(one.trajectory.positions):
        assert_row(checker.distance([*row, *row]), run.steps, i)


def test_without_a_trajectory_all_joints_that_are_not_fixed_are_given():
    case = swaying()
    (one,) = case.robots
    names = [joint.name for joint in one.robot.moving_joints]
    standing = replace(one, trajectory=None, fixed_positions={names[0]: 0.25})
    checker = cl.Checker(replace(case, robots=(standing,)))
    assert checker.joint_names == tuple(names[1:])
    whole = cl.Checker(case)
    assert checker.distance([0.5]).distance == whole.distance([0.25, 0.5]).distance


def test_what_cannot_be_told_is_said():
    """A box that passes through the hole of a ball: apart, then where the hole decides."""
    ball_faces, whole = faces_of(ball(2.0, 2)), ball(2.0, 2)
    outer = cl.Polyhedron(whole.vertices, ball_faces[1:])
    way = np.zeros((21, 6))
    way[:, :3] = np.linspace(3.0, 1.0, 21)[:, None] * whole.face(0).mean(axis=0)
    case = flying("inside", cl.box((0.05, 0.05, 0.05)), [(outer, np.eye(4))], way)
    checker = cl.Checker(case)
    found = checker.distances(way)
    assert found.undecided.any() and not found.undecided[0]
    for row, undecided in zip(way, found.undecided, strict=True):
        assert checker.distance(row).undecided == (tuple(checker.pairs) if undecided else ())


def test_what_is_suspect_about_the_case_is_at_hand():
    case = swaying()
    assert cl.Checker(case).notices == notices_of(case)


def test_threads_may_share_a_checker():
    case = swaying()
    run, checker = cl.check(case, certify=False), cl.Checker(case)
    positions, wrong = case.robots[0].trajectory.positions, []

    def ask(seed):
        for i in np.random.default_rng(seed).integers(0, len(positions), 200):
            if checker.distance(positions[i]).distance != run.record.clearances[i]:
                wrong.append(i)

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(ask, range(4)))
    assert not wrong


@pytest.mark.parametrize(
    ("given", "fault", "told"),
    [
        ([0.0], BadShape, "one number for each of"),
        ([[0.0, 0.0]], BadShape, "shape is (1, 2)"),
        ("zero", BadShape, "'zero'"),
        ([0.0, float("nan")], NotFinite, "NaN"),
        ([0.0, 1e300], NotFinite, "beyond any reach"),
        ({"nobody": 0.0}, BadInput, "nobody"),
    ],
)
def test_bad_configurations_are_refused(given, fault, told):
    with pytest.raises(fault) as error:
        cl.Checker(swaying()).distance(given)
    assert told in str(error.value)


def test_what_is_no_case_or_leaves_nothing_is_refused():
    with pytest.raises(BadInput, match="a Case"):
        cl.Checker("scenes/box_box/case.yaml")
    with pytest.raises(NothingToMeasure):
        cl.Checker(replace(swaying(), obstacles=()))
