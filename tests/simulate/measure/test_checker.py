"""One configuration after another against a run over the same positions, bit for bit, in any order."""

import pickle
import warnings
from collections import namedtuple
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest

import clearance as cl
from clearance.errors import BadInput, BadShape, BadTime, NotFinite, NothingToMeasure, SuspectInput
from clearance.world.budget import Budget
from clearance.world.rules import Allowance
from clearance.world.timing import Window
from tests.cells import cell
from tests.made_cases import arm, at, ball, faces_of, flying


@pytest.fixture(scope="module", params=["scenes/box_box/case.yaml", "scenes/box_pipe/case.yaml"])
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
    assert near.contact == (row["status"] == "contact")


def test_answers_are_those_of_a_run_in_any_order(run):
    checker = cl.Checker(run.record.case)
    positions = run.record.case.robots[0].trajectory.positions
    order = np.random.default_rng(5).permutation(len(positions))
    for i in [*range(0, len(positions), 3), *order]:
        assert_row(checker.distance(positions[i]), run.steps, int(i))


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
    assert checker.joint_names == ("arm/j0", "arm/j1", "other/j0", "other/j1")
    given = [1.0, -0.4, 0.2, 0.3]
    named = dict(zip(checker.joint_names, given, strict=True))
    assert str(checker.distance(named)) == str(checker.distance(given))
    with pytest.raises(BadInput, match="unknown: j0, j1; missing: arm/j0, "):
        checker.distance({"j0": 1.0, "j1": -0.4})


def test_padding_is_taken_off_and_tolerances_are_warned_of():
    """The pair that padding makes nearest is told; what touches comes first, and is no matter of padding."""
    case = swaying()
    far, near = (
        replace(one, padding=padding)
        for one, padding in zip(case.obstacles, (0.3, 0.0), strict=True)
    )
    (robot,) = case.robots
    padded = replace(case, obstacles=(far, near), robots=(replace(robot, padding={"l1": 0.01}),))
    run, checker = cl.check(padded, certify=False), cl.Checker(padded)
    given = robot.trajectory.positions
    for i, row in enumerate(given):
        assert_row(checker.distance(row), run.steps, i)
    many, plain = checker.distances(given), cl.Checker(case).distances(given)
    assert np.array_equal(many.distances, run.record.clearances) and (many.distances < 0.0).any()
    assert np.array_equal(many.points[:, 0, 0], run.steps["link_x"].to_numpy())
    assert {checker.pairs[i] for i in many.pairs} != {checker.pairs[i] for i in plain.pairs}
    assert not many.contacts.any()
    touching = replace(padded, obstacles=(far, replace(near, world_from_body=at(x=0.3))))
    found = cl.Checker(touching).distance([0.0, 0.0])
    assert found.contact and found.obstacle == near.name and found.distance in (0.0, -0.01)
    with pytest.warns(UserWarning, match="counts no tolerances"):
        cl.Checker(replace(case, tolerance=Budget()))


def cell_with_a_window():
    case = cell(3, apart=2.0)
    row = Allowance(("left/*", "post"), window=Window(2.0, 4.0))
    return replace(case, allow=(row,))


