"""Case files: what is in them arrives, and everything that cannot be meant is refused in one
line.
"""

import hashlib

import numpy as np
import pytest

from clearance.errors import (
    BadDimension,
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    ClearanceError,
    DuplicateName,
    EmptyMesh,
    MissingFile,
    MissingKey,
    NotFinite,
    NothingToMeasure,
    UnknownJoint,
    UnknownKey,
    UnknownLink,
    UnknownObstacle,
)
from clearance.load.case_file import load_case
from tests.load.making import ARM, CASE, cube_stl, signed_volume, write_case


def load(folder, case=CASE, **changes):
    return load_case(write_case(folder, case, **changes))


def changed(*pairs: str) -> str:
    text = CASE
    for old, new in zip(pairs[::2], pairs[1::2], strict=True):
        assert old in text
        text = text.replace(old, new)
    return text


def with_obstacle(shape: str) -> str:
    return changed("box: {size: [0.1, 0.1, 1]}", shape)


def test_a_small_case_arrives_whole(tmp_path):
    case = load(tmp_path)
    placed = case.robots[0]
    assert case.name == "small"
    assert placed.robot.link_names == ("base", "upper", "tip")
    assert placed.trajectory.positions.tolist() == [[0], [0.25], [0.5]]
    assert placed.world_from_base.tolist() == np.eye(4).tolist()
    assert (case.limits.fail, case.limits.warn) == (0.005, 0.02)
    assert [o.name for o in case.obstacles] == ["post"]
    assert case.obstacles[0].world_from_body[:3, 3].tolist() == [2, 0, 0]
    assert case.obstacles[0].body.shape.bounds[1].tolist() == [0.05, 0.05, 0.5]
    assert case.contact_response is False
    assert case.notes == ()


def test_every_file_read_is_listed_with_its_checksum(tmp_path):
    case = load(tmp_path)
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
    case = load(tmp_path, text)
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
            load(tmp_path, text, room__yaml=content)
        assert says in str(caught.value)
        assert str(caught.value).startswith("case.yaml: scene: room.yaml")


@pytest.mark.parametrize(
    ("shape", "lower", "upper"),
    [
        ("box: {size: [1, 2, 3]}", [-0.5, -1, -1.5], [0.5, 1, 1.5]),
        ("cylinder: {radius: 0.5, length: 3}", [-0.5, -0.5, -1.5], [0.5, 0.5, 1.5]),
        ("sphere: {radius: 0.5}", [-0.5] * 3, [0.5] * 3),
        (
            "pipe: {inner_radius: 0.4, outer_radius: 0.5, length: 3}",
            [-0.5, -0.5, -1.5],
            [0.5, 0.5, 1.5],
        ),
        ("mesh: {file: upper.stl}", [-0.5] * 3, [0.5] * 3),
        ("mesh: {file: upper.stl, scale: -4}", [-2] * 3, [2] * 3),
        ("mesh: {file: upper.stl, scale: [2, -4, 1.0]}", [-1, -2, -0.5], [1, 2, 0.5]),
    ],
)
def test_every_shape_becomes_a_solid_that_holds_it(tmp_path, shape, lower, upper):
    body = load(tmp_path, with_obstacle(shape)).obstacles[0].body
    assert (body.shape.bounds[0] <= lower).all() and (body.shape.bounds[1] >= upper).all()
    assert body.shape.bounds == pytest.approx(np.array([lower, upper]), abs=1.1e-4)
    assert body.shape.closed and body.shape.oriented
    assert signed_volume(body.shape) > 0


def test_sections_and_bent_pipes_reach_the_shape(tmp_path):
    straight = "pipe: {inner_radius: 0.04, outer_radius: 0.05, length: 2, sections: 8}"
    assert len(load(tmp_path, with_obstacle(straight)).obstacles[0].body.shape.vertices) == 32
    bent = (
        "pipe: {inner_radius: 0.04, outer_radius: 0.05, bend_radius: 0.2, "
        "path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}"
    )
    shape = load(tmp_path, with_obstacle(bent)).obstacles[0].body.shape
    assert shape.bounds == pytest.approx(np.array([[0, -0.05, -0.05], [1.05, 1, 0.05]]), abs=1e-3)


