"""Verdicts on messages with accelerations: of the quintics that a controller follows, held against formulas by
hand and against dense samples of the exact motion, for what a robot carries too.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.case.case_file import load_case
from clearance.simulate.measure.checker import Checker
from clearance.tolerance import CERTIFY_GAP, PATH_ERROR
from clearance.world.cubic import positions_along
from clearance.world.joint_positions import joint_courses
from clearance.world.joint_speeds import greatest_rates
from clearance.world.pairs import selected_pairs
from clearance.world.path_error import path_error_of
from clearance.world.plausibility import notices_of
from clearance.world.quintic import quintics_of
from clearance.world.timing import Window
from tests.cart import URDF

CART = """name: cart
robot: {urdf: cart.urdf}
scene: {obstacles: [{name: wall, box: {size: [0.1, 1, 1]}, pose: {xyz: [0.45, 0, 0]}}]}
trajectory: path.json
limits: {fail: 0.21}
"""
ARM = """<robot name="arm"><link name="ground"/>
  <link name="lower"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.1 0.1"/></geometry></collision>
  </link><link name="upper"><collision><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.08 0.08"/></geometry>
  </collision></link>
  <joint name="a" type="revolute"><parent link="ground"/><child link="lower"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="9" velocity="99"/></joint>
  <joint name="b" type="revolute"><parent link="lower"/><child link="upper"/><origin xyz="0.6 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="99"/></joint></robot>"""
POST = "name: post, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.5, 1.3, 0.3]}"
SCENE = f"""name: arm
robot: {{urdf: arm.urdf}}
scene: {{obstacles: [{{{POST}}}]}}
trajectory: path.json
"""
CARRYING = f"""name: arm
robot: {{urdf: arm.urdf}}
scene: {{obstacles: [{{{POST}}}, {{name: part, box: {{size: [0.1, 0.1, 0.1]}}, pose: {{xyz: [1.2, 0, 0.1]}}}}]}}
trajectory: path.json
carry: [{{part: part, by: upper, from: 0.3, until: 1.7, touch: [upper]}}]
limits: {{rules: [{{between: [part, post], fail: 0}}]}}
"""


def message(names, times, *columns):
    keys = ("positions", "velocities", "accelerations")
    points = [
        {key: column[i].tolist() for key, column in zip(keys, columns, strict=False)} | {"time_from_start": t}
        for i, t in enumerate(np.asarray(times).tolist())
    ]  # fmt: skip
    return json.dumps({"joint_names": list(names), "points": points})


def case(folder, text, urdf, path):
    (folder / "case.yaml").write_text(text)
    (folder / f"{text.split(chr(10))[0].split()[1]}.urdf").write_text(urdf)
    (folder / "path.json").write_text(path)
    return load_case(folder / "case.yaml")


def there_and_back(folder):
    """1.6 s^2 (1 - s)^2: 0.1 m towards the wall, 0.3 m away, though both points are where it stands."""
    rest = np.zeros((2, 1))
    return case(folder, CART, URDF, message(["rail"], [0.0, 1.0], rest, rest, np.full((2, 1), 3.2)))


def test_a_cart_that_its_accelerations_take_to_the_wall_and_back(tmp_path):
    """0.2 m are left, where the points have 0.3 m."""
    run = cl.check(there_and_back(tmp_path))
    assert run.verdict.status == "violated"
    bound = run.record.certificate.lower_bound.min()
    assert 0.2 - CERTIFY_GAP <= bound <= 0.2
    assert run.worst["clearance"] == pytest.approx(0.2, abs=1e-7) and run.worst["clearance"] <= 0.2
    (note,) = [text for text in run.record.case.notes if "quintics" in text]
    assert "2 points become cubics through" in note
    assert run.summary["certified"]["joints"] == "quintic"
    assert run.summary["actors"][0]["between_samples"] == "quintic"


