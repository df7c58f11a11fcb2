"""Dumps of ROS's trajectory messages: exact numbers, which message is meant, and the line of every fault."""

import json
from io import BytesIO

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import check
from clearance.cli import run
from clearance.errors import (
    BadInput,
    BadShape,
    BadSyntax,
    BadTime,
    ClearanceError,
    DuplicateName,
    MissingKey,
    NotFinite,
    UnknownJoint,
    UnknownKey,
)
from clearance.formats.motion.trajectory_file import (
    Choice,
    TrajectoryRequest,
    parse_trajectory,
    read_trajectory,
)
from tests.examples import examples, some_slow
from tests.formats.making import write_case
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.making_messages import (
    JOINTS,
    MESSAGE,
    POINTS,
    ROS1,
    ROS2,
    display_trajectory,
    dumped,
    robot_trajectory,
    with_points,
)

GOAL = {"goal_id": {"uuid": [1, 2]}, "goal": {"trajectory": MESSAGE, "path_tolerance": []}}
ALL_FORMS = {
    "ros2": ROS2,
    "ros1": ROS1,
    "JointTrajectory": dumped(MESSAGE),
    "RobotTrajectory": dumped(robot_trajectory()),
    "DisplayTrajectory": dumped(display_trajectory(robot_trajectory())),
    "FollowJointTrajectory": dumped(GOAL),
    "ExecuteTrajectory": dumped({"goal": {"trajectory": robot_trajectory()}}),
    "anchors": dumped(MESSAGE).replace("[0.1, 0.0]", "&a [0.1, 0.0]"),
}
SECOND = with_points({"positions": [0.0, 0.0], "time_from_start": 0.0})


def parse(text: str, name: str = "path.yaml", which: int | None = None):
    return parse_trajectory(text.encode(), name, Choice(which))


def names_of(text: str) -> list[str]:
    return ["path.yaml", "path.yml"] + (["path.json"] if text.startswith("{") else [])


@pytest.mark.parametrize("form", ALL_FORMS)
def test_every_form_gives_the_same_numbers(form):
    text = ALL_FORMS[form]
    for name in names_of(text) if form != "anchors" else ["path.yaml"]:
        read = parse(text, name)
        assert read.joint_names == ("shoulder", "lift")
        assert read.times.tolist() == [0.0, 1.1]
        assert read.positions.tolist() == [[0.1, 0.0], [0.30000000000000004, 0.05]]
        assert read.velocities.tolist() == [[0.0, -0.001], [0.5, 0.25]]


def test_without_velocities_there_are_none():
    points = [{key: point[key] for key in ("positions", "time_from_start")} for point in POINTS]
    assert parse(dumped(with_points(*points))).velocities is None
    assert parse(dumped(with_points(*[{**p, "velocities": []} for p in points]))).velocities is None


def test_times_as_people_write_them_by_hand():
    """Without nanoseconds, which is told, and with a point behind whole seconds."""
    document = {**MESSAGE, "points": [
        {"positions": [0, 0], "time_from_start": {"secs": 0.0, "nsecs": 5}},
        {"positions": [0, 0], "time_from_start": {"sec": 2}},
    ]}  # fmt: skip
    data = dumped(document).encode()
    trajectory, notes = read_trajectory(
        TrajectoryRequest(lambda: BytesIO(data), len(data)), "path.json"
    )
    assert trajectory.times.tolist() == [5e-9, 2.0]
    assert "path.json: 1 times are seconds without nanoseconds, which are taken as 0" in notes


def test_seconds_and_nanoseconds_are_the_nearest_double():
    points = [
        {"positions": [0, 0], "time_from_start": {"sec": 0, "nanosec": 300_000_000}},
        {"positions": [0, 0], "time_from_start": {"sec": 1_700_000_000, "nanosec": 123_456_789}},
    ]
    assert parse(dumped(with_points(*points))).times.tolist() == [0.3, 1_700_000_000.123456789]


@pytest.mark.parametrize(
    "text",
    [
        ROS2 + dumped(SECOND) + "\n---\n",
        dumped(display_trajectory(robot_trajectory(), robot_trajectory(SECOND))),
        dumped([MESSAGE, SECOND]),
    ],
)
def test_of_several_one_is_chosen(text):
    assert parse(text, which=1).n_steps == 2
    assert parse(text, which=2).n_steps == 1
    with pytest.raises(BadInput, match=r"^path.yaml: the file holds 2 trajectories: 1: .*which: 1"):
        parse(text)
    with pytest.raises(BadInput, match=r"which is 3, the file holds 2: .*a number from 1 to 2"):
        parse(text, which=3)


