"""MJCF as a robot: which links are measured against one another, and its keyframes as states."""

import itertools
import re

import mujoco
import numpy as np
import pytest

import clearance as cl
from clearance import check, load_case
from clearance.cli import run
from clearance.errors import BadSyntax, MissingKey, NotFinite, UnknownState
from clearance.formats.robot.mjcf.robot import BITS, EXCLUDE, PARENT
from clearance.world.collision_matrix import ADJACENT
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from clearance.world.self_pairs import RIGID, self_pairs
from tests.formats.making_case import changed, load_small
from tests.formats.making_mjcf import BALL, JOINTED, load_mjcf, mjcf, write_mjcf
from tests.formats.refusal import refusal
from tests.made_cases import at

JOINT = '<joint type="slide"/>'
JOINTS = JOINT + '<joint type="slide" axis="1 0 0"/>'


def why(robot):
    """By pair of links why it is not measured, or None."""
    return {f"{one.link_a} {one.link_b}": one.excused for one in self_pairs(robot)}


def body(name, inside="", *, joint=JOINT, geom=BALL):
    return f'<body name="{name}">{joint}{geom}{inside}</body>'


CHAIN = body("a", body("b", body("c")))
NO_PARENTS = '<option timestep="0.001"><flag contact="enable" filterparent="disable"/></option>'
SILENT = '<geom name="{}" size="0.1" contype="0" conaffinity="0"/>'
NESTED = body(
    "a",
    body("b", body("c", geom=SILENT.format("c")), geom=SILENT.format("b")),
    geom=SILENT.format("a"),
)
ASKED = '<contact><pair geom1="b" geom2="a"/><exclude body1="a" body2="b"/></contact>'
HAND = body("hand", body("camera", joint="") + body("finger") + body("eye", joint=JOINTS))
THREE = "".join(
    body(name, geom=f'<geom size="0.1" contype="{kind}" conaffinity="{meets}"/>')
    for name, kind, meets in (("a", 1, 0), ("b", 2, 1), ("c", 4, 8))
)
ON_FLOOR = '<geom type="plane" size="1 1 1"/>' + body("seen", geom=SILENT.format("s"))
ON_FLOOR += body("high", geom='<geom size="0.1" contype="2" conaffinity="2"/>') + body("low")


@pytest.mark.parametrize(
    ("model", "found", "told"),
    [
        (mjcf(CHAIN), {"a b": ADJACENT, "a c": None, "b c": ADJACENT}, []),
        (mjcf(CHAIN, NO_PARENTS), {"a b": None, "a c": None, "b c": None}, []),
        (mjcf(HAND), {"hand camera": RIGID, "hand finger": ADJACENT, "hand eye": PARENT, "camera finger": PARENT,
                      "camera eye": PARENT, "finger eye": None},
         [f"leaves out ({PARENT}): hand - eye, camera - finger, camera - eye"]),
        # nothing that collides is left of c
        (mjcf(NESTED, ASKED), {"a b": None}, ["measures, as <pair> says: a - b"]),
        (mjcf(THREE, '<contact><exclude body1="b" body2="a"/></contact>'),
         {"a b": EXCLUDE, "a c": BITS, "b c": BITS},
         [f"leaves out ({EXCLUDE}): a - b", f"leaves out ({BITS}): a - c, b - c"]),
        # bits of the floor count, and bodies without a shape are not told
        (mjcf(ON_FLOOR), {"world high": BITS, "world low": None, "high low": BITS},
         [f"leaves out ({BITS}): world - high, high - low"]),
    ],
    ids=["parents", "parents too", "welded and moved by two joints", "pair", "exclude and bits", "floor"],
)  # fmt: skip
def test_which_pairs_are_not_measured_and_why(tmp_path, model, found, told):
    loaded = load_mjcf(tmp_path, model)
    assert why(loaded) == found
    notes = [one for one in loaded.notes if "leaves out (" in one or "measures, as" in one]
    assert [note.partition("srdf ")[2] for note in notes] == told