def test_poses_take_quaternions_or_roll_pitch_yaw(tmp_path):
    half = float(np.sqrt(0.5))
    base = f"arm.urdf, base: {{xyz: [1, 2, 3], quat_xyzw: [0, 0, {half!r}, {half!r}]}}"
    case = load(
        tmp_path, changed("arm.urdf", base, "{xyz: [2, 0, 0]}", "{rpy: [0, 0, 1.5707963267948966]}")
    )
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert case.robots[0].world_from_base[:3, :3] == pytest.approx(turned, abs=1e-15)
    assert case.robots[0].world_from_base[:3, 3].tolist() == [1, 2, 3]
    assert case.obstacles[0].world_from_body[:3, :3] == pytest.approx(turned, abs=1e-15)


def test_limits_warn_is_fail_where_it_is_left_out(tmp_path):
    assert load(tmp_path, changed(", warn: 0.02", "")).limits.warn == 0.005
    assert load(tmp_path, changed("limits: {fail: 0.005, warn: 0.02}", "")).limits.fail == 0


def test_allow_takes_wildcards_and_names(tmp_path):
    text = CASE + 'allow: [[base, "po?t"], ["up*", post]]\ncontact_response: true\n'
    with pytest.raises(NothingToMeasure, match=r"^case\.yaml: no link-obstacle pair"):
        load(tmp_path, text)
    case = load(tmp_path, text.replace(', ["up*", post]', ""))
    assert case.allow == (("base", "po?t"),)
    assert case.contact_response is True


TWO_JOINTS = ARM.replace(
    '<joint name="flange" type="fixed"><parent link="upper"/><child link="tip"/></joint>',
    '<joint name="lift" type="prismatic"><parent link="upper"/><child link="tip"/>'
    '<limit lower="0" upper="0.1"/></joint>',
)


def test_joints_that_nobody_names_are_zero_with_a_note(tmp_path):
    case = load(tmp_path, urdf=TWO_JOINTS)
    assert "stay at 0: lift" in case.notes[0]
    case = load(tmp_path, changed("arm.urdf", "arm.urdf, joints: {lift: 0.05}"), urdf=TWO_JOINTS)
    assert case.robots[0].fixed_positions == {"lift": 0.05}
    assert case.notes == ()


def test_leaving_joint_limits_is_noted_with_how_much_and_how_often(tmp_path):
    case = load(tmp_path, trajectory="time,shoulder\n0,0\n1,1.25\n2,-1.5\n")
    assert case.notes == (
        "joint 'shoulder' leaves its limits -1 to 1 rad by up to 0.5 rad in 2 of 3 steps",
    )
    case = load(tmp_path, changed("arm.urdf", "arm.urdf, joints: {lift: 0.3}"), urdf=TWO_JOINTS)
    assert "joint 'lift' leaves its limits 0 to 0.1 m by up to 0.2 m" in case.notes[0]


def test_what_looks_like_a_wrong_unit_is_noted_loudly(tmp_path):
    text = changed("fail: 0.005, warn: 0.02", "fail: 5, warn: 20", "box: {size: [0.1, 0.1, 1]}",
                   "cylinder: {radius: 40, length: 1}")  # fmt: skip
    notes = "\n".join(load(tmp_path, text, trajectory="time,shoulder\n0,0\n1,45\n").notes)
    for says in (
        "limits.fail is 5 m",
        "limits.warn is 20 m",
        "'post' has a radius of 40 m",
        "45 rad",
    ):
        assert f"CHECK UNITS: {says}" in notes or says in notes
    assert notes.count("CHECK UNITS") == 4


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("urdf: arm.urdf", "urdf: arm.urdf, base: {rpy: [0, 0, 90]}", "base has an angle of 90 rad"),
        ("urdf: arm.urdf", "urdf: arm.urdf, base: {xyz: [-1200, 0, 0]}", "base stands 1200 m away"),
        ("xyz: [2, 0, 0]", "rpy: [0, -45, 0]", "obstacle 'post' has an angle of 45 rad"),
        ("xyz: [2, 0, 0]", "xyz: [0, 0, 650]", "obstacle 'post' stands 650 m away"),
    ],
)
def test_poses_in_degrees_and_millimetres_are_noted(tmp_path, old, new, says):
    (note,) = load(tmp_path, changed(old, new)).notes
    assert note.startswith("CHECK UNITS: ") and says in note