def test_the_list_says_where_each_is():
    with pytest.raises(BadInput) as caught:
        parse(ROS2 + "---\n" + dumped(SECOND))
    told = "1: line 1, 2 points of 2 joints; 2: line 34, 1 points of 2 joints"
    assert told in str(caught.value)
    with pytest.raises(BadInput, match="; and 12 more"):
        parse(dumped([MESSAGE] * 20))


def test_messages_without_points_are_not_meant():
    assert parse(dumped([with_points(), MESSAGE])).n_steps == 2
    with pytest.raises(BadShape, match="the trajectory has no points"):
        parse(dumped(with_points()))


POINT = POINTS[0]
LATER = {**POINT, "time_from_start": 2.0}


def point(**fields: object) -> str:
    return dumped(with_points({**POINT, **fields}))


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ("", BadShape, "path.yaml: the file is empty"),
        ("---\n---\n", BadShape, "the file is empty"),
        ("- 1\n", MissingKey, "a list of 1 is not a message; a message with joint_names and points"),
        ("a: 1\nb: 2\n", MissingKey, "there is no trajectory under the keys 'a', 'b'"),
        ("joint_name: [a]\npoints: []\n", MissingKey, "no 'joint_names'; did you mean 'joint_name'?"),
        ("a: [1\n", BadSyntax, "line 2: not YAML"),
        ("a: 1\na: 2\n", DuplicateName, "line 2: key 'a' is there twice"),
        ("a: !!python/object/apply:os.system [ls]\n", BadSyntax, "line 1: the tag "),
        ("a: !!binary aGk=\n", BadSyntax, "the tag "),
        ("a: *b\n", BadSyntax, "line 1: *b refers to nothing before it"),
        ("a: &b [*b]\n", BadSyntax, "line 1: *b refers to nothing before it"),
        ("? [a]\n: 1\n", BadSyntax, "line 1: a key is not plain text"),
        ("[" * 33 + "]" * 33, BadSyntax, "nested too deep; 32 levels"),
        ("[" * 100_000, BadSyntax, "brackets are nested too deep"),
        (ROS2.replace("- shoulder", "- 7"), BadSyntax, "line 1: joint_names: [0]: 7 is given"),
        (ROS2.replace("- lift", "- shoulder"), DuplicateName, "joint 'shoulder' is there twice"),
        (ROS2.replace("  - 0.05\n", ""), BadShape, "line 21: points[1]: positions: 1 positions; there are 2"),
        (ROS2.replace("  - 0.05\n", "  - x\n"), BadSyntax, "line 21: points[1]: positions[1]: 'x' is"),
        (ROS2.replace("  - 0.05\n", "  - '...'\n"), BadSyntax, "ros2 topic echo --full-length"),
        (ROS2.replace("  - 0.05\n", "  - .nan\n"), NotFinite, "positions[1]: nan is given"),
        (ROS2.replace("  - 0.05\n", "  - -inf\n"), NotFinite, "positions[1]: -inf is given"),
        (ROS2.replace("  - 0.05\n", "  - 1_0\n"), BadSyntax, "'1_0' is given"),
        (ROS2.replace("  - 0.05\n", "  - 1e999\n"), NotFinite, "positions[1]: inf is given"),
        (ROS2.replace("    sec: 1\n", "    sec: -1\n"), BadTime, "line 21: points[1]: time_from_start: time -0.9"),
        (ROS2.replace("    sec: 1\n", ""), BadTime, "a mapping of 'nanosec' is given"),
        (ROS2.replace("    nanosec: 100000000\n", "    nanosec: 1000000000\n"), BadTime, "fewer than 1e9"),
        (point(velocity=[1, 2]), UnknownKey, "unknown key 'velocity'; did you mean 'velocities'?"),
        (point(positions=[]), MissingKey, "'positions' is missing or empty"),
        (point(positions=3), BadSyntax, "positions: 3 is given; a list of numbers"),
        (point(positions=[True, 1]), BadSyntax, "positions[0]: 'true' is given"),
        (point(time_from_start="soon"), BadTime, "time_from_start: 'soon' is given"),
        (point(time_from_start={"sec": 0.5, "nanosec": 0}), BadTime, "whole"),
        (dumped(with_points(POINT, POINT)), BadTime, "points[1]: time_from_start: time 0.0 follows 0.0"),
        (dumped(with_points("...")), BadSyntax, "points[0]: '...' is given; all values; ros2 topic echo"),
        (dumped(with_points(POINT, {**LATER, "velocities": []})), BadShape, "point 1 has no velocities"),
        (dumped({**MESSAGE, "points": 3}), BadSyntax, "points: 3 is given; a list of points"),
        (dumped({**MESSAGE, "joint_names": []}), BadShape, "there is no joint"),
        (dumped({**MESSAGE, "joint_names": "a"}), BadSyntax, "'a' is given; a list of joint names"),
        (dumped(robot_trajectory(n_other=2)), BadInput, "2 points of joints with several degrees"),
        (dumped(robot_trajectory(with_points(), 1)), BadInput, "multi_dof_joint_trajectory: 1 points"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_its_place(text, fault, says):
    with pytest.raises(fault) as caught:
        parse(text)
    told = str(caught.value)
    assert says in told
    assert told.startswith("path.yaml: ") and "\n" not in told


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ('{"a": 1,}', BadSyntax, "path.json: line 1: not JSON"),
        ('{"a": 1, "b": 2, "a": 3}', DuplicateName, "key 'a' is there twice"),
        ('{"a":' * 40 + "1" + "}" * 40, MissingKey, "no trajectory"),
        ('{"a":' * 100_000, BadSyntax, "brackets are nested too deep"),
        (dumped(with_points({**POINT, "positions": [float("nan"), 0]})), NotFinite, "nan is given"),
        (dumped(MESSAGE).replace("1.1", "9" * 5000), NotFinite, "inf is given"),
    ],
)
def test_faults_of_json(text, fault, says):
    with pytest.raises(fault) as caught:
        parse(text, "path.json")
    assert says in str(caught.value)


