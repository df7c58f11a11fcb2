"""Keyframes of MJCF as states of a robot by name: where joints rest, and what a motion goes between."""

import mujoco
import numpy as np
import pytest

from clearance import check, load_case
from clearance.cli import run
from clearance.errors import BadSyntax, MissingKey, NotFinite, UnknownState
from clearance.world.case import PlacedRobot
from clearance.world.kinematics import link_poses
from tests.formats.making_case import changed, load_small
from tests.formats.making_mjcf import BALL, JOINTED, load_mjcf, mjcf, write_mjcf


def keys(*rows: str) -> str:
    return f"<keyframe>{''.join(rows)}</keyframe>"


ARM = mjcf(
    f'<body name="a"><joint name="j" range="-90 90"/>{BALL}<body name="b" pos="1 0 0"><joint name="k" '
    f'type="slide"/>{BALL}</body></body>',
    keys('<key name="home" qpos="0.5 0.25" ctrl="1 2 3" act="1"/>', '<key qpos="0 1"/>'),
)
PATH = "time,j\n0,0\n1,0.5\n"


def load(folder, joints, text=ARM):
    case = changed("urdf: arm.urdf", f"urdf: toy.xml, joints: {{{joints}}}")
    return load_small(folder, case, trajectory=PATH, toy__xml=text)


def test_joints_rest_where_a_keyframe_says_and_a_note_says_so(tmp_path):
    case = load(tmp_path, "state: home")
    assert case.robots[0].fixed_positions == {"k": 0.25}
    said = "toy.xml: by state 'home' rest k 0.25; the case or the trajectory says more of j"
    assert said in case.notes
    assert load(tmp_path, "state: key1").robots[0].fixed_positions == {"k": 1.0}
    assert load(tmp_path, "state: home, k: 0.1").robots[0].fixed_positions == {"k": 0.1}


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        (ARM, UnknownState, "joints.state: toy.xml: unknown state 'hme'; did you mean 'home'"),
        (mjcf(f'<body><joint name="j"/>{BALL}</body>'), MissingKey, "state 'hme' is in no file"),
        (ARM.replace("0.5 0.25", "0.5 1 2"), BadSyntax, "toy.xml: MuJoCo refuses it: .*qpos"),
        (ARM.replace("0.5 0.25", "0.5 nan"), NotFinite, "qpos='0.5 nan'"),
    ],
)
def test_what_is_no_state_is_one_line(tmp_path, text, fault, says):
    with pytest.raises(fault, match=says) as caught:
        load(tmp_path, "state: hme", text)
    assert "\n" not in str(caught.value)


TURNS = [
    (1, 0, 0, 0), (0, 1, 0, 0), (0.5, 0.5, 0.5, 0.5), (0.5, -0.5, 0.5, 0.5), (0.1, 0.2, -0.3, 0.9),
    (2, 1, 0, 0), (0.7071, 0, 0.7071, 0), (0.7071, 0, -0.7071, 1e-9), (0, 0, 0, 0), (0.6, 0, 0.8, 0),
]  # fmt: skip


@pytest.mark.parametrize("turn", TURNS)
def test_bodies_are_where_mujoco_has_them_in_a_keyframe(tmp_path, turn):
    """Slides, hinges with a reference, a ball and a free joint, turned anyhow, also where yaw and roll are one."""
    quaternion = " ".join(map(str, turn))
    qpos = f"0.3 -0.2 0.7 {quaternion} 1 -2 3 {quaternion} 0.4 -0.5"
    text = JOINTED.replace(
        "<worldbody>", f'{keys(f"""<key name="k" qpos="{qpos}"/>""")}<worldbody>'
    )
    robot = load_mjcf(tmp_path, text)
    model = mujoco.MjModel.from_xml_path(str(write_mjcf(tmp_path, text)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    state = robot.states["k"]
    assert list(state) == [joint.name for joint in robot.moving_joints]
    poses = link_poses(PlacedRobot(robot), np.array([list(state.values())]))[0]
    for i in range(model.nbody):
        ours = poses[robot.link_names.index(model.body(i).name or f"body{i}")]
        assert np.abs(ours[:3, 3] - data.xpos[i]).max() < 1e-8
        assert np.abs(ours[:3, :3] - data.xmat[i].reshape(3, 3)).max() < 1e-8


def test_a_new_case_moves_between_keyframes_and_rests_in_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_mjcf(tmp_path, ARM)
    (tmp_path / "path.csv").write_text(PATH)
    (tmp_path / "scene.yaml").write_text("obstacles: [{name: b, sphere: {radius: 0.1}}]\n")
    robot = ["--robot", "toy.xml", "--scene", "scene.yaml"]
    assert run(["new", "out", *robot, "--states", "home,key1"]) == 0
    text = (tmp_path / "out" / "trajectory.csv").read_text()
    assert text == "time,j,k\n0.0,0.5,0.25\n2.0,0.0,1.0\n"
    words = [*robot, "--trajectory", "path.csv", "--force"]
    assert run(["new", "out", *words]) == 0
    said = "# state: home  # where a state says; there are [home, key1]"
    assert said in (tmp_path / "out" / "case.yaml").read_text()
    assert run(["new", "out", *words, "--rest", "home"]) == 0
    assert "state: home" in (tmp_path / "out" / "case.yaml").read_text()


LOWERED = mjcf(
    '<body name="a" pos="0.1 0 1" euler="0 0 90"><freejoint name="root"/>'
    f'<geom size="0.1"/><body name="b" pos="1 0 0"><joint name="j" ref="20"/>{BALL}</body></body>',
)
"""A ball 1 m up, a quarter turn about z, and another on a hinge that is at 20 degrees as it is written."""
ONLY_X = "time,root/x\n0,0.1\n1,0.6\n"


def new_of(tmp_path, monkeypatch, text, path):
    monkeypatch.chdir(tmp_path)
    write_mjcf(tmp_path, text)
    (tmp_path / "path.csv").write_text(path)
    (tmp_path / "scene.yaml").write_text(
        "obstacles: [{name: post, box: {size: [4, 4, 0.2]}, pose: {xyz: [0, 0, 0.7]}}]\n"
    )
    words = ["new", "out", "--robot", "toy.xml", "--scene", "scene.yaml", "--trajectory"]
    assert run([*words, "path.csv"]) == 0
    return load_case(tmp_path / "out" / "case.yaml")


def test_a_new_case_places_a_free_body_where_the_model_has_it(tmp_path, monkeypatch, capsys):
    """The ball's centre is 1 m up, so its lowest point is 100 mm above a slab whose top is at 0.8 m."""
    case = new_of(tmp_path, monkeypatch, LOWERED, ONLY_X)
    rest = case.robots[0].fixed_positions
    assert rest["root/z"] == 1.0 and rest["root/yaw"] == pytest.approx(np.pi / 2)
    assert rest["root/y"] == 0.0 and rest["j"] == pytest.approx(np.radians(20))
    assert check(case, need="minimum").worst["clearance"] == pytest.approx(0.1, abs=2e-4)
    said = (
        "joints that nothing moves rest where the robot's file has them: root/z 1, root/yaw 1.5708"
    )
    assert said in capsys.readouterr().out
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert "root/z: 1.0  # assumed: nothing moves it, and so the robot's file has it" in text
