"""Two clocks: the least over all pairs of times against dense grids, hand-worked answers and one common clock."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.clocks.pairs import ClockMotion, PairsOfTwoClocks
from clearance.simulate.measure.clocks.unsynchronised import (
    UnsynchronisedAnswers,
    least_unsynchronised,
)
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.kinematics import link_poses
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import BodyIndex, Pair, measured_pairs
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind
from clearance.world.trajectory import Trajectory
from tests import oracle
from tests.examples import examples, first_fast, some_slow
from tests.made_cases import at, driven, faces_of
from tests.oracle.kinematics import link_poses as exact_link_poses
from tests.oracle.kinematics import placed as exactly_placed
from tests.simulate.measure.wandering import solid_robot
from tests.strategies import rotations

GAP = 1e-4
FOREVER = float("inf")


def two_robots(seed: int, *, n_steps: int = 9, cubic: bool = False, away: float = 1.0) -> cl.Case:
    """Two random robots some way apart; a joint in five rests."""
    random = np.random.default_rng(seed)
    robots = []
    times = np.cumsum(random.uniform(0.5, 1.5, n_steps)) / n_steps
    for i in range(2):
        robot = solid_robot(random, f"r{i}", int(random.integers(3, 6)))
        names = tuple(joint.name for joint in robot.moving_joints)
        rate = random.uniform(0.0, 3.0, len(names)) * (random.random(len(names)) < 0.8)
        phase = random.uniform(0.0, 6.0, len(names))
        angle = times[:, None] * rate + phase
        asked = Trajectory(times, names, np.sin(angle), rate * np.cos(angle) if cubic else None)
        base = at(away * i, *random.normal(0.0, 0.3, 2), turned=rotations(random, 1)[0])
        robots.append(PlacedRobot(robot, asked, base))
    return cl.Case("two_clocks", tuple(robots), ())


def sliding(name: str, start, way, size=(0.1, 0.1, 0.1), n_steps: int = 6) -> PlacedRobot:
    """A box whose centre goes from `start` along `way` (3,) [m] in a second."""
    length = float(np.linalg.norm(way))
    placed = driven(
        cl.box(size),
        JointKind.PRISMATIC,
        [0.0],
        axis=np.array(way) / length,
        base=at(*start),
        name=name,
    )
    times = np.linspace(0.0, 1.0, n_steps)
    return replace(placed, trajectory=Trajectory(times, ("joint",), times[:, None] * length))


def asked(case: cl.Case, slack: float, *, jobs: int = 1, pairs=None) -> UnsynchronisedAnswers:
    motions = [kinematic_motion(placed) for placed in case.robots]
    pairs = measured_pairs(case)[0] if pairs is None else pairs
    return least_unsynchronised(whole_run(case, motions, pairs, slack), GAP, Resources(jobs))


def whole_run(case, motions, pairs, slack):
    side = ClockMotion(case, motions)
    second = frozenset(BodyIndex(pair.b.i_robot, 0) for pair in pairs)
    return PairsOfTwoClocks(side, side, second, pairs, case.limits, slack)


def distances(case: cl.Case, moments_a: np.ndarray, moments_b: np.ndarray, near: np.ndarray):
    """(pairs, k, l) [m] with the robots at (step, share) moments (k, 2) and (l, 2); infinite where not `near`."""
    poses = []
    for placed, moments in zip(case.robots, (moments_a, moments_b), strict=True):
        motion = kinematic_motion(placed)
        where = [motion.positions_after(int(i), share) for i, share in moments]
        poses.append(link_poses(placed, np.array(where)))
    pairs = measured_pairs(case)[0]
    found = np.full((len(pairs), len(moments_a), len(moments_b)), np.inf)
    for p, pair in enumerate(pairs):
        of_a = pair.a.poses_in(case, np.concatenate(poses, axis=1))
        of_b = pair.b.poses_in(case, np.concatenate(poses, axis=1))
        shapes = pair.a.shape_in(case), pair.b.shape_in(case)
        for i, k in np.argwhere(near):
            found[p, i, k] = cl.distance(*shapes, pose_a=of_a[i], pose_b=of_b[k]).distance
    return found


def moments_of(n_steps: int, finer: int) -> np.ndarray:
    """(m, 2) so many in each interval, both ends included."""
    shares = np.linspace(0.0, 1.0, finer)
    return np.array([(i, share) for i in range(n_steps - 1) for share in shares])


def times_of(case: cl.Case, moments: np.ndarray) -> np.ndarray:
    times = case.robots[0].given_trajectory.times
    step = moments[:, 0].astype(int)
    return times[step] + moments[:, 1] * (times[step + 1] - times[step])


@pytest.mark.parametrize("cubic", [False, True])
@pytest.mark.parametrize("slack", [FOREVER, 0.25, 0.0])
@pytest.mark.parametrize("seed", first_fast([1, 3, 4, 5], 1))
def test_against_a_dense_grid_of_both_times(seed, slack, cubic):
    case = two_robots(seed, cubic=cubic)
    n_steps, finer = 9, 4
    moments = moments_of(n_steps, finer)
    times = times_of(case, moments)
    near = np.abs(times[:, None] - times[None]) <= slack
    grid = distances(case, moments, moments, near).min(axis=(0, 2))
    bounds = asked(case, slack).intervals
    sampled = grid.reshape(n_steps - 1, finer).min(axis=1)
    assert (bounds.lower <= sampled + 1e-12).all()
    assert (bounds.upper <= sampled + GAP).all()
    assert (bounds.upper - bounds.lower <= GAP).all()
    assert (bounds.lower >= 0.0).all()


@pytest.mark.parametrize("slack", [FOREVER, 0.25, 0.0])
@pytest.mark.parametrize("away", [0.1, 1.0])
@pytest.mark.parametrize("seed", range(4))
def test_each_step_has_the_least_of_all_steps_in_the_band(seed, away, slack):
    case = two_robots(seed, away=away)
    moments = np.array([(min(i, 7), float(i == 8)) for i in range(9)])
    times = case.robots[0].given_trajectory.times
    near = np.abs(times[:, None] - times[None]) <= slack
    every = distances(case, moments, moments, near)
    steps = asked(case, slack).steps
    assert np.allclose(steps.clearance, every.min(axis=(0, 2)), rtol=0.0, atol=1e-12)
    for i in range(9):
        ties = np.argwhere(every[:, i] <= every[:, i].min() + 1e-12)
        assert [steps.pair[i], steps.step_b[i]] in ties.tolist()
        if every[:, i].min() == 0.0:
            assert [steps.pair[i], steps.step_b[i]] == ties[0].tolist()
        p, q = steps.points[i]
        assert np.linalg.norm(p - q) == pytest.approx(steps.clearance[i], abs=1e-9)


@pytest.mark.parametrize("slack", [FOREVER, 0.25])
@pytest.mark.parametrize("cubic", [False, True])
def test_the_moment_of_an_interval_has_its_upper_bound(cubic, slack):
    case = two_robots(3, cubic=cubic)
    found = asked(case, slack)
    for i in range(8):
        moment = found.moment_of(i)
        times = case.robots[0].given_trajectory.times
        assert times[i] <= moment.time <= times[i + 1]
        assert abs(moment.time - moment.time_b) <= slack + 1e-12
        assert moment.clearance == pytest.approx(found.intervals.upper[i], abs=1e-9)
        apart = np.linalg.norm(np.subtract(moment.point_link, moment.point_obstacle))
        assert apart == pytest.approx(moment.clearance, abs=1e-9)


def test_boxes_that_come_towards_one_another():
    """Centres from 0 to 1 and from 3 to 2, each half a side of 0.05: 1.9 less the way of the first."""
    robots = sliding("one", (0, 0, 0), (1, 0, 0)), sliding("two", (3, 0, 0), (-1, 0, 0))
    found = asked(cl.Case("boxes", robots, ()), FOREVER)
    steps = 1.9 - np.linspace(0.0, 1.0, 6)
    assert np.allclose(found.steps.clearance, steps, rtol=0.0, atol=1e-12)
    assert found.steps.step_b.tolist() == [5] * 6
    assert np.allclose(found.intervals.upper, steps[1:], rtol=0.0, atol=1e-12)
    assert np.allclose(found.intervals.lower, steps[1:], rtol=0.0, atol=1e-12 + GAP)
    moment = found.moment_of(int(found.intervals.upper.argmin()))
    assert (moment.time, moment.time_b) == (1.0, 1.0)
    assert [moment.point_link[0], moment.point_obstacle[0]] == pytest.approx(
        [1.05, 1.95], abs=1e-12
    )


@pytest.mark.parametrize("slack", [0.0, 0.1, 0.2, 0.29])
def test_boxes_that_cross_one_above_the_other(slack):
    """Centres (t, 0, 0) and (0.5, t, 0.3): sideways they are (0.4 - t_a, t_b - 0.1) apart, 0.2 in height.

    With t_b = t_a - slack that is least for t_a = (0.5 + slack) / 2, where both are (0.3 - slack) / 2.
    """
    robots = sliding("one", (0, 0, 0), (1, 0, 0)), sliding("two", (0.5, 0, 0.3), (0, 1, 0))
    bounds = asked(cl.Case("boxes", robots, ()), slack).intervals
    least = np.sqrt(0.04 + (0.3 - slack) ** 2 / 2)
    assert bounds.lower.min() <= least <= bounds.upper.min() + 1e-12
    assert bounds.upper.min() - bounds.lower.min() <= GAP


def test_boxes_that_meet_at_other_times_only():
    """On one clock they keep apart; on two the one is where the other was half a second ago."""
    robots = sliding("one", (0, 0, 0), (1, 0, 0)), sliding("two", (0.5, -1.0, 0), (0, 1, 0))
    case = cl.Case("boxes", robots, ())
    assert asked(case, 0.0).intervals.lower.min() > 0.2
    found = asked(case, FOREVER)
    assert found.intervals.upper.min() == 0.0
    assert found.intervals.lower.min() == 0.0
    assert found.moment_of(int(found.intervals.upper.argmin())).clearance == 0.0
    apart = np.abs(np.linspace(0.0, 1.0, 6) - 0.5) - 0.1
    assert np.allclose(found.steps.clearance, np.maximum(0.0, apart), rtol=0.0, atol=1e-12)


def test_a_thin_plate_that_is_crossed_between_two_steps_is_contact():
    plate = sliding("plate", (0.5, -2.0, 0), (0, 4, 0), size=(1e-4, 1.0, 1.0), n_steps=2)
    robots = sliding("one", (0, 0, 0), (1, 0, 0), n_steps=2), plate
    found = asked(cl.Case("boxes", robots, ()), FOREVER)
    assert found.steps.clearance.min() > 0.4
    assert found.intervals.upper[0] == found.intervals.lower[0] == 0.0


@pytest.mark.parametrize("still", [0, 1])
def test_one_robot_may_rest(still):
    case = two_robots(2)
    robots = list(case.robots)
    resting = robots[still].given_trajectory
    same = np.repeat(resting.positions[:1], 9, axis=0)
    robots[still] = replace(
        robots[still], trajectory=Trajectory(resting.times, resting.joint_names, same)
    )
    case = replace(case, robots=tuple(robots))
    free, tied = asked(case, FOREVER).intervals, asked(case, 0.0).intervals
    assert abs(free.lower.min() - tied.lower.min()) <= GAP
    if still == 1:
        assert np.abs(free.lower - tied.lower).max() <= GAP


@pytest.mark.parametrize("cubic", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_without_slack_it_is_what_one_clock_has(seed, cubic):
    case = two_robots(seed, cubic=cubic)
    motions = [kinematic_motion(placed) for placed in case.robots]
    pairs = measured_pairs(case)[0]
    tied_pairs = PairsInMotion(case, motions, pairs)
    tied = certify_motion(tied_pairs, measure(tied_pairs), GAP)
    found = asked(case, 0.0)
    assert np.array_equal(found.steps.clearance, measure(tied_pairs).clearance)
    assert found.steps.step_b.tolist() == list(range(9))
    bounds = found.intervals
    assert (bounds.lower <= tied.upper_bound[:-1] + 1e-12).all()
    assert (tied.lower_bound[:-1] <= bounds.upper + 1e-12).all()


@pytest.mark.slow
@examples(15)
@given(st.integers(0, 30), st.lists(st.floats(0.0, 1.0), min_size=2, max_size=3))
def test_more_slack_never_leaves_more_distance(seed, slacks):
    case = two_robots(seed, n_steps=5)
    runs = [asked(case, slack) for slack in [*sorted(slacks), FOREVER]]
    for less, more in zip(runs, runs[1:], strict=False):
        assert (more.steps.clearance <= less.steps.clearance).all()
        assert (more.intervals.lower <= less.intervals.upper + 1e-12).all()
        assert (more.intervals.upper <= less.intervals.upper + GAP).all()


@pytest.mark.parametrize("slack", [FOREVER, 0.2])
@pytest.mark.parametrize("seed", range(4))
def test_which_clock_is_first_changes_nothing_of_the_least(seed, slack):
    case = two_robots(seed)
    pairs = measured_pairs(case)[0]
    one = asked(case, slack)
    other = asked(case, slack, pairs=[Pair(pair.b, pair.a) for pair in pairs])
    assert one.steps.clearance.min() == pytest.approx(other.steps.clearance.min(), abs=1e-12)
    low = one.intervals.lower.min(), other.intervals.lower.min()
    high = one.intervals.upper.min(), other.intervals.upper.min()
    assert max(low) <= min(high) + 1e-12
    assert max(high) - min(low) <= 2 * GAP


@pytest.mark.parametrize("slack", some_slow([FOREVER, 0.1], {FOREVER}))
def test_threads_change_no_byte(slack):
    case = two_robots(1, n_steps=300)
    one, other = asked(case, slack), asked(case, slack, jobs=3)
    for rows, more in ((one.steps, other.steps), (one.intervals, other.intervals)):
        for column, same in zip(rows, more, strict=True):
            assert column.tobytes() == same.tobytes()
    assert one.intervals_tally == other.intervals_tally


@pytest.mark.slow
def test_against_rational_arithmetic():
    """Steps to the last bits, and no time of either clock on a grid comes nearer than the proof."""
    case = two_robots(5, n_steps=3)
    moments = moments_of(3, 3)
    pairs = measured_pairs(case)[0]
    found = asked(case, FOREVER)
    sq = np.empty((len(moments), len(moments)), dtype=object)
    placed = [
        [exact_bodies(robot, step, share) for step, share in moments] for robot in case.robots
    ]
    for i, bodies_a in enumerate(placed[0]):
        for k, bodies_b in enumerate(placed[1]):
            sq[i, k] = min(
                oracle.polyhedron_distance_sq(
                    bodies_a[pair.a.i_body], faces_of(pair.a.shape_in(case)),
                    bodies_b[pair.b.i_body], faces_of(pair.b.shape_in(case)),
                )
                for pair in pairs
            )  # fmt: skip
    least = np.array([[float(oracle.root(cell)) for cell in line] for line in sq])
    at_steps = least[np.ix_([0, 3, 5], [0, 3, 5])].min(axis=1)
    assert np.allclose(found.steps.clearance, at_steps, rtol=0.0, atol=1e-14)
    sampled = least.min(axis=1).reshape(2, 3).min(axis=1)
    assert (found.intervals.lower <= sampled).all()


def exact_bodies(placed: PlacedRobot, step: float, share: float) -> list:
    """The vertices of each body of a robot, as rationals."""
    positions = kinematic_motion(placed).positions_after(int(step), float(share))
    names = [joint.name for joint in placed.robot.moving_joints]
    values = dict(zip(names, positions.tolist(), strict=True))
    poses = exact_link_poses(placed.robot, values, placed.world_from_base)
    return [exactly_placed(body.shape.vertices, poses[body.name]) for body in placed.robot.bodies]


@pytest.mark.parametrize("aside", [0.0, 0.1])
@pytest.mark.parametrize(("off", "status"), [(0.0, "near"), (-1e-9, "near"), (1e-9, "violated")])
def test_a_limit_that_the_distance_is_equal_to_is_kept(aside, off, status):
    """Two boxes pass each other 0.1 m apart, or come to that at their ends."""
    robots = (
        sliding("a", (0.0, 0.0, 0.0), (aside, 1.0, 0.0)),
        sliding("b", (0.2 + 2.0 * aside, 0.0, 0.0), (-aside, 1.0, 0.0)),
    )
    run = cl.check(cl.Case("equal", robots, (), cl.Limits(0.1 + off, 0.2), clock=cl.Clock(FOREVER)))
    assert run.status == status
    assert run.passed == (
        "equal to the fail limit but for rounding" in run.verdict.at_level or off < 0.0
    )