def test_clearances_are_lessened_by_what_the_path_may_be_off(tmp_path):
    found = there_and_back(tmp_path)
    run = cl.check(found)
    error = run.record.timeline.path_error
    assert error == pytest.approx(found.robots[0].given_trajectory.path_error, rel=2e-3)
    assert 0.0 < error <= 1.01 * PATH_ERROR
    first = run.record.steps["clearance"][0].as_py()
    assert first == pytest.approx(0.3 - error, abs=1e-15)


def random_path(seed):
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.3, 1.0, 3))])
    times *= 2.0 / times[-1]
    return times, *(rng.normal(size=(4, 2)) * [[0.8], [1.0], [4.0]][i] for i in range(3))


def exact(times, columns, at):
    """(m, k) the quintics at some times."""
    quintics = quintics_of(times, *columns)
    k = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    s = ((at - times[k]) / np.diff(times)[k])[:, None]
    return sum(part[k] * s**i for i, part in enumerate(quintics))


@pytest.mark.parametrize("seed", range(2))
def test_what_is_proven_is_below_dense_samples_of_the_quintics(tmp_path, seed):
    times, *columns = random_path(seed)
    found = case(tmp_path, SCENE, ARM, message("ab", times, *columns))
    run = cl.check(found)
    checker = Checker(found, accept=["units", "limits"])
    dense = exact(times, columns, np.linspace(0.0, 2.0, 4001))
    least = min(checker.distance(row).distance for row in dense)
    bound = run.record.certificate.lower_bound.min()
    assert bound <= least <= bound + 2.0 * CERTIFY_GAP or least == 0.0 >= bound


def corners(pose, half=0.05):
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T * half
    return pose[:3, 3] + signs @ pose[:3, :3].T


def hand(q):
    """(4, 4) of the upper link."""
    (ca, cb), (sa, sb) = np.cos(q), np.sin(q)
    turn = np.array([[ca, -sa, 0.0], [sa, ca, 0.0], [0.0, 0.0, 1.0]])
    pose = np.eye(4)
    pose[:3, :3] = turn @ np.array([[cb, 0.0, sb], [0.0, 1.0, 0.0], [-sb, 0.0, cb]])
    pose[:3, 3] = turn @ [0.6, 0.0, 0.0]
    return pose


@pytest.mark.parametrize("seed", range(2))
def test_a_part_is_no_farther_from_where_it_is_told_than_the_path_error(tmp_path, seed):
    """Taken at 0.3 s and laid down at 1.7 s, neither a sample of the table: all its corners, at every step."""
    times, *columns = random_path(seed)
    found = case(tmp_path, CARRYING, ARM, message("ab", times, *columns))
    line = cl.check(found).record.timeline
    lie = np.eye(4)
    lie[:3, 3] = 1.2, 0.0, 0.1
    taken, laid = (hand(exact(times, columns, np.array([t]))[0]) for t in (0.3, 1.7))
    grasp = np.linalg.inv(taken) @ lie
    far = 0.0
    for phase in line.phases:
        assert all(padding == phase.case.path_error for padding in selected_pairs(phase).paddings)
        for i in range(phase.n_steps):
            held = hand(exact(times, columns, phase.times[i : i + 1])[0])
            after = laid if phase.span[0] >= 1.7 else held
            right = lie if phase.span[1] <= 0.3 else after @ grasp
            told = pose_in(phase, i, "part")
            far = max(far, np.linalg.norm(corners(told) - corners(right), axis=1).max())
    assert far <= line.path_error
    assert line.path_error == path_error_of(found, line.motions)
    assert line.path_error < 2e-6