def test_poses_at_the_edge_of_what_is_usual_are_not_noted(tmp_path):
    text = changed("urdf: arm.urdf", "urdf: arm.urdf, base: {xyz: [100, 0, 0], rpy: [6.28, 0, -6.28]}")
    assert load(tmp_path, text).notes == ()


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('xyz="0 0 0.1" rpy="0 0 0"', 'rpy="0 0 90"', "joint 'shoulder' has an angle of 90 rad"),
        ('xyz="0 0 0.5"', 'xyz="0 0 500"', "link 'upper' stands 500 m away"),
        ('"upper.stl"', '"upper.stl" scale="1000 1000 1000"', "the mesh is scaled by 1000"),
    ],
)
def test_origins_and_scales_in_other_units_are_noted(tmp_path, old, new, says):
    assert old in ARM
    (note, *_) = load(tmp_path, urdf=ARM.replace(old, new)).robots[0].robot.notes
    assert "CHECK UNITS: " in note and says in note


@pytest.mark.parametrize("turns", [1001.0, -1e7])
def test_a_joint_that_spins_between_two_samples_is_refused(tmp_path, turns):
    load(tmp_path, trajectory="time,shoulder\n0,0\n1,6283.18\n")
    way = 0.1 + turns * 6.283185307179586
    with pytest.raises(BadDimension) as caught:
        load(tmp_path, trajectory=f"time,shoulder\n0,0\n1,0.1\n2.5,{way}\n")
    told = str(caught.value)
    assert "path.csv: joint 'shoulder' turns by" in told
    assert "between 1 s and 2.5 s" in told and "\n" not in told


def test_meshes_named_twice_are_made_once(tmp_path):
    text = CASE.replace(
        "trajectory:",
        "  - {name: one, mesh: {file: upper.stl}}\n  - {name: two, mesh: {file: upper.stl}}\n"
        "  - {name: big, mesh: {file: upper.stl, scale: 2}}\ntrajectory:",
    )
    _, one, two, big = load(tmp_path, text).obstacles
    assert one.body.shape is two.body.shape
    assert one.body.shape is not big.body.shape