def test_aliases_make_no_more_of_a_file_than_it_holds():
    many = "a: &a [1]\n" + "".join(f"b{i}: x\n" for i in range(3))
    wide = "joint_names: &n [" + ", ".join(f"j{i}" for i in range(200)) + "]\npoints:\n"
    wide += (
        "- &p {positions: &v [" + ", ".join("0" for _ in range(200)) + "], time_from_start: 0}\n"
    )
    with pytest.raises(BadShape, match="aliases repeat more than the file holds"):
        parse(wide + "- *p\n" * 1000)
    doubled = "t0: &t0 {trajectory: []}\n" + many
    doubled += "".join(
        f"t{i}: &t{i} {{trajectory: [{', '.join([f'*t{i - 1}'] * 9)}]}}\n" for i in range(1, 10)
    )
    with pytest.raises(BadShape, match="aliases repeat more"):
        parse(doubled + "trajectory: *t9\n")
    lists = "t0: &t0 []\n" + "".join(f"t{i}: &t{i} [*t{i - 1}, *t{i - 1}]\n" for i in range(1, 28))
    with pytest.raises(BadShape, match="aliases repeat more"):
        parse(lists + "trajectory: *t27\n")
    with pytest.raises(BadSyntax, match=r"joint_names: \[0\]: a list of 2 is given"):
        parse(lists + "joint_names: *t27\npoints: []\n".replace("[]", "[{}]"))
    nested = "t0: &t0 []\n" + "".join(f"t{i}: &t{i} [*t{i - 1}]\n" for i in range(1, 3000))
    with pytest.raises(BadShape, match="aliases nest deeper than the file"):
        parse(nested + "trajectory: *t2999\n")


def test_long_files_are_refused_unread():
    with pytest.raises(
        BadSyntax, match="more than 16,000,000 bytes; a longer trajectory goes as CSV"
    ):
        parse("#" * 16_000_001)