def test_the_path_error_is_that_of_the_part_that_is_carried_most(tmp_path):
    times, *columns = random_path(0)
    found = case(tmp_path, CARRYING, ARM, message("ab", times, *columns))
    motions = cl.check(found).record.timeline.motions
    (carry,) = found.carries

    def error(*parts):
        windows = (Window(0.1 * i, 0.1 * i + 0.05) for i in range(len(parts)))
        carries = [
            replace(carry, part=part, window=one) for part, one in zip(parts, windows, strict=False)
        ]
        return path_error_of(replace(found, carries=tuple(carries)), motions)

    once = error("part")
    assert error("part", "post") == once < error("part", "post", "part") == error("part", "part")
    on_part = (replace(carry, part="post", by="part", window=Window(0.5, 0.6)),)
    assert path_error_of(replace(found, carries=(carry, *on_part)), motions) == error(
        "part", "part"
    )


def pose_in(phase, step, name):
    from clearance.world.forest import link_poses_at
    from clearance.world.pairs import OBSTACLE, BodyIndex

    names = [obstacle.name for obstacle in phase.case.obstacles]
    poses = link_poses_at(phase.case, phase.motions, slice(step, step + 1))
    return BodyIndex(OBSTACLE, names.index(name)).poses_in(phase.case, poses)[0]


def test_a_joint_that_goes_to_its_limit_is_not_beyond_it_for_the_way_it_is_followed(tmp_path):
    """s - s^4 is greatest at s^3 = 1/4, where the cubics are above it by up to the path error."""
    highest = 0.25 ** (1.0 / 3.0) * 0.75
    ends = np.array([[0.0], [0.0]]), np.array([[1.0], [-3.0]]), np.array([[0.0], [-12.0]])
    path = message(["rail"], [0.0, 1.0], *ends)
    limit = URDF.replace('upper="5"', f'upper="{highest!r}"')
    assert not [
        one for one in notices_of(case(tmp_path, CART, limit, path)) if one.kind == "limits"
    ]
    lower = URDF.replace('upper="5"', f'upper="{highest - 2e-8!r}"')
    assert [one for one in notices_of(case(tmp_path, CART, lower, path)) if one.kind == "limits"]


def test_a_joint_is_no_faster_and_accelerates_no_more_than_its_quintic(tmp_path):
    """10 s^3 - 15 s^4 + 6 s^5: 15/8 in the middle, 10 / sqrt(3) where its fourth derivative has another sign."""
    ends = np.array([[0.0], [1.0]]), np.zeros((2, 1)), np.zeros((2, 1))
    (placed,) = case(tmp_path, CART, URDF, message(["rail"], [0.0, 1.0], *ends)).robots
    (course,) = joint_courses(placed)
    speed, acceleration = (one.max() for one in greatest_rates(course, placed.given_trajectory))
    assert 0.999 * 15 / 8 <= speed <= 15 / 8
    assert 0.99 * 10 / 3**0.5 <= acceleration <= 10 / 3**0.5


@pytest.mark.parametrize(
    ("wrap", "turned"),
    [("", None), (", wrap: shortest", 2.0 * np.pi - 5.8), (", wrap: as_written", -5.8)],
)
def test_more_than_half_a_turn_from_point_to_point_is_not_hidden_by_the_samples_between(
    tmp_path, wrap, turned
):
    """From 2.9 to -2.9 rad at rest: 5.8 rad back as written, 0.483 rad on the shortest way."""
    rest = np.zeros((2, 1))
    path = message(["a"], [0.0, 1.0], np.array([[2.9], [-2.9]]), rest, rest)
    free = ARM.replace('name="a" type="revolute"', 'name="a" type="continuous"')
    found = case(tmp_path, SCENE.replace("path.json", f"{{file: path.json{wrap}}}"), free, path)
    kinds = [one.kind for one in notices_of(found) if one.severity == "suspect"]
    asked = found.robots[0].given_trajectory
    if turned is None:
        assert "wrap" in kinds
        return
    assert "wrap" not in kinds
    assert asked.positions[-1, 0] - 2.9 == pytest.approx(turned)
    assert positions_along(asked, np.array([0.5]))[0, 0] == pytest.approx(
        2.9 + 0.5 * turned, abs=1e-8
    )
