"""Which links of an MJCF model are measured against one another: those that MuJoCo lets collide, told in notes."""

import itertools

import mujoco
import numpy as np
import pytest

import clearance as cl
from clearance.formats.robot.mjcf.robot import BITS, EXCLUDE, PARENT
from clearance.world.collision_matrix import ADJACENT
from clearance.world.self_pairs import RIGID, self_pairs
from tests.formats.making_mjcf import BALL, load_mjcf, mjcf
from tests.made_cases import at

JOINT = '<joint type="slide"/>'
JOINTS = JOINT + '<joint type="slide" axis="1 0 0"/>'


def why(robot):
    """By pair of links why it is not measured, or None."""
    return {f"{one.link_a} {one.link_b}": one.excused for one in self_pairs(robot)}


def body(name, inside="", *, joint=JOINT, geom=BALL):
    return f'<body name="{name}">{joint}{geom}{inside}</body>'


CHAIN = body("a", body("b", body("c")))


def test_a_body_and_its_parent_are_not_measured(tmp_path):
    found = why(load_mjcf(tmp_path, mjcf(CHAIN)))
    assert found == {"a b": ADJACENT, "a c": None, "b c": ADJACENT}


def test_unless_the_model_says_that_parents_are_no_exception(tmp_path):
    flag = '<option timestep="0.001"><flag contact="enable" filterparent="disable"/></option>'
    assert {*why(load_mjcf(tmp_path, mjcf(CHAIN, flag))).values()} == {None}


def test_what_is_welded_to_a_parent_or_moved_by_two_joints_is_filtered_and_told(tmp_path):
    tool = body("hand", body("camera", joint="") + body("finger") + body("eye", joint=JOINTS))
    loaded = load_mjcf(tmp_path, mjcf(tool))
    assert why(loaded) == {
        "hand camera": RIGID, "hand finger": ADJACENT, "hand eye": PARENT, "camera finger": PARENT,
        "camera eye": PARENT, "finger eye": None,
    }  # fmt: skip
    told = f"leaves out ({PARENT}): hand - eye, camera - finger, camera - eye"
    assert any(note.endswith(told) for note in loaded.notes)


def test_pairs_that_are_asked_for_are_measured_whatever_else_is_said(tmp_path):
    geoms = [f'<geom name="{name}" size="0.1" contype="0" conaffinity="0"/>' for name in "abc"]
    nested = body("a", body("b", body("c", geom=geoms[2]), geom=geoms[1]), geom=geoms[0])
    asked = '<contact><pair geom1="b" geom2="a"/><exclude body1="a" body2="b"/></contact>'
    loaded = load_mjcf(tmp_path, mjcf(nested, asked))
    assert why(loaded) == {"a b": None}  # nothing that collides is left of c
    assert any(note.endswith("measures, as <pair> says: a - b") for note in loaded.notes)


def test_bits_that_do_not_meet_and_excluded_bodies_are_told(tmp_path):
    one = body("a", geom='<geom size="0.1" contype="1" conaffinity="0"/>')
    two = body("b", geom='<geom size="0.1" contype="2" conaffinity="1"/>')
    three = body("c", geom='<geom size="0.1" contype="4" conaffinity="8"/>')
    excluded = '<contact><exclude body1="b" body2="a"/></contact>'
    loaded = load_mjcf(tmp_path, mjcf(one + two + three, excluded))
    assert why(loaded) == {"a b": EXCLUDE, "a c": BITS, "b c": BITS}
    assert sum("self_clearance without srdf leaves out" in note for note in loaded.notes) == 2


def test_bits_of_the_floor_count_and_bodies_without_a_shape_are_not_told(tmp_path):
    seen = body("seen", geom='<geom size="0.1" contype="0" conaffinity="0"/>')
    high = body("high", geom='<geom size="0.1" contype="2" conaffinity="2"/>')
    floor = '<geom type="plane" size="1 1 1"/>'
    loaded = load_mjcf(tmp_path, mjcf(floor + seen + high + body("low")))
    assert why(loaded) == {"world high": BITS, "world low": None, "high low": BITS}
    (note,) = (one for one in loaded.notes if "leaves out" in one)
    assert note.endswith(f"({BITS}): world - high, high - low")


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