FAULTS = [
    (
        changed("name: small", "nmae: small"),
        UnknownKey,
        "case.yaml: unknown key 'nmae'; did you mean 'name'?",
    ),
    (changed("name: small\n", ""), MissingKey, "case.yaml: 'name' is missing"),
    (
        changed("urdf: arm.urdf", "urfd: arm.urdf"),
        UnknownKey,
        "case.yaml: robot: unknown key 'urfd'; did",
    ),
    (
        changed("xyz: [2", "xzy: [2"),
        UnknownKey,
        "case.yaml: scene.obstacles[0].pose: unknown key 'xzy'",
    ),
    (changed("{size: [", "{sizes: ["), UnknownKey, "scene.obstacles[0].box: unknown key 'sizes'"),
    (changed("    box:", "    bxo:"), UnknownKey, "did you mean 'box'?"),
    (
        changed("robot: {urdf: arm.urdf}", "robot: arm.urdf"),
        BadInput,
        "robot: 'arm.urdf' is given; a mapping",
    ),
    (changed("robot: {urdf: arm.urdf}", "robot:"), BadInput, "robot: nothing is given"),
    (changed("file: path.csv", "file: 7"), BadInput, "trajectory.file: 7 is given"),
    (changed("warn: 0.02", "warn: 0.002"), BadInput, "limits: warn 0.002 is below fail 0.005"),
    (changed("fail: 0.005", "fail: -0.005"), BadInput, "limits.fail: -0.005 is given"),
    (changed("fail: 0.005", "fail: .nan"), NotFinite, "limits.fail: nan is given"),
    (changed("fail: 0.005", "fail: .inf"), NotFinite, "limits.fail: inf is given"),
    (changed("fail: 0.005", "fail: '0.005'"), BadInput, "limits.fail: '0.005' is given"),
    (changed("fail: 0.005", "fail: true"), BadInput, "limits.fail: True is given"),
    (changed("fail: 0.005", "fail: 5 mm"), BadInput, "limits.fail: '5 mm' is given"),
    (
        changed("[2, 0, 0]", "[2, 0]"),
        BadShape,
        "scene.obstacles[0].pose.xyz: [2, 0] is given; 3 values",
    ),
    (changed("[2, 0, 0]", "[2, 0, .nan]"), NotFinite, "scene.obstacles[0].pose.xyz[2]: nan"),
    (changed("[2, 0, 0]", "[2, 0, yes]"), BadInput, "scene.obstacles[0].pose.xyz[2]: 'yes'"),
    (
        changed("xyz: [2, 0, 0]", "quat_xyzw: [0, 0, 0, 2]"),
        BadPose,
        "scene.obstacles[0].pose.quat_xyzw",
    ),
    (changed("xyz: [2, 0, 0]", "quat_xyzw: [0, 0, 0, 0]"), BadPose, "length 0"),
    (
        changed("xyz: [2, 0, 0]", "quat_xyzw: [0, 0, 0, 1], rpy: [0, 0, 0]"),
        BadInput,
        "both quat_xyzw and rpy",
    ),
    (
        changed("[0.1, 0.1, 1]", "[0.1, -0.1, 1]"),
        BadDimension,
        "scene.obstacles[0].box.size[1]: -0.1",
    ),
    (
        changed("[0.1, 0.1, 1]", "[0.1, 0, 1]"),
        BadDimension,
        "scene.obstacles[0].box.size[1]: 0 is given",
    ),
    (
        changed("    box: {size: [0.1, 0.1, 1]}\n", ""),
        BadInput,
        "scene.obstacles[0]: it has no shape",
    ),
    (
        changed("    box:", "    sphere: {radius: 1}\n    box:"),
        BadInput,
        "box and sphere are given",
    ),
    (
        with_obstacle("sphere: {radius: -1}"),
        BadDimension,
        "scene.obstacles[0].sphere.radius: -1 is given",
    ),
    (
        with_obstacle("cylinder: {radius: 1}"),
        MissingKey,
        "scene.obstacles[0].cylinder: 'length' is missing",
    ),
    (
        with_obstacle("pipe: {inner_radius: 2, outer_radius: 1, length: 1}"),
        BadDimension,
        "obstacles[0]",
    ),
    (with_obstacle("pipe: {inner_radius: 0, outer_radius: 1}"), BadDimension, "length and path"),
    (
        with_obstacle("pipe: {inner_radius: 0, outer_radius: 1, length: 1, bend_radius: 2}"),
        BadInput,
        "without path",
    ),
    (
        with_obstacle("pipe: {inner_radius: 0, outer_radius: 1, length: 1, sections: 2}"),
        BadInput,
        "sections",
    ),
    (
        with_obstacle("mesh: {file: upper.stl, scale: 0}"),
        BadDimension,
        "scene.obstacles[0].mesh.scale: 0 is",
    ),
    (with_obstacle("mesh: {file: upper.stl, scale: [1, 2]}"), BadDimension, "mesh.scale: [1, 2]"),
    (with_obstacle("mesh: {file: upper.stl, scale: '2'}"), BadDimension, "mesh.scale: '2'"),
    (
        with_obstacle("mesh: {file: no.stl}"),
        MissingFile,
        "scene: obstacles[0]: mesh: there is no file 'no.stl'",
    ),
    (
        with_obstacle("mesh: {file: path.csv}"),
        BadSyntax,
        "mesh: path.csv: unknown mesh format '.csv'",
    ),
    (with_obstacle("mesh: {file: empty.stl}"), EmptyMesh, "mesh: empty.stl: the mesh has no faces"),
    (
        changed("scene:\n", "scene:\n  obstacle: []\n"),
        UnknownKey,
        "scene: unknown key 'obstacle'; did you",
    ),
    (
        changed("trajectory: {file: path.csv}\n", ""),
        MissingKey,
        "case.yaml: 'trajectory' is missing",
    ),
    (
        changed("path.csv", "no.csv"),
        MissingFile,
        "case.yaml: trajectory.file: there is no file 'no.csv'",
    ),
    (
        changed("arm.urdf", "no.urdf"),
        MissingFile,
        "case.yaml: robot.urdf: there is no file 'no.urdf'",
    ),
    (changed("arm.urdf", "."), MissingFile, "is a folder"),
    (changed("arm.urdf", "path.csv"), BadSyntax, "case.yaml: robot.urdf: path.csv: not XML"),
    (
        changed("arm.urdf", "arm.urdf, package_dirs: [nowhere]"),
        MissingFile,
        "robot.package_dirs: [0]: there is no folder",
    ),
    (
        changed("arm.urdf", "arm.urdf, geometry: hull"),
        BadInput,
        "robot.geometry: 'hull' is given; 'collision' or",
    ),
    (
        changed("arm.urdf", "arm.urdf, exclude_links: [bass]"),
        UnknownLink,
        "robot.exclude_links: [0]: unknown link 'bass'; did you mean 'base'?",
    ),
    (
        changed("arm.urdf", "arm.urdf, exclude_links: [base, upper]"),
        NothingToMeasure,
        "no link-obstacle pair",
    ),
    (
        changed("arm.urdf", "arm.urdf, joints: {elbow: 1}"),
        UnknownJoint,
        "robot.joints: unknown joint 'elbow'",
    ),
    (changed("arm.urdf", "arm.urdf, joints: {flange: 1}"), UnknownJoint, "joint 'flange' is fixed"),
    (
        changed("arm.urdf", "arm.urdf, joints: {shoulder: 1}"),
        DuplicateName,
        "also a column of the trajectory",
    ),
    (
        changed("arm.urdf", "arm.urdf, joints: {shoulder: .nan}"),
        NotFinite,
        "robot.joints.shoulder: nan",
    ),
    (
        CASE + "allow: [[bas, post]]\n",
        UnknownLink,
        "allow[0]: unknown link 'bas'; did you mean 'base'?",
    ),
    (
        CASE + "allow: [[base, post], [base, pots]]\n",
        UnknownObstacle,
        "allow[1]: unknown obstacle 'pots'; did you mean 'post'?",
    ),
    (CASE + "allow: [['arm_*', post]]\n", UnknownLink, "no link matches 'arm_*'"),
    (CASE + "allow: [[base, 'car_*']]\n", UnknownObstacle, "no obstacle matches 'car_*'"),
    (CASE + "allow: [[post, base]]\n", UnknownLink, "the link comes first"),
    (CASE + "allow: [[base]]\n", BadShape, "allow[0]: ['base'] is given; 2 values are needed"),
    (CASE + "allow: [base, post]\n", BadInput, "allow[0]: 'base' is given"),
    (CASE + "contact_response: 1\n", BadInput, "contact_response: 1 is given"),
    (CASE + "name: again\n", DuplicateName, 'case.yaml: line 10: found duplicate key "name"'),
    (CASE + "  - [", BadSyntax, "case.yaml: line"),
    (
        "",
        BadInput,
        "case.yaml: nothing is given; a mapping is needed, with keys name, robot, scene",
    ),
    ("- 1\n", BadInput, "case.yaml: [1] is given"),
    ("a: 1\n---\nb: 2\n", BadSyntax, "another document"),
    ("a: !!python/object:os.system x", BadSyntax, "case.yaml: line 1: not YAML"),
    (
        changed("  - name: post\n", "  - {name: post, sphere: {radius: 1}}\n  - name: post\n"),
        DuplicateName,
        "obstacles[1]: two obstacles",
    ),
]