def test_at_a_time_of_the_run_parts_are_in_hands_and_windows_hold_as_in_the_run():
    case = cell_with_a_window()
    run = cl.check(case, certify=False, accept=["units", "limits"])
    positions = np.hstack([motion.positions for motion in run.record.motions])
    ends = {0.0, 2.0, 4.0, *(t for one in case.carries for t in one.window.ends)}
    times = run.steps["time"].to_pylist()
    steps = [i for i, time in enumerate(times) if time not in ends]  # there the run has two answers
    in_hands = [i for i in steps if any(c.window.holds(times[i], times[i]) for c in case.carries)]
    for i in {*steps[:: len(steps) // 3], *in_hands[:: len(in_hands) // 2]}:
        checker = cl.Checker(case, time=times[i], accept=["units", "limits"])
        assert_row(checker.distance(positions[i]), run.steps, i)
    with pytest.raises(BadTime, match=r"7 s is outside the run; a time from 0 s to 6 s"):
        cl.Checker(case, time=7.0)


def test_what_changes_in_the_run_is_left_out_only_with_a_warning():
    case = cell_with_a_window()
    with pytest.warns(UserWarning, match="give time=") as told:
        cl.Checker(case, accept=["units", "limits"])
    (one,) = told
    assert one.filename == __file__
    for part in ("part 'part' is carried", "obstacle 'door' moves", "allow[0]"):
        assert part in str(one.message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cl.Checker(case, time=1.0, accept=["units", "limits"])
        cl.Checker(swaying())


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
    checker = cl.Checker(case, accept=["inside"])
    found = checker.distances(way)
    assert found.undecided.any() and not found.undecided[0]
    for row, undecided in zip(way, found.undecided, strict=True):
        assert checker.distance(row).undecided == (tuple(checker.pairs) if undecided else ())
    strict, i = cl.Checker(case), int(np.argmax(found.undecided))
    assert strict.distance(way[0]).distance == found.distances[0]
    for ask in (lambda: strict.distance(way[i]), lambda: strict.distances(way)):
        with pytest.raises(SuspectInput, match="may be inside obstacle"):
            ask()


@pytest.mark.parametrize(
    ("given", "fault", "told"),
    [
        ([0.0], BadShape, "one number for each of"),
        ([[0.0, 0.0]], BadShape, "shape is (1, 2)"),
        ("zero", BadShape, "'zero'"),
        ([0.0, float("nan")], NotFinite, "NaN"),
        ([0.0, 1e300], NotFinite, "beyond any reach"),
        ({"nobody": 0.0, "j0": 0.0}, BadInput, "unknown: nobody; missing: j1;"),
    ],
)
def test_bad_configurations_are_refused(given, fault, told):
    with pytest.raises(fault) as error:
        cl.Checker(swaying()).distance(given)
    assert told in str(error.value)


class Series:
    """What names its values and is no `Mapping`, as a row of a table of pandas."""

    def __init__(self, names: list[str], values: list[float]) -> None:
        self._values = dict(zip(names, values, strict=True))

    def keys(self):
        return self._values.keys()

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __array__(self, dtype=None, copy=None):
        return np.array([*self._values.values()])


class Table:
    """What names its columns, as a table of pandas."""

    def __init__(self, columns: list[str], rows: list[list[float]]) -> None:
        self.columns, self._rows = columns, np.array(rows)

    def __array__(self, dtype=None, copy=None):
        return self._rows


Row = namedtuple("Row", ["j1", "j0"])
IN_ORDER = [[0.3, 0.1], [-0.2, 0.7]]
TURNED = [row[::-1] for row in IN_ORDER]
NAMED = {
    "a table of pandas": Table(["j1", "j0"], TURNED),
    "a table of Arrow": pa.table({"j1": [0.1, 0.7], "j0": [0.3, -0.2]}),
    "a batch of Arrow": pa.record_batch({"j1": [0.1, 0.7], "j0": [0.3, -0.2]}),
    "a dict of columns": {"j1": np.array([0.1, 0.7]), "j0": [0.3, -0.2]},
    "rows of pandas": [Series(["j1", "j0"], row) for row in TURNED],
    "rows that are dicts": [{"j1": row[0], "j0": row[1]} for row in TURNED],
    "named tuples": tuple(Row(*row) for row in TURNED),
    "named and in order": [IN_ORDER[0], Row(*TURNED[1])],
}


@pytest.mark.parametrize("kind", NAMED)
def test_what_names_its_values_is_read_by_name_in_whatever_order(kind):
    case, given = swaying(), NAMED[kind]
    checker = cl.Checker(case)
    wanted = checker.distances(IN_ORDER).distances
    assert checker.distances(given).distances.tolist() == wanted.tolist()
    made = cl.Trajectory([0.0, 1.0], ["j0", "j1"], given, given)
    assert made.positions.tolist() == made.velocities.tolist() == IN_ORDER
    moved = case.with_trajectory([0.0, 1.0], given)
    assert moved.robots[0].trajectory.positions.tolist() == IN_ORDER
    if isinstance(given, (list, tuple)):
        assert [checker.distance(row).distance for row in given] == wanted.tolist()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (Table(["j1", "x"], TURNED), "unknown: x; missing: j0; one number for each of j0, j1"),
        (pa.table({"x": [0.1, 0.7], "j1": [0.3, -0.2]}), "unknown: x; missing: j0"),
        (Table(["j1", "j0", "j1"], [[0.1, 0.3, 0.1]]), "twice: j1"),
        ([Row(0.1, 0.3), {"j1": 0.1}], "missing: j0"),
        (Table([("arm", "j1"), ("arm", "j0")], TURNED), "missing: j0, j1"),
        ({0: [0.1], 1: [0.3]}, "unknown: 0, 1; missing: j0, j1"),
        ({"j0": np.ma.array([0.1], mask=[True]), "j1": [0.3]}, "values are masked"),
    ],
)
def test_names_of_no_joint_are_refused(given, told):
    with pytest.raises(BadInput, match=told):
        cl.Checker(swaying()).distances(given)
    with pytest.raises(BadInput, match=told):
        cl.Trajectory([0.0, 1.0], ["j0", "j1"], given)


def test_what_is_no_case_or_leaves_nothing_is_refused():
    with pytest.raises(BadInput, match="a Case"):
        cl.Checker("scenes/box_box/case.yaml")
    with pytest.raises(NothingToMeasure):
        cl.Checker(replace(swaying(), obstacles=()))


def limited(**changes):
    """The swaying arm, its joints limited to a turn of 1 rad either way, and without a motion."""
    case = swaying()
    (one,) = case.robots
    joints = [replace(joint, lower=-1.0, upper=1.0) for joint in one.robot.joints]
    robot = replace(one.robot, joints=tuple(joints))
    return replace(case, robots=(replace(one, robot=robot, trajectory=None, **changes),))


@pytest.mark.slow
def test_configurations_in_degrees_are_suspect_each_time():
    checker = cl.Checker(limited())
    for degrees in ([0.0, 45.0], [[0.0, 0.0], [0.0, 45.0]]):
        ask = checker.distance if np.ndim(degrees) == 1 else checker.distances
        for _ in range(2):
            with pytest.raises(SuspectInput, match=r"configuration: .*goes to 45 rad.*degrees"):
                ask(degrees)
    with pytest.raises(SuspectInput, match=r"leaves its limits -1 to 1 rad by up to 1\.9 rad"):
        checker.distance([0.0, 2.9])
    with pytest.raises(SuspectInput, match="CHECK LIMITS"):
        cl.Checker(limited(), accept=["units"]).distance([0.0, 45.0])
    meant = cl.Checker(limited(), accept=["units", "limits"])
    assert meant.distance([0.0, 45.0]).distance > 0.0
    own = cl.Checker(replace(limited(), accept=("units", "limits")))
    assert own.distance([0.0, 45.0]).distance == meant.distance([0.0, 45.0]).distance


def test_the_code_of_a_limit_accepts_joints_a_little_beyond_it_and_no_others(recwarn):
    checker = cl.Checker(limited(), accept=["CL424"])
    assert checker.distance([0.0, 1.05]).distance > 0.0 and not recwarn
    with pytest.raises(SuspectInput, match=r"up to 1\.9 rad.*accept=\['limits'\]"):
        checker.distance([0.0, 2.9])


def test_a_joint_a_little_beyond_its_limits_is_warned_of_once(recwarn):
    checker = cl.Checker(limited())
    checker.distance([0.0, 1.0])
    assert not recwarn.list
    checker.distance([0.0, 1.1])
    (told,) = [str(one.message) for one in recwarn.list]
    assert "leaves its limits -1 to 1 rad by up to 0.1 rad" in told
    assert recwarn.list[0].filename == __file__
    checker.distance([1.2, 1.1])
    checker.distances([[1.2, 1.1]])
    assert len(recwarn.list) == 1
    with pytest.raises(SuspectInput):
        checker.distance([0.0, 2.9])


def test_a_case_that_is_suspect_is_no_checker_unless_that_is_accepted():
    case = limited()
    post = cl.Obstacle(cl.Body("post", cl.box((100.0, 100.0, 2000.0))), at(x=900.0))
    wide = replace(case, obstacles=(post,))
    with pytest.raises(SuspectInput, match=r"CHECK UNITS: .*accept=\['units'\]"):
        cl.Checker(wide)
    assert cl.Checker(wide, accept=["units"]).distance([0.0, 0.0]).distance > 800.0
    name = case.robots[0].robot.moving_joints[0].name
    with pytest.raises(SuspectInput, match="CHECK LIMITS"):
        cl.Checker(limited(fixed_positions={name: 3.0}))
    with pytest.raises(BadInput, match="accept: 'unit' is given"):
        cl.Checker(case, accept=["unit"])


def test_another_process_is_sent_what_makes_the_same():
    case = cl.load_case("scenes/box_box/case.yaml")
    checker = cl.Checker(case, time=2.5)
    copy = pickle.loads(pickle.dumps(checker))
    at = np.zeros(len(checker.joint_names))
    assert copy.pairs == checker.pairs and str(copy.distance(at)) == str(checker.distance(at))
