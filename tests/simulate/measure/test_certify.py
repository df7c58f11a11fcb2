"""Certified bounds: never above samples a thousand times finer, tight as asked, and nothing slips through.

Bodies beyond all reach, and joints that spin between steps, are refused before any arithmetic overflows. Bodies
that float and tumble by tables are placed by quaternions of their own.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.errors import BadDimension, BadPose
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.case import Case
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Mimic
from clearance.world.rules import Allowance
from tests.made_cases import WORST, at, dented, driven, flying, resampled, torus
from tests.simulate.measure.wandering import case_of

CUBE = cl.box((0.1, 0.1, 0.1))


def assert_as_tight_as_asked(run):
    """The bound is within the gap of what was seen, and never above the steps at its ends."""
    certificate = run.record.certificate
    assert (certificate.upper_bound - certificate.lower_bound).max() <= certificate.gap
    clearances = run.record.clearances
    assert (certificate.lower_bound <= clearances).all()
    assert (certificate.lower_bound[:-1] <= clearances[1:]).all()
    assert certificate.lower_bound[-1] == clearances[-1]


def assert_never_above_samples(run, n_worst):
    """The bound of the worst and some other intervals is not above a thousand samples of them."""
    certificate = run.record.certificate
    rng = np.random.default_rng(4)
    n_intervals = len(certificate.lower_bound) - 1
    worst = np.argsort(certificate.lower_bound[:-1])[:n_worst]
    for first in {*worst.tolist(), *rng.choice(n_intervals, n_worst).tolist()}:
        sampled = cl.check(finer(run.record.case, first, 1000), certify=False).record.clearances
        assert certificate.lower_bound[first] <= sampled.min()
        assert sampled.min() <= certificate.upper_bound[first] + 1e-4


def finer(case, first, n_parts):
    """One interval in parts: on lines, or on the cubics, which are scipy's."""
    asked = case.robots[0].trajectory
    times = np.linspace(*asked.times[first : first + 2], n_parts + 1)
    if asked.velocities is None:
        return resampled(case, times)
    spline = CubicHermiteSpline(asked.times, asked.positions, asked.velocities)
    return case.with_trajectory(times, spline(times))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fineness"),
    [("facing_plates", 6), ("linked_tori", 8), ("nested_shells", 2), ("everything_equidistant", 6)],
)
def test_the_bound_holds_where_all_is_near(name, fineness):
    run = cl.check(WORST[name](fineness, 3))
    assert_never_above_samples(run, 1)
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("seed", range(6))
def test_the_bound_holds_for_dented_bodies_that_turn(seed):
    """A rotation of up to 0.9 rad a step: what is turned away at its middle may face the other at its ends."""
    random = np.random.default_rng(seed)
    turns = random.uniform(-0.3, 0.3, (8, 3)).cumsum(axis=0)
    gap = 10.0 ** random.uniform(-4, -2)
    away = np.column_stack([np.linspace(-0.05, 0.05, 8), np.full(8, 0.28 + gap), np.zeros(8)])
    one, other = (
        dented(np.random.default_rng(s), 2, depth=0.4, radius=0.1) for s in (seed, seed + 100)
    )
    case = flying("turning", one, [(other, np.eye(4))], np.hstack([away, turns]))
    run = cl.check(case)
    assert run.record.clearances.min() > 0.0
    assert_never_above_samples(run, 3)
    assert_as_tight_as_asked(run)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 7])
def test_the_bound_holds_on_cubics_with_joints_that_follow_others(seed):
    run = cl.check(case_of(seed, 1, cubic=True))
    assert_never_above_samples(run, 2)
    assert_as_tight_as_asked(run)


def on_a_slide(post, **motion):
    """A cube on a slide along z, and a post."""
    return Case(
        "crossing", (driven(CUBE, JointKind.PRISMATIC, **motion),), (post,), accept=("units",)
    )


def test_a_slide_that_overshoots_comes_as_near_as_the_closed_form_says():
    """Its velocities take it up and down between samples that are all at 0."""
    plate = Obstacle(Body("post", cl.box((1.0, 1.0, 0.02))), at(z=0.05 + 0.25 + 0.002 + 0.01))
    run = cl.check(on_a_slide(plate, positions=[0.0] * 4, velocities=[1.0, -1.0, 0.5, 0.0]))
    heights = np.array([0.25, 0.0, 0.5 * 4 / 27])  # q = v s (1 - s)^2 is highest at s = 1/3
    lower = run.certificate.lower_bound
    assert (lower[:-1] <= 0.252 - heights + 1e-15).all()
    assert (lower[:-1] >= 0.252 - heights - run.certificate.gap).all()
    assert lower[-1] == run.record.clearances[-1]


def crossing(thickness, start, end, obstacle=None):
    """A cube of 20 mm on its way past or through a plate across x."""
    plate = obstacle or cl.box((thickness, 0.5, 0.5))
    return flying(
        "crossing", cl.box((0.02, 0.02, 0.02)), [(plate, np.eye(4))], np.array([start, end])
    )


