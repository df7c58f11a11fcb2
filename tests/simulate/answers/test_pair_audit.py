"""Whether two links can ever meet: against geometry known by hand, dense samples and the exact oracle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box
from clearance.query.distance import distance
from clearance.query.pair_query import Query
from clearance.record.audit import PairStatus
from clearance.simulate.answers.audit.joint_box import BoxDistances, JointBox
from clearance.simulate.answers.audit.pair import GAP, audit_pair
from clearance.world.body import Body
from clearance.world.kinematic_chain import chain_between
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from tests import oracle
from tests.examples import examples
from tests.made_cases import at, prism, random_robot

Z = np.array([0.0, 0.0, 1.0])


def turning(parent, child, at, lower=-math.pi, upper=math.pi, axis=Z, **options):
    kind = options.pop("kind", JointKind.REVOLUTE)
    return Joint(parent + child, kind, parent, child, at, axis, lower, upper, **options)


def robot_of(bodies, *joints):
    return Robot("r", tuple("abcdefgh"[: len(joints) + 1]), joints, tuple(bodies))


def arm(reach, half_width=0.05):
    """A bar of a length along x from its axis."""
    return box((reach, 2 * half_width, 0.1)).transformed(at(reach / 2))


POST = box((0.2, 0.2, 1.0)).transformed(at(1.0))
"""Its near face is at x = 0.9, one metre wide of the axis of link a."""


@pytest.mark.parametrize("reach", [0.5, 0.895])
def test_an_arm_that_is_too_short_is_proven_apart(reach):
    robot = robot_of([Body("a", POST), Body("b", arm(reach))], turning("a", "b", np.eye(4)))
    found = audit_pair(robot, "a", "b")
    least = 0.9 - math.hypot(reach, 0.05) if math.atan2(0.05, reach) < 0.1 else 0.9 - reach
    assert found.status is PairStatus.APART
    assert 0.25 * found.least <= found.lower_bound + 1e-9 and found.lower_bound <= least + 1e-9
    assert found.least >= 0.9 - math.hypot(reach, 0.05) - 1e-12


def test_a_narrow_meeting_between_the_samples_is_found():
    """A pin through a slot of 0.2 mrad: no sample hits it, the halving does."""
    pin = box((1e-4, 1e-4, 0.1)).transformed(at(1.0))
    robot = robot_of(
        [Body("a", pin), Body("b", pin)],
        turning("a", "b", np.eye(4), lower=-3.0, upper=2.9),
    )
    assert audit_pair(robot, "a", "b").status is PairStatus.MEETS


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1e-3])
def test_faces_that_slide_past_each_other_at_a_constant_gap_are_proven(gap):
    robot = robot_of(
        [Body("a", prism(0.2, 0.05)), Body("b", prism(0.2, 0.05))],
        turning("a", "b", at(z=0.05 + gap)),
    )
    found = audit_pair(robot, "a", "b")
    assert found.status is PairStatus.APART and found.least == pytest.approx(gap, abs=1e-12)
    assert 0.25 * gap <= found.lower_bound <= gap
    n_by_length = 2 * math.pi * 0.2 / gap  # boxes, if sliding counted as coming nearer
    assert found.n_boxes < 0.5 * n_by_length


@pytest.mark.slow
def test_a_gap_below_the_resolution_is_undecided_and_told():
    robot = robot_of(
        [Body("a", prism(0.2, 0.05, 12)), Body("b", prism(0.2, 0.05, 12))],
        turning("a", "b", at(z=0.05 + 0.4 * GAP)),
    )
    found = audit_pair(robot, "a", "b")
    assert found.status is PairStatus.UNDECIDED and found.lower_bound == 0.0
    assert found.why == "they come within 0.1 mm of each other"
    assert 0.0 < found.least < GAP


def test_the_budget_is_told():
    robot = robot_of(
        [Body("a", POST), Body("b", arm(0.45)), Body("c", arm(0.445))],
        turning("a", "b", np.eye(4)), turning("b", "c", at(0.45)),
    )  # fmt: skip
    found = audit_pair(robot, "a", "c", most_boxes=10)
    assert found.status is PairStatus.UNDECIDED and found.why.startswith("not settled by ")
    assert found.least > 0.0


def test_a_joint_that_slides_without_limits_is_said():
    robot = robot_of(
        [Body("a", POST), Body("b", arm(0.5))],
        turning("a", "b", np.eye(4), -np.inf, np.inf, kind=JointKind.PRISMATIC),
    )
    found = audit_pair(robot, "a", "b")
    assert found.status is PairStatus.UNDECIDED and "slides without limits" in found.why


def test_a_joint_that_turns_without_limits_is_looked_at_all_round():
    far_round = box((0.2, 0.2, 1.0)).transformed(at(-1.0))
    robot = robot_of(
        [Body("a", far_round), Body("b", arm(0.95))],
        turning("a", "b", np.eye(4), -np.inf, np.inf, kind=JointKind.CONTINUOUS),
    )
    assert audit_pair(robot, "a", "b").status is PairStatus.MEETS


def test_joints_that_follow_move_with_their_master():
    """Two fingers that open together never meet, though each alone could reach the other."""
    finger = box((0.02, 0.02, 0.1))
    left = turning(
        "a", "b", at(0.02), 0.0, 0.04, np.array([1.0, 0.0, 0.0]), kind=JointKind.PRISMATIC
    )
    right = turning(
        "a", "c", at(-0.02), 0.0, 0.04, np.array([-1.0, 0.0, 0.0]), kind=JointKind.PRISMATIC
    )
    shapes = [Body("b", finger), Body("c", finger)]
    found = audit_pair(robot_of(shapes, left, replace(right, mimic=Mimic("ab"))), "b", "c")
    assert found.status is PairStatus.APART and found.lower_bound == pytest.approx(0.02, abs=0.016)
    closing = replace(right, mimic=Mimic("ab", -1.0, 0.0))
    assert set(audit_pair(robot_of(shapes, left, closing), "b", "c").positions) == {"ab"}


def test_a_leader_without_limits_has_those_of_what_follows_it():
    """A tenth of its turns: over one turn of the leader the arm would not come round to the post."""
    leader = turning("a", "b", at(z=5.0), -np.inf, np.inf, kind=JointKind.CONTINUOUS)
    mimic = Mimic("ab", 0.1, 1.0)
    shapes = [Body("a", POST), Body("b", box((0.1,) * 3)), Body("c", arm(0.95))]
    limited = turning("a", "c", np.eye(4), -1.0, 1.0, mimic=mimic)
    assert audit_pair(robot_of(shapes, leader, limited), "a", "c").status is PairStatus.MEETS
    free = replace(limited, kind=JointKind.CONTINUOUS, lower=-np.inf, upper=np.inf)
    found = audit_pair(robot_of(shapes, leader, free), "a", "c")
    assert found.status is PairStatus.UNDECIDED and "moves others without limits" in found.why
    whole = replace(free, mimic=Mimic("ab", 2.0, 1.0))
    assert audit_pair(robot_of(shapes, leader, whole), "a", "c").status is PairStatus.MEETS


@pytest.mark.parametrize(
    ("lower", "status", "most"), [(0.4, PairStatus.APART, 0.3), (-0.3, PairStatus.MEETS, 0.65)]
)
def test_limits_of_followers_count_by_their_factor_and_offset(lower, status, most):
    """c = -2 b + 1 within `lower` to 2; c reaches the post at about 0 rad."""
    follower = turning("a", "c", np.eye(4), lower, 2.0, mimic=Mimic("ab", -2.0, 1.0))
    shapes = [Body("a", POST), Body("b", box((0.1,) * 3)), Body("c", arm(0.95))]
    found = audit_pair(robot_of(shapes, turning("a", "b", at(z=5.0)), follower), "a", "c")
    assert found.status is status and -0.5 <= found.positions["ab"] <= most + 1e-12


def test_an_open_surface_is_never_proven_apart():
    shell = prism(2.0, 4.0)
    holed = Polyhedron(shell.vertices, shell.triangles()[:-16])  # a stripe of its side is missing
    robot = robot_of(
        [Body("a", holed), Body("b", arm(0.5))],
        turning("a", "b", np.eye(4)),
    )
    found = audit_pair(robot, "a", "b")
    assert found.status is PairStatus.UNDECIDED and "a surface is open" in found.why


def random_pair(rng, n_joints):
    """A robot with boxes on its first and its last link, and limits to all joints."""
    robot = random_robot(rng, n_joints, mimics=0.2)
    joints = []
    for joint in robot.joints:
        low = rng.uniform(-1.5, 1.5)
        joints.append(replace(joint, lower=low, upper=low + rng.uniform(0.0, 1.5)))
    links = robot.link_names[0], robot.link_names[-1]
    bodies = tuple(Body(link, box(rng.uniform(0.05, 0.4, 3))) for link in links)
    return replace(robot, joints=tuple(joints), bodies=bodies), *links


def within_limits(rng, chain, n, ranges=None):
    low, high = (chain.ranges if ranges is None else ranges).T
    low, high = (
        np.where(np.isfinite(high - low), low, -math.pi),
        np.where(np.isfinite(high - low), high, math.pi),
    )
    return low + (high - low) * rng.random((n, len(low)))


def all_within(robot, chain, positions):
    """(n,) True where each joint that these positions (n, k) move is within its own limits, a leader at a time."""
    known = {joint.name: positions[:, k] for k, joint in enumerate(chain.masters)}
    kept = np.ones(len(positions), dtype=bool)
    for joint in robot.joints:  # those that follow come after what they follow
        mimic = joint.mimic
        if mimic is not None and mimic.joint in known:
            known[joint.name] = mimic.multiplier * known[mimic.joint] + mimic.offset
        if joint.name in known:
            at = known[joint.name]
            kept &= (joint.lower - 1e-12 <= at) & (at <= joint.upper + 1e-12)
    return kept


@examples(30)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_findings_hold_against_samples_and_the_oracle(seed, n_joints):
    rng = np.random.default_rng(seed)
    robot, a, b = random_pair(rng, n_joints)
    found = audit_pair(robot, a, b, most_boxes=20_000)
    chain = chain_between(robot, a, b)
    if (chain.ranges[:, 0] > chain.ranges[:, 1]).any():
        assert found.status is PairStatus.UNDECIDED
        return
    shapes = {body.name: body.shape for body in robot.bodies}
    own = np.array([(joint.lower, joint.upper) for joint in chain.masters]).reshape(-1, 2)
    positions = within_limits(rng, chain, 3000, own)
    poses = chain.frames(positions[all_within(robot, chain, positions)])[:, -1]
    sampled = np.inf
    if len(poses):
        sampled = Query(shapes[a], shapes[b]).distances(None, poses).distances.min()
    if found.status is PairStatus.APART:
        assert found.lower_bound <= sampled and 0.0 < found.lower_bound <= found.least
    at = np.array([[found.positions[joint.name] for joint in chain.masters]])
    pose = chain.frames(at)[0, -1]
    exact = oracle.solid_distance_sq(
        shapes[a].vertices,
        shapes[a].triangles(),
        shapes[b].vertices,
        shapes[b].triangles(),
        None,
        pose,
    )
    assert oracle.error(found.least, exact) < 1e-12
    if found.status is PairStatus.MEETS:
        assert exact == 0
        assert all_within(robot, chain, at).all()


@examples(60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.sampled_from([1e-3, 0.03, 0.3, 1.0]))
def test_both_bounds_of_a_box_hold_at_every_position_in_it(seed, n_joints, size):
    rng = np.random.default_rng(seed)
    robot, a, b = random_pair(rng, n_joints)
    chain = chain_between(robot, a, b)
    shapes = {body.name: body.shape for body in robot.bodies}
    middle = within_limits(rng, chain, 1)
    half = size * rng.random(middle.shape)
    frames = chain.frames(middle)
    seen = distance(shapes[a], shapes[b], pose_b=frames[0, -1])
    if seen.contact:
        return
    points = np.stack([seen.point_a, seen.point_b])[None]
    bounds = JointBox.of(chain, shapes[a], shapes[b])
    motion = bounds.motion(half, frames)
    apart = bounds.first_order_separation(
        half, BoxDistances(np.array([seen.distance]), points, frames)
    )
    proven = max(seen.distance - motion.way[0], apart[0] - motion.rest[0]) - bounds.slack
    corners = rng.choice([-1.0, 1.0], (200, middle.shape[1]))
    inside = rng.uniform(-1.0, 1.0, (200, middle.shape[1]))
    poses = chain.frames(middle + half * np.concatenate([corners, inside]))[:, -1]
    assert Query(shapes[a], shapes[b]).distances(None, poses).distances.min() >= proven


@pytest.mark.parametrize("seed", range(12))
def test_slopes_are_those_of_the_nearest_point_as_joints_move(seed):
    """By differences; the nearest point of the second link moves with it, and the direction stays."""
    rng = np.random.default_rng(seed)
    robot, a, b = random_pair(rng, 3)
    chain = chain_between(robot, a, b)
    bodies = {body.name: body.shape for body in robot.bodies}
    middle = within_limits(rng, chain, 1)
    frames = chain.frames(middle)
    u, point = np.array([0.6, 0.0, 0.8]), frames[0, -1] @ [0.1, -0.2, 0.3, 1.0]
    seen = BoxDistances(np.array([0.5]), np.stack([point[:3] - 0.5 * u, point[:3]])[None], frames)
    slopes = JointBox.of(chain, bodies[a], bodies[b]).slopes(seen)[0]
    for step, slope in zip(1e-6 * np.eye(len(slopes)), slopes, strict=True):
        after, before = (chain.frames(middle + way * step)[0, -1] for way in (1, -1))
        moved = (after - before) @ [0.1, -0.2, 0.3, 1.0] / 2e-6
        assert slope == pytest.approx(u @ moved[:3], abs=1e-7)
