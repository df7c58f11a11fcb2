"""Dumps of ROS's trajectory messages: exact numbers, which message is meant, and the line of every fault."""

from io import BytesIO

import pytest

from clearance.errors import (
    BadInput,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingKey,
    NotFinite,
    UnknownKey,
)
from clearance.formats.motion.requests import TrajectoryRequest, parse_trajectory, read_trajectory
from clearance.formats.schema.timed import Choice
from tests.formats.making_messages import (
    MESSAGE,
    POINTS,
    ROS1,
    ROS2,
    display_trajectory,
    dumped,
    robot_trajectory,
    with_points,
)
from tests.formats.refusal import refusal

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
    return parse_trajectory(text.encode(), name, Choice.model_construct(which=which))


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


def test_a_message_begins_at_its_stamp_if_it_has_one():
    stamped = parse(ROS2)
    assert stamped.began == 12.0000005 and stamped.is_message
    assert (
        parse(ROS2.replace("sec: 12", "sec: 0").replace("nanosec: 500", "nanosec: 0")).began is None
    )


def test_times_as_people_write_them_by_hand():
    """Without nanoseconds, which is told, and with a point behind whole seconds."""
    document = {**MESSAGE, "points": [
        {"positions": [0, 0], "time_from_start": {"secs": 0.0, "nsecs": 5}},
        {"positions": [0, 0], "time_from_start": {"sec": 2}},
    ]}  # fmt: skip
    data = dumped(document).encode()
    trajectory, notes = read_trajectory(TrajectoryRequest(lambda: BytesIO(data)), "path.json")
    assert trajectory.times.tolist() == [5e-9, 2.0]
    assert "path.json: 1 times are seconds without nanoseconds, which are taken as 0" in notes


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
    told = "1: line 1, 2 points of 2 joints; 2: line 34, 1 points of 2 joints"
    assert told in refusal(parse, ROS2 + "---\n" + dumped(SECOND), of=BadInput)
    assert "; and 12 more" in refusal(parse, dumped([MESSAGE] * 20), of=BadInput)


def test_messages_without_points_are_not_meant():
    assert parse(dumped([with_points(), MESSAGE])).n_steps == 2
    assert "the trajectory has no points" in refusal(parse, dumped(with_points()), of=BadShape)


POINT = POINTS[0]
LATER = {**POINT, "time_from_start": 2.0}


def point(**fields: object) -> str:
    return dumped(with_points({**POINT, **fields}))


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ("", BadShape, "path.yaml: the file is empty"),
        ("- 1\n", MissingKey, "a list of 1 is not a message; a message with joint_names and points"),
        ("{}", MissingKey, "there is no trajectory in an empty message"),
        ("header: {}\nname: [a]\nposition: [0.0]\n---\n", MissingKey, "this is a JointState, as a robot reports "
         "its joints; a bag of them (ros2 bag record), or a CSV"),
        ("joint_name: [a]\npoints: []\n", MissingKey, "no 'joint_names'; did you mean 'joint_name'?"),
        ("[" * 100_000, BadSyntax, "brackets are nested too deep"),
        (ROS2.replace("- shoulder", "- 7"), BadSyntax, "line 1: joint_names: [0]: 7 is given"),
        (ROS2.replace("  - 0.05\n", ""), BadShape, "line 21: points[1]: positions: 1 positions; there are 2"),
        (ROS2.replace("  - 0.05\n", "  - x\n"), BadSyntax, "line 21: points[1]: positions[1]: 'x' is"),
        (ROS2.replace("  - 0.05\n", "  - .nan\n"), NotFinite, "positions[1]: nan is given"),
        (ROS2.replace("    sec: 1\n", ""), BadTime, "a mapping of 'nanosec' is given"),
        (point(positions=[]), MissingKey, "'positions' is missing or empty"),
        (dumped(with_points(POINT, POINT)), BadTime, "points[1]: time_from_start: time 0.0 follows 0.0"),
        (dumped(with_points("...")), BadSyntax, "points[0]: '...' is given; all values; ros2 topic echo"),
        (dumped(with_points(POINT, {**LATER, "velocities": []})), BadShape, "point 1 has no velocities"),
        (dumped({**MESSAGE, "header": {"frame_di": "a"}}), UnknownKey, "header: unknown field 'frame_di'"),
        (dumped({**MESSAGE, "joint_names": []}), BadShape, "there is no joint"),
        (dumped(robot_trajectory(n_other=2)), BadInput, "2 points of joints with several degrees"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_its_place(text, fault, says):
    told = refusal(parse, text, of=fault)
    assert says in told and told.startswith("path.yaml: ")


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ('{"a": 1,}', BadSyntax, "path.json: line 1: not JSON"),
        ('{"a": 1, "b": 2, "a": 3}', DuplicateName, "key 'a' is there twice"),
        ('{"a":' * 100_000, BadSyntax, "brackets are nested too deep"),
        (dumped(with_points({**POINT, "positions": [float("nan"), 0]})), NotFinite, "nan is given"),
    ],
)
def test_faults_of_json(text, fault, says):
    assert says in refusal(parse, text, "path.json", of=fault)


@pytest.mark.slow
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
    assert "aliases repeat more" in refusal(parse, doubled + "trajectory: *t9\n", of=BadShape)
    lists = "t0: &t0 []\n" + "".join(f"t{i}: &t{i} [*t{i - 1}, *t{i - 1}]\n" for i in range(1, 28))
    assert "aliases repeat more" in refusal(parse, lists + "trajectory: *t27\n", of=BadShape)
    with pytest.raises(BadSyntax, match=r"joint_names: \[0\]: a list of 2 is given"):
        parse(lists + "joint_names: *t27\npoints: []\n".replace("[]", "[{}]"))
    nested = "t0: &t0 []\n" + "".join(f"t{i}: &t{i} [*t{i - 1}]\n" for i in range(1, 3000))
    with pytest.raises(BadShape, match="aliases nest deeper than the file"):
        parse(nested + "trajectory: *t2999\n")