class RandomModel:
    """Bodies all of whose boxes overlap, with random joints, bits, excluded and asked for pairs of bodies."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        n = int(random.integers(3, 7))
        above = [int(random.integers(-1, i)) for i in range(n)]
        joints = random.choice(["", JOINT, JOINTS], n, p=[0.4, 0.4, 0.2])
        inside = [""] * n
        world = self.geom(random, "world") if random.random() < 0.5 else ""
        for i in reversed(range(n)):
            geoms = "".join(
                self.geom(random, f"g{i}{k}") for k in range(int(random.integers(1, 3)))
            )
            text = body(f"l{i}", inside[i], joint=joints[i], geom=geoms)
            if above[i] < 0:
                world += text
            else:
                inside[above[i]] += text
        pairs = [*itertools.combinations(range(n), 2)]
        kinds = random.choice(["", "exclude", "pair", "both"], len(pairs), p=[0.7, 0.1, 0.1, 0.1])
        rows = ""
        for (a, b), kind in zip(pairs, kinds, strict=True):
            if kind in ("exclude", "both"):
                rows += f'<exclude body1="l{a}" body2="l{b}"/>'
            if kind in ("pair", "both"):
                rows += f'<pair geom1="g{a}0" geom2="g{b}0"/>'
        flag = random.choice(["enable", "enable", "disable"])
        option = f'<option><flag filterparent="{flag}"/></option>'
        self.text = mjcf(world, option, f"<contact>{rows}</contact>")

    def geom(self, random, name):
        bits = random.choice([0, 1, 1, 1, 2, 3], 2)
        return f'<geom name="{name}" type="box" size="1 1 1" contype="{bits[0]}" conaffinity="{bits[1]}"/>'

    def met_in_mujoco(self):
        """The pairs of bodies between which MuJoCo finds contacts, though each overlaps each."""
        model = mujoco.MjModel.from_xml_string(self.text)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        ends = ([model.geom_bodyid[geom] for geom in one.geom] for one in data.contact)
        return {frozenset(model.body(i).name for i in pair) for pair in ends}


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 60, 20))
def test_mujoco_collides_exactly_the_pairs_that_are_measured(tmp_path, first):
    n_measured = n_filtered = 0
    for seed in range(first, first + 20):
        model = RandomModel(seed)
        robot, met = load_mjcf(tmp_path, model.text), model.met_in_mujoco()
        for pair in self_pairs(robot):
            if pair.excused != RIGID:
                together = frozenset((pair.link_a, pair.link_b)) in met
                assert together == (pair.excused is None), (seed, pair)
                n_measured, n_filtered = n_measured + together, n_filtered + (not together)
    assert min(n_measured, n_filtered) > 20


STAND = '<geom type="box" size="0.1 0.1 0.1"/>'


def run_of(robot, *obstacles, end=-0.886, self_clearance=True):
    """The run of a robot whose joint j goes from 0 to an end."""
    path = cl.Trajectory(np.array([0.0, 1.0]), ("j",), np.array([[0.0], [end]]))
    asked = cl.SelfClearance() if self_clearance else None
    placed = cl.PlacedRobot(robot, path, self_clearance=asked)
    return cl.check(cl.Case("stand", (placed,), obstacles))


DROP = f'<body name="moved" pos="0 0 1"><joint name="j" type="slide" axis="0 0 1"/>{STAND}</body>'
FLOOR = '<geom name="floor" type="plane" size="1 1 1" pos="0 0 0.05" euler="0 0 30"/>'


def test_a_link_that_sinks_into_the_models_own_floor_is_found(tmp_path):
    robot = load_mjcf(tmp_path, mjcf(FLOOR + DROP))
    run = run_of(robot)
    assert (run.worst["link"], run.worst["obstacle"]) == ("moved", "world")
    assert run.record.clearances[0] == pytest.approx(0.85)
    assert run.record.deepest.penetration == pytest.approx(0.036)


def test_the_models_own_floor_is_told_where_it_is_not_measured(tmp_path):
    robot = load_mjcf(tmp_path, mjcf(FLOOR + DROP))
    table = cl.Obstacle(cl.Body("table", cl.box((0.1, 0.1, 0.1))), at(1.0, 0.0, 0.0))
    floor = "floor and walls of the robot's own file"
    for asked in (False, True):
        run = run_of(robot, table, end=-0.5, self_clearance=asked)
        assert (floor in run.verdict.not_checked) == (not asked)
        why_not = {(one.link, one.obstacle): one.reason for one in run.record.unmeasured}
        assert why_not["world", "table"] == "both stand in the world"
        assert (run.verdict.status, run.verdict.reasons) == ("clear", ())


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
    assert re.search(says, refusal(load, tmp_path, "state: hme", text, of=fault))


TURNS = [
    (1, 0, 0, 0), (0.5, 0.5, 0.5, 0.5), (0.1, 0.2, -0.3, 0.9), (2, 1, 0, 0), (0.7071, 0, 0.7071, 0),
    (0.7071, 0, -0.7071, 1e-9), (0, 0, 0, 0),
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


@pytest.mark.slow
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
    f'<geom size="0.1"/><body name="b" pos="1 0 0"><joint name="j" ref="20"/>{BALL}</body></body>'
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
    assert "root/y" not in rest and rest["j"] == pytest.approx(
        np.radians(20)
    )  # left at 0, with a note
    assert check(case, need="minimum").worst["clearance"] == pytest.approx(0.1, abs=2e-4)
    said = (
        "joints that nothing moves rest where the robot's file has them: root/z 1, root/yaw 1.5708"
    )
    assert said in capsys.readouterr().out
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert "root/z: 1.0  # assumed: nothing moves it, and so the robot's file has it" in text