@pytest.mark.parametrize("thickness", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0])
def test_what_tunnels_is_found(thickness, turn):
    """Clear at both ends; in between the cube goes through, turning or not."""
    run = cl.check(crossing(thickness, [-0.3, 0, 0, 0, 0, 0], [0.4, 0.05, 0, turn, -turn, turn]))
    assert (run.record.clearances > 0.0).all()
    assert run.status == "contact" and not run.passed
    assert run.record.certificate.lower_bound[0] == 0.0
    sampled = cl.check(finer(run.record.case, 0, 1000), certify=False).record.clearances
    assert sampled.min() <= 1e-3


def test_the_shortest_touch_between_two_steps_is_found():
    """The edge of the cube dips 20 picometres into a plate, for about two thousandths of the way."""
    floor = cl.box((4.0, 0.1, 0.1))
    lowest = 0.05 + 0.01 * np.sqrt(2) - 2e-11  # where the cube stands on an edge
    start, end = [-1.0, 0, lowest, np.pi / 4 - 0.03, 0, 0], [1.0, 0, lowest, np.pi / 4 + 0.07, 0, 0]
    run = cl.check(crossing(0.0, start, end, floor))
    assert (run.record.clearances > 0.0).all()
    assert run.record.certificate.lower_bound[0] == 0.0
    assert not run.passed


def test_a_gap_that_is_no_length_is_refused():
    for gap in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(BadDimension):
            cl.answer(cl.Question(crossing(0.1, [-1.0] * 6, [1.0] * 6), certify_gap=gap))


def test_the_papers_method_certifies_nothing_and_the_verdict_says_so():
    case = crossing(0.1, [-0.3, 0, 0, 0, 0, 0], [-0.2, 0, 0, 0, 0, 0])
    run = cl.answer(cl.Question(case, method="paper"))
    assert run.certificate is None and run.verdict.headline() == "clear at the samples only"


def post(x=1.0, size=0.1):
    return Obstacle(Body("post", cl.box((size, size, size))), at(x))


def spinning(turns, multiplier=None, velocities=None):
    """A joint that turns so often in a second; with `multiplier`, another that follows it."""
    hand = driven(CUBE, JointKind.CONTINUOUS, [0.0, 2 * np.pi * turns], velocities=velocities)
    robot = hand.robot
    if multiplier is not None:
        mimic = Mimic("joint", multiplier)
        gear = Joint("gear", JointKind.REVOLUTE, "base", "wheel", np.eye(4), mimic=mimic)
        robot = replace(
            robot, link_names=(*robot.link_names, "wheel"), joints=(*robot.joints, gear)
        )
    return Case("spin", (replace(hand, robot=robot),), (post(),))


STILL = {"positions": [0.0, 0.0]}


@pytest.mark.parametrize(
    ("far", "named"),
    [
        (on_a_slide(post(x=1e90), **STILL), "obstacle 'post'"),
        (on_a_slide(post(size=1e90), **STILL), "obstacle 'post'"),
        (on_a_slide(post(), positions=[0.0, -1e200]), "link 'tool'"),
        (
            on_a_slide(post(x=5.0), **STILL, velocities=[1e8, 0.0]),
            "link 'tool'",
        ),  # between its steps
        (spinning(1e7), "joint 'joint' turns by 6.28319e\\+07 rad between 0 s and 1 s"),
        (spinning(0.5, multiplier=-1e4), "joint 'gear' turns by 31415.9 rad"),
        (spinning(0.0, velocities=[0.0, 1e5]), "joint 'joint' turns by 100000 rad"),
    ],
)
def test_a_body_beyond_reach_or_a_joint_that_spins_between_steps_is_named(far, named):
    with pytest.raises(BadDimension, match=named):
        cl.check(far)


def test_coordinates_that_cannot_be_squared_are_refused_everywhere():
    with pytest.raises(BadDimension, match="1e\\+200"):
        cl.Polyhedron(1e200 * np.eye(3), [[0, 1, 2]])
    pose = np.eye(4)
    pose[0, 3] = 1e300
    with pytest.raises(BadPose, match="1e\\+300"):
        cl.distance(cl.box((1, 1, 1)), cl.box((1, 1, 1)), pose_b=pose)


TURNS = {"usual": 0.7, "half a turn": np.pi, "tiny": 1e-9, "none": 0.0}
N_STEPS = 4


def orientations(random: np.random.Generator, turn: float) -> np.ndarray:
    """(n, 4) unit quaternions, each turned by `turn` [rad] from the one before; axes and signs at random."""
    axes = random.normal(size=(N_STEPS, 3))
    axes *= turn / np.linalg.norm(axes, axis=1)[:, None]
    now, found = Rotation.random(random_state=random), []
    for axis in axes:
        found.append(now.as_quat() * random.choice([-1.0, 1.0]))
        now = now * Rotation.from_rotvec(axis)
    return np.array(found)


