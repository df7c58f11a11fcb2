"""Case files: what is in them arrives. A cell given one trajectory after another is the case with each of them."""

import hashlib

import numpy as np
import pytest

from clearance.case import case_file
from clearance.case.case_file import load_case, with_trajectory_file
from clearance.errors import (
    BadDimension,
    BadInput,
    ClearanceError,
    DuplicateName,
    MissingFile,
    NothingToMeasure,
    UnknownKey,
    UnknownRobot,
)
from clearance.formats.schema.timed import TrajectoryFile
from clearance.world.pairs import measured_pairs
from clearance.world.plausibility import notices_of
from tests.formats.making import ARM, CASE, cube_stl, signed_volume, write_case
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.making_cell import load_cell


def test_every_file_read_is_listed_with_its_checksum(tmp_path):
    case = load_small(tmp_path)
    assert [source.path for source in case.sources] == [
        "arm.urdf",
        "case.yaml",
        "path.csv",
        "upper.stl",
    ]
    for source in case.sources:
        data = (tmp_path / source.path).read_bytes()
        assert (source.sha256, source.n_bytes) == (hashlib.sha256(data).hexdigest(), len(data))


def test_paths_are_relative_to_the_case_wherever_one_stands(tmp_path, monkeypatch):
    (tmp_path / "cases" / "one").mkdir(parents=True)
    (tmp_path / "robots").mkdir()
    path = write_case(tmp_path / "cases" / "one", changed("arm.urdf", "../../robots/arm.urdf"))
    for name in ("arm.urdf", "upper.stl"):
        (tmp_path / "cases" / "one" / name).rename(tmp_path / "robots" / name)
    monkeypatch.chdir(tmp_path / "robots")
    case = load_case("../cases/one/case.yaml")
    assert [s.path for s in case.sources] == [
        "../../robots/arm.urdf", "../../robots/upper.stl", "case.yaml", "path.csv",
    ]  # fmt: skip
    assert case.sources == load_case(path).sources


def test_the_scene_may_be_a_file_with_paths_of_its_own(tmp_path):
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "cube.stl").write_bytes(cube_stl())
    (tmp_path / "scenes" / "room.yaml").write_text(
        "obstacles:\n- {name: cube, mesh: {file: cube.stl, scale: 2}, pose: {rpy: [0, 0, 1e-3]}}\n"
    )
    text = (
        CASE[: CASE.index("scene:")]
        + "scene: scenes/room.yaml\n"
        + CASE[CASE.index("trajectory") :]
    )
    case = load_small(tmp_path, text)
    assert signed_volume(case.obstacles[0].body.shape) == 8
    assert case.obstacles[0].body.origin == "scenes/cube.stl"
    assert case.obstacles[0].world_from_body[1, 0] == np.sin(1e-3)
    assert "scenes/room.yaml" in [source.path for source in case.sources]


def test_faults_in_a_scene_file_name_that_file(tmp_path):
    text = CASE[: CASE.index("scene:")] + "scene: room.yaml\n" + CASE[CASE.index("trajectory") :]
    for content, fault, says in [
        ("obstacles: [{name: a, bxo: {}}]", UnknownKey, "yaml: obstacles[0]: unknown key 'bxo'"),
        ("obstacles: [{name: a, sphere: {radius: 1}}, {name: a, sphere: {radius: 1}}]",
         DuplicateName, "room.yaml: obstacles[1]: two obstacles have the name 'a'"),
        ("obstacles: [{name: a, mesh: {file: no.stl}}]", MissingFile,
         "room.yaml: obstacles[0]: mesh: there is no file 'no.stl'"),
        ("", BadInput, "room.yaml: nothing is given"),
    ]:  # fmt: skip
        with pytest.raises(fault) as caught:
            load_small(tmp_path, text, room__yaml=content)
        assert says in str(caught.value)
        assert str(caught.value).startswith("case.yaml: scene: room.yaml")


def test_poses_take_quaternions_or_roll_pitch_yaw(tmp_path):
    half = float(np.sqrt(0.5))
    base = f"arm.urdf, base: {{xyz: [1, 2, 3], quat_xyzw: [0, 0, {half!r}, {half!r}]}}"
    case = load_small(
        tmp_path,
        changed("arm.urdf", base, "{xyz: [1.2, 0, 0]}", "{rpy: [0, 0, 1.5707963267948966]}"),
    )
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert case.robots[0].world_from_base[:3, :3] == pytest.approx(turned, abs=1e-15)
    assert case.robots[0].world_from_base[:3, 3].tolist() == [1, 2, 3]
    assert case.obstacles[0].world_from_body[:3, :3] == pytest.approx(turned, abs=1e-15)


def test_limits_warn_is_fail_where_it_is_left_out(tmp_path):
    assert load_small(tmp_path, changed(", warn: 0.02", "")).limits.warn == 0.005
    assert load_small(tmp_path, changed("limits: {fail: 0.005, warn: 0.02}", "")).limits.fail == 0