@pytest.mark.parametrize(("case", "fault", "says"), FAULTS)
def test_each_fault_is_one_line_with_its_place(tmp_path, case, fault, says):
    with pytest.raises(fault) as caught:
        load(tmp_path, case, empty__stl=bytes(84))
    assert says in str(caught.value)
    assert str(caught.value).startswith("case.yaml: ")
    assert "\n" not in str(caught.value)


def test_no_obstacles_leave_nothing_to_measure(tmp_path):
    text = (
        CASE[: CASE.index("  obstacles:")] + "  obstacles: []\n" + CASE[CASE.index("trajectory") :]
    )
    with pytest.raises(NothingToMeasure):
        load(tmp_path, text)


MIMIC = TWO_JOINTS.replace('<limit lower="0" upper="0.1"/>', '<mimic joint="shoulder"/>')


@pytest.mark.parametrize(
    ("trajectory", "urdf", "fault", "says"),
    [
        (
            "time,sholder\n0,1\n",
            ARM,
            UnknownJoint,
            "unknown joint 'sholder'; did you mean 'shoulder'?",
        ),
        (
            "time,flange\n0,1\n",
            ARM,
            UnknownJoint,
            "joint 'flange' is fixed; moving joints: shoulder",
        ),
        (
            "time,lift\n0,1\n",
            MIMIC,
            UnknownJoint,
            "joint 'lift' mimics 'shoulder' and cannot be set",
        ),
        ("time,shoulder\n0,1\n0,1\n", ARM, BadTime, "line 3"),
        ("time,shoulder\n0,nan\n", ARM, NotFinite, "line 2"),
        ("time,shoulder\n0\n", ARM, BadShape, "line 2: 1 columns; the header has 2"),
    ],
)
def test_faults_of_the_trajectory_name_case_field_and_file(tmp_path, trajectory, urdf, fault, says):
    with pytest.raises(fault) as caught:
        load(tmp_path, trajectory=trajectory, urdf=urdf)
    assert str(caught.value).startswith("case.yaml: trajectory.file: path.csv: ")
    assert says in str(caught.value)