def tumbling(seed: int, turn: float, place=(0.0, 0.0, 0.0)) -> Case:
    """A dented body that slides on one that tumbles, past another that tumbles, and a ring that stands."""
    random = np.random.default_rng(seed)
    share = np.linspace(-1.0, 1.0, N_STEPS)[:, None]
    tables = [
        PoseTable(
            np.arange(float(N_STEPS)),
            0.75 * np.array([side, 0.2, 0.1]) + 0.1 * share * random.normal(size=3),
            orientations(random, turn),
        )
        for side in (-1.0, 1.0)
    ]
    shapes = [dented(random, 1, 0.3, radius) for radius in (0.4, 0.35)]
    slide = driven(shapes[0], JointKind.PRISMATIC, random.uniform(-0.05, 0.05, N_STEPS))
    rides = replace(slide, mount=Mount("cart", at(*place)))
    obstacles = (
        Obstacle(Body("cart", cl.box((0.01, 0.01, 0.01))), moves=tables[0]),
        Obstacle(Body("other", shapes[1]), moves=tables[1]),
        Obstacle(Body("ring", torus(0.1, 0.04, 9, 5))),
    )
    return Case("tumbling", (rides,), obstacles, allow=(Allowance(("tool", "cart")),))


def poses_of(table: PoseTable, step: int, shares: np.ndarray) -> np.ndarray:
    """(n, 4, 4) between two rows: along the chord, and by the sines of the arc, the shorter way."""
    s = shares[:, None]
    p, q = table.quaternions[step : step + 2]
    if sum(p[k] * q[k] for k in range(4)) < 0.0:  # rounding decides about half a turn
        q = -q
    angle = 2.0 * np.arcsin(0.5 * np.linalg.norm(q - p))
    mixed = (1.0 - s) * p + s * q
    if angle > 1e-6:
        mixed = (np.sin((1.0 - s) * angle) * p + np.sin(s * angle) * q) / np.sin(angle)
    found = np.tile(np.eye(4), (len(shares), 1, 1))
    found[:, :3, :3] = Rotation.from_quat(mixed).as_matrix()
    found[:, :3, 3] = (1.0 - s) * table.positions[step] + s * table.positions[step + 1]
    return found


def least_between(case: Case, step: int, place) -> float:
    """[m] the least of a thousand samples of all pairs but that of the robot and what it stands on."""
    shares = np.linspace(0.0, 1.0, 1001)
    cart, other, ring = case.obstacles
    slid = np.tile(at(*place), (len(shares), 1, 1))
    slid[:, 2, 3] += np.interp(
        shares, [0, 1], case.robots[0].trajectory.positions[step : step + 2, 0]
    )
    on = poses_of(cart.moves, step, shares)
    tool = case.robots[0].robot.bodies[0].shape, on @ slid
    tumbles = other.body.shape, poses_of(other.moves, step, shares)
    stands = ring.body.shape, np.tile(np.eye(4), (len(shares), 1, 1))
    pairs = [*itertools.combinations((tool, tumbles, stands), 2)]
    pairs += [((cart.body.shape, on), body) for body in (tumbles, stands)]
    return min(
        cl.Query(a, b).distances(of_a, of_b).distances.min() for (a, of_a), (b, of_b) in pairs
    )


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize(
    "place", [(0.0, 0.0, 0.0), (0.1, -0.05, 0.15)], ids=["on its middle", "beside"]
)
def test_no_bound_is_above_samples_a_thousand_times_finer(place, turn):
    case = tumbling(0, turn, place)
    certificate = cl.check(case).certificate
    for step in range(N_STEPS - 1):
        least = least_between(case, step, place)
        assert certificate.lower_bound[step] <= least <= certificate.upper_bound[step] + 1e-4
        assert certificate.upper_bound[step] - certificate.lower_bound[step] <= 1e-4


def test_half_a_turn_sweeps_the_side_of_the_given_signs():
    """A blade that stands up turns down over one side or the other; a block is in the way on one of them."""
    blade = cl.box((0.02, 0.02, 0.2)).transformed(at(0.0, 0.0, 0.5))
    block = driven(cl.box((0.1, 0.1, 0.1)), JointKind.PRISMATIC, [0.0, 0.0], base=at(0.5))
    for sign, touches in ((1.0, True), (-1.0, False)):
        turns = np.array([[0, 0, 0, 1.0], [0, sign, 0, 0]])  # about y: z goes to x first, or to -x
        turning = Obstacle(
            Body("blade", blade), moves=PoseTable(np.arange(2.0), np.zeros((2, 3)), turns)
        )
        certificate = cl.check(Case("blade", (block,), (turning,))).certificate
        assert (certificate.lower_bound[0] == 0.0) == touches