def test_allow_takes_wildcards_and_names(tmp_path):
    text = CASE + 'allow: [[base, "po?t"], ["up*", post]]\ncontact_response: true\n'
    with pytest.raises(NothingToMeasure, match=r"^case\.yaml: no link-obstacle pair"):
        load_small(tmp_path, text)
    case = load_small(tmp_path, text.replace(', ["up*", post]', ""))
    assert [row.between for row in case.allow] == [("base", "po?t")]
    assert case.contact_response is True


@pytest.mark.parametrize("row", ["[post, base]", "['*', base]", "{between: [post, 'ba*']}"])
def test_allow_takes_the_obstacle_first_too(tmp_path, row):
    case = load_small(tmp_path, CASE + f"allow: [{row}]\n")
    assert case.allow[0].between[0].startswith("ba")
    assert [pair.a.name_in(case) for pair in measured_pairs(case)[0]] == ["upper"]


def test_allow_takes_a_part_before_a_link_of_several_robots(tmp_path):
    rows = "[workpiece, left/base]", "{between: [post, 'left/*'], until: 0.5}", "['*', left/tip]"
    case = load_cell(tmp_path, "allow:\n", "allow:\n  - " + "\n  - ".join(rows) + "\n")
    assert [row.between for row in case.allow[:3]] == [
        ("left/base", "workpiece"), ("left/*", "post"), ("*", "left/tip"),
    ]  # fmt: skip
    assert case.allow[1].window.end == 0.5


def test_joints_that_nobody_names_are_zero_with_a_warning(tmp_path):
    case = load_small(tmp_path, urdf=TWO_JOINTS)
    assert "stays at 0: 'lift'" in notices_of(case)[0].text
    case = load_small(
        tmp_path, changed("arm.urdf", "arm.urdf, joints: {lift: 0.05}"), urdf=TWO_JOINTS
    )
    assert case.robots[0].fixed_positions == {"lift": 0.05}
    assert case.notes == notices_of(case) == ()


@pytest.mark.parametrize("turns", [1001.0, -1e7])
def test_a_joint_that_spins_between_two_samples_is_refused(tmp_path, turns):
    load_small(tmp_path, trajectory="time,shoulder\n0,0\n1,6283.18\n")
    way = 0.1 + turns * 6.283185307179586
    with pytest.raises(BadDimension) as caught:
        load_small(tmp_path, trajectory=f"time,shoulder\n0,0\n1,0.1\n2.5,{way}\n")
    told = str(caught.value)
    assert "path.csv: joint 'shoulder' turns by" in told
    assert "between 1 s and 2.5 s" in told


def test_messages_and_sources_never_hold_a_path_of_this_machine(tmp_path):
    write_case(tmp_path)
    far = ARM.replace("upper.stl", str(tmp_path / "upper.stl"))
    case = load_small(tmp_path, urdf=far)
    assert str(tmp_path) not in str(case.sources) + str(case.notes) + str(
        case.robots[0].robot.notes
    )
    with pytest.raises(ClearanceError) as caught:
        load_small(tmp_path, changed("arm.urdf", str(tmp_path / "no.urdf")))
    assert str(tmp_path) not in str(caught.value)


CELL = CASE.replace("trajectory: {file: path.csv}\n", "")


@pytest.fixture
def folder(tmp_path):
    write_case(tmp_path, CASE)
    (tmp_path / "cell.yaml").write_text(CELL)
    return tmp_path


def asked(text: str = "path.csv") -> TrajectoryFile:
    return TrajectoryFile(file=text)


def test_a_cell_with_a_trajectory_is_the_case_with_it(folder):
    case, cell = load_case(folder / "case.yaml"), case_file.load_cell(folder / "cell.yaml")
    made = with_trajectory_file(cell, asked(), case.name)
    assert (made.name, made.limits, made.notes, made.notices) == (
        case.name, case.limits, case.notes, case.notices)  # fmt: skip
    assert {s.path for s in made.sources} == {
        s.path.replace("case.yaml", "cell.yaml") for s in case.sources}  # fmt: skip
    one, other = made.robots[0].given_trajectory, case.robots[0].given_trajectory
    assert one.joint_names == other.joint_names and (one.positions == other.positions).all()


def test_what_is_wrong_with_one_trajectory_is_told_with_its_file(folder):
    cell = case_file.load_cell(folder / "cell.yaml")
    with pytest.raises(MissingFile, match=r"cell\.yaml: trajectory\.file: .*gone\.csv"):
        with_trajectory_file(cell, asked("gone.csv"), "gone")


def test_a_robot_that_has_a_trajectory_is_given_no_other(folder):
    with pytest.raises(BadInput, match="gives a trajectory to the robot itself"):
        with_trajectory_file(case_file.load_cell(folder / "case.yaml"), asked(), "other")


def test_an_unknown_robot_is_named(folder):
    with pytest.raises(UnknownRobot, match="no one robot 'nobody'"):
        with_trajectory_file(case_file.load_cell(folder / "cell.yaml"), asked(), "one", "nobody")