@pytest.mark.parametrize("form", ["ros2", "ros1", "RobotTrajectory", "DisplayTrajectory"])
@pytest.mark.parametrize("suffix", some_slow(["yaml", "json"], {"yaml"}))
def test_a_file_cut_off_anywhere_is_refused_in_one_line_or_is_shorter(form, suffix):
    data = ALL_FORMS[form].encode()
    whole = parse_trajectory(data, "path.yaml")
    for end in range(len(data)):
        try:
            read = parse_trajectory(data[:end], f"path.{suffix}")
        except BadInput as error:
            assert str(error).startswith(f"path.{suffix}: ") and "\n" not in str(error)
        else:
            assert read.n_steps <= whole.n_steps


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ["joint_names", "points", "positions", "velocities", "time_from_start", "sec"]
                + [
                    "nanosec",
                    "trajectory",
                    "joint_trajectory",
                    "multi_dof_joint_trajectory",
                    "goal",
                ]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=20,
)


@pytest.mark.slow
@examples(300)
@given(VALUES)
def test_any_message_is_read_or_refused(message):
    text = json.dumps(message)
    for name in ("path.yaml", "path.json"):
        try:
            parse(text, name)
        except ClearanceError as error:
            assert "\n" not in str(error)


@examples(300)
@given(st.data())
def test_any_damage_is_read_or_refused(data):
    text = bytearray(ROS2.encode())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text) - 1))
        end = at + data.draw(st.integers(0, 9))
        text[at:end] = data.draw(
            st.binary(max_size=4) | st.sampled_from([b"- ", b": ", b"&a ", b"*a", b"!"])
        )
    for name in ("path.yaml", "path.json"):
        try:
            parse_trajectory(bytes(text), name)
        except ClearanceError as error:
            assert "\n" not in str(error)


def as_case(folder, text: str, given: str = "file: path.yaml", suffix: str = "yaml"):
    case = changed("file: path.csv", given)
    return load_small(folder, case, urdf=TWO_JOINTS, **{f"path__{suffix}": text})


def test_a_case_takes_it_in_place_of_its_table(tmp_path):
    rows = "time,shoulder,lift,shoulder/velocity,lift/velocity\n0,0.1,0,0,-0.001\n"
    rows += "1.1,0.30000000000000004,0.05,0.5,0.25\n"
    table = check(load_small(tmp_path, urdf=TWO_JOINTS, trajectory=rows))
    message = check(as_case(tmp_path, ROS2))
    assert (message.record.clearances == table.record.clearances).all()
    assert as_case(tmp_path, dumped([SECOND, MESSAGE]), "file: path.json, which: 2", "json")


def test_what_is_left_out_is_told(tmp_path):
    points = [{**point, "accelerations": [0, 1], "effort": [1, 2]} for point in POINTS]
    points[0]["time_from_start"] = 0.25
    notes = as_case(tmp_path, dumped(with_points(*points))).notes
    assert "path.yaml: joints move on the quintics through positions, velocities and" in str(notes)
    assert "path.yaml: effort is not read" in notes
    assert (
        "path.yaml: the first point is at 0.25 s; how the robot gets there is not in the file"
        in notes
    )


def test_degrees_are_suspect(tmp_path):
    moves = [{"positions": [90.0 * i, 0], "time_from_start": i} for i in range(3)]
    case = as_case(tmp_path, dumped(with_points(*moves)))
    run = check(case)
    assert any("is this degrees?" in notice.text for notice in run.record.notices)


def test_joints_are_held_against_the_robot(tmp_path):
    text = dumped({**MESSAGE, "joint_names": [JOINTS[0], "lifft"]})
    with pytest.raises(
        UnknownJoint, match=r"path.yaml: unknown joint 'lifft'; did you mean 'lift'"
    ):
        as_case(tmp_path, text)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("file: path.csv, which: 1", "path.csv: 'which' says nothing about a CSV table"),
        ("file: path.yaml, which: 0", "trajectory.which: 0 is given; greater than or equal to 1"),
        ("file: path.yaml, wich: 1", "unknown key 'wich'; did you mean 'which'?"),
        ("file: path.yaml, which: ", "trajectory.which: nothing is given"),
        ("file: path.yaml", "path.yaml: line 1: joint_names: [0]: 1 is given"),
    ],
)
def test_the_command_line_says_it_in_one_line(tmp_path, capsys, given, says):
    case = changed("file: path.csv", given)
    text = dumped({**MESSAGE, "joint_names": [1, 2]})
    path = write_case(tmp_path, case, urdf=TWO_JOINTS, path__yaml=text)
    assert run(["check", str(path)]) == 2
    told = capsys.readouterr().err.strip()
    assert says in told and told.count("\n") == 0