def test_a_case_that_is_not_there(tmp_path):
    with pytest.raises(MissingFile, match=r"^there is no file 'case\.yaml'"):
        load_case(tmp_path / "case.yaml")
    (tmp_path / "case.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadSyntax, match="not UTF-8"):
        load_case(tmp_path / "case.yaml")


def test_messages_and_sources_never_hold_a_path_of_this_machine(tmp_path):
    write_case(tmp_path)
    far = ARM.replace("upper.stl", str(tmp_path / "upper.stl"))
    case = load(tmp_path, urdf=far)
    assert str(tmp_path) not in str(case.sources) + str(case.notes) + str(
        case.robots[0].robot.notes
    )
    with pytest.raises(ClearanceError) as caught:
        load(tmp_path, changed("arm.urdf", str(tmp_path / "no.urdf")))
    assert str(tmp_path) not in str(caught.value)


def test_loading_twice_gives_the_same(tmp_path):
    one, two = load(tmp_path), load(tmp_path)
    assert one.sources == two.sources
    for a, b in zip(one.robots[0].robot.bodies, two.robots[0].robot.bodies, strict=True):
        assert a.shape.vertices.tobytes() == b.shape.vertices.tobytes()
        assert a.shape.face_vertices.tobytes() == b.shape.face_vertices.tobytes()
