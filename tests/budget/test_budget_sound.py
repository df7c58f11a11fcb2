"""No error that a budget allows brings bodies nearer than what is proven of steps and the motion between.

Nor do errors of parts that are drawn anew for every moment at which they change hands.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.budget.expected import deviations, witness_of
from clearance.budget.proven import PairsWithErrors, PathMoments, proven_between, proven_of_steps
from clearance.errors import BadInput
from clearance.kernels.budget.sweep import FEW, REFINED_OF_MANY
from clearance.simulate.measure.measure import measure
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.timing import Timing
from clearance.world.trajectory import Trajectory
from tests.budget.budget_cases import (
    X,
    arm_robot,
    bar,
    cart_table,
    pair_names,
    proven_sections,
    random_budget,
    random_case,
    sections_of,
    swinging,
)
from tests.budget.sampled_machine import HandlingMachine, SampledMachine
from tests.made_cases import at
from tests.strategies import rotations

GAP, ROUNDING = 1e-3, 1e-12

CUBE = cl.box([0.1, 0.1, 0.1])


def slider(positions, velocities=None, mimics=()) -> Case:
    """Cubes on slides one after the other along x, the last of them 0.2 m before another cube."""
    joints = [Joint("a", JointKind.PRISMATIC, "base", "l0", at(), X)]
    for i, factor in enumerate(mimics):
        before = joints[-1]
        joints.append(
            Joint(
                "bcd"[i], JointKind.PRISMATIC, before.child, f"l{i + 1}", at(), X,
                mimic=Mimic(before.name, factor),
            )
        )  # fmt: skip
    last = joints[-1].child
    links = ("base", *(joint.child for joint in joints))
    robot = Robot("slider", links, tuple(joints), (Body(last, CUBE),))
    table = Trajectory(np.arange(float(len(positions))), ("a",), positions, velocities)
    return Case("slider", (PlacedRobot(robot, table),), (Obstacle(Body("o", CUBE), at(0.3)),))


def with_cubics(case: Case, rng: np.random.Generator) -> Case:
    """The case with velocities that are not those of the chords."""
    robots = []
    for placed in case.robots:
        t = placed.trajectory
        rates = np.gradient(t.positions, t.times, axis=0)
        scale = np.where(np.array(t.joint_names) == "left", 0.02, 0.5)
        rates = rates + scale * rng.normal(size=rates.shape)
        robots.append(
            replace(placed, trajectory=Trajectory(t.times, t.joint_names, t.positions, rates))
        )
    return replace(case, robots=tuple(robots))


def on_a_cart(case: Case, rng: np.random.Generator) -> Case:
    """The case whose second robot stands on something that moves and turns."""
    times = case.robots[0].trajectory.times
    half = 0.1 * times
    table = PoseTable(
        times,
        [0.0, 0.0, 0.3] + 0.05 * times[:, None] * rng.normal(size=3),
        np.column_stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)]),
    )
    second, post = (
        case.robots[1],
        Obstacle(Body("post", cl.box([0.02, 0.02, 0.02])), at(2.0, 2.0, -0.5)),
    )
    cart = Obstacle(Body("cart", cl.box([0.05, 0.05, 0.05])), mount=Mount("post"), moves=table)
    place = np.linalg.inv(post.world_from_body @ at(0.0, 0.0, 0.3)) @ second.world_from_base
    rides = replace(second, world_from_base=np.eye(4), mount=Mount("cart", place))
    return replace(case, robots=(case.robots[0], rides), obstacles=(*case.obstacles, post, cart))


KINDS = {
    "two robots, clocks": (2, ()),
    "concave, cubics, clock": (1, (with_cubics,)),
    "two robots, cubics, one on a cart": (14, (with_cubics, on_a_cart)),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_errors_come_below_what_is_proven_between_steps(kind):
    seed, changes = KINDS[kind]
    rng = np.random.default_rng(seed)
    case = replace(random_case(seed, n_steps=6), tolerance=None)
    for change in changes:
        case = change(case, rng)
    case = replace(case, tolerance=random_budget(case, rng, timing=True))
    machine, n_looked = SampledMachine(case), 0
    for section, _, _, steps, between in proven_sections(case, GAP):
        times, names = section.phase.times, pair_names(case, section)
        for i in range(len(times) - 1):
            for share, bound in ((0.0, steps.proven[i]), (rng.random(), between.proven[i])):
                time = times[i] + share * (times[i + 1] - times[i])
                pair = min(names, key=lambda p, time=time: machine.left(time, {}, p))
                left = machine.as_bad_as_found(time, pair, machine.random(rng))
                assert bound <= left + ROUNDING
                n_looked += bound > 0.0
    assert n_looked >= 5


def test_a_cubic_that_goes_out_and_back_between_two_steps_is_not_passed_over():
    """Half way the slide is a quarter of 0.4 m nearer, and at both steps where it was before."""
    rates = np.zeros((6, 1))
    rates[2:4, 0] = 0.4, -0.4
    case = slider(np.zeros((6, 1)), rates)
    tolerance = Budget({"slider": RobotTolerance({"a": JointTolerance(0.001)})})
    case = replace(case, tolerance=tolerance)
    ((_, _, _, steps, between),) = proven_sections(case, GAP)
    assert steps.proven == pytest.approx(0.199)
    assert 0.099 - GAP <= between.proven[2] <= 0.099
    assert between.proven[1] >= 0.199 - GAP  # there it swings away


def test_a_follower_of_a_follower_has_the_errors_of_both():
    """0.001 of a; of b 0.001 and its own 0.002; of c twice that of b, and its own 0.0005."""
    case = slider(np.zeros((2, 1)), mimics=(1.0, -2.0))
    sizes = {"a": 0.001, "b": 0.002, "c": 0.0005}
    own = RobotTolerance({name: JointTolerance(size) for name, size in sizes.items()})
    case = replace(case, tolerance=Budget({"slider": own}))
    ((_, _, _, steps, _),) = proven_sections(case)
    assert steps.proven[0] == pytest.approx(0.2 - 0.001 - 0.003 - 0.0065, abs=1e-12)
    (budget,) = cl.check(case).record.budget
    expected = 0.2 - 3.0 * np.sqrt((0.0 * 0.001) ** 2 + 0.002**2 + 0.0005**2) / np.sqrt(3.0)
    assert budget.expected[0] == pytest.approx(expected, abs=1e-9)


def test_a_clock_at_the_ends_of_the_path_stands():
    """At 0.2 m/s a clock that is 0.1 s off takes 0.02 m, and nothing where the slide stands."""
    table = Trajectory(np.array([0.0, 0.5, 1.0]), ("a",), np.array([[0.0], [0.1], [0.1]]))
    case = slider(np.zeros((2, 1)))
    late = Budget({"slider": RobotTolerance(timing=0.1)})
    robots = (replace(case.robots[0], trajectory=table),)
    ((_, _, _, steps, between),) = proven_sections(
        replace(case, robots=robots, tolerance=late), GAP
    )
    assert steps.proven[[0, 2]] == pytest.approx([0.18, 0.1], abs=1e-9)
    assert 0.08 - 1e-9 <= steps.proven[1] <= 0.1  # it is no straight way about this time
    assert (between.proven[:2] <= 0.1).all()
    assert (between.proven[:2] >= 0.08 - 2.0 * GAP).all()


def test_a_late_clock_of_what_loops_is_refused():
    case = slider(np.zeros((2, 1)))
    times = np.array([0.0, 0.5, 1.0])
    places = np.array([[0.3, 0.0, 0.0], [0.35, 0.0, 0.0], [0.3, 0.0, 0.0]])
    table = PoseTable(times, places, np.tile([0.0, 0.0, 0.0, 1.0], (3, 1)), Timing(after="loop"))
    loops = replace(case.obstacles[0], moves=table, world_from_body=np.eye(4))
    case = replace(case, obstacles=(loops,))
    cl.check(replace(case, tolerance=Budget({}, {"o": ObstacleTolerance(surface=0.001)})))
    late = Budget({}, {"o": ObstacleTolerance(timing=0.01)})
    with pytest.raises(BadInput, match="'o' may be off, and it loops"):
        cl.check(replace(case, tolerance=late))


@pytest.mark.slow
def test_the_deviation_of_clocks_is_that_of_drawn_errors():
    """Within 10 %, of the points that are nearest, where the path is nearly straight."""
    rng = np.random.default_rng(2)
    case = with_cubics(random_case(2, n_steps=6), rng)
    robots = {p.robot.name: RobotTolerance(timing=0.01) for p in case.robots}
    budget = Budget(robots, {o.name: ObstacleTolerance() for o in case.obstacles})
    case = replace(case, tolerance=budget)
    machine = SampledMachine(case)
    ((section, found, _, _, _),) = proven_sections(case)
    n = 3
    pair = pair_names(case, section)[int(found.pair[n])]
    witness = witness_of(
        case, budget, section.phase.motions, section.pairs[int(found.pair[n])],
        np.array([n]), found.points[[n]],
    )  # fmt: skip
    length = machine.apart(section.phase.times[n], pair, witness.points[0])
    lengths = [
        length({key: rng.uniform(-most, most, 1) for key, (most, _) in machine.most.items()})
        for _ in range(800)
    ]
    assert np.std(lengths) == pytest.approx(deviations(case, budget, witness)[0], rel=0.1)


def test_the_motion_is_proven_of_pairs_of_every_padding():
    """Pairs of another padding are asked by themselves; the nearer of both counts, whichever comes last."""
    tolerance = Budget({"slider": RobotTolerance({"a": JointTolerance(0.001)})})
    case = replace(slider(np.zeros((3, 1))), tolerance=tolerance)
    far = Obstacle(Body("far", CUBE), at(0.5, 0.3), padding=0.01)
    for obstacles in ((*case.obstacles, far), (far, *case.obstacles)):
        (budget,) = cl.check(replace(case, obstacles=obstacles)).record.budget
        assert budget.between[:-1] == pytest.approx(budget.proven[:-1], abs=1e-3)


def test_padding_is_taken_off_all_that_is_left():
    """Of steps, of the motion between and of what is expected, and of the worst moment."""
    rates = np.array([[0.4], [-0.4]])
    tolerance = Budget({"slider": RobotTolerance({"a": JointTolerance(0.001)})})
    case = replace(slider(np.zeros((2, 1)), rates), tolerance=tolerance)
    padded = replace(case, obstacles=(replace(case.obstacles[0], padding=0.01),))
    runs = [cl.check(one) for one in (case, padded)]
    before, after = (run.record.budget[0] for run in runs)
    for name in ("proven", "between", "expected", "expected_between"):
        less = pytest.approx(getattr(before, name) - 0.01, abs=1e-9, nan_ok=True)
        assert getattr(after, name) == less and np.isfinite(getattr(after, name)[0])
    worst = [run.session.least_left(run.record.budget[0])[0].proven for run in runs]
    assert worst[1] == pytest.approx(worst[0] - 0.01, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", (1, 2))
def test_no_errors_come_below_what_is_proven_of_many_steps(seed):
    """So many that a search goes on from where the one of the step before has ended; of the two nearest pairs."""
    case, rng = random_case(seed, n_steps=FEW + 8), np.random.default_rng(seed)
    machine = SampledMachine(case)
    for section, found, _, steps, _ in proven_sections(case):
        free = np.flatnonzero(found.clearance > 0.0)
        for step in free[np.argsort(steps.proven[free])[:2]]:
            time, names = section.phase.times[step], pair_names(case, section)
            for pair in sorted(names, key=lambda p, t=time: machine.left(t, {}, p))[:2]:
                for _ in range(4):
                    left = machine.left(time, machine.random(rng), pair)
                    assert steps.proven[step] <= left + ROUNDING


def test_many_steps_are_little_looser_than_each_alone_their_least_is_not_and_all_is_the_same_again():
    case = random_case(1, n_steps=FEW + 8)
    for _, found, pairs, steps, _ in proven_sections(case):
        at, alone = pairs.steps, np.empty(len(pairs.steps))
        for i in range(len(at)):
            one = slice(i, i + 1)
            moment = PathMoments(at.intervals[one], at.shares[one])
            alone[i] = pairs.at(moment, found.pair[one], found.clearance[one]).proven[0]
        free = found.clearance > 0.0
        taken = found.clearance - alone
        assert (steps.proven >= alone - 2.0 * REFINED_OF_MANY * taken)[free].all()
        assert steps.proven.min() >= alone.min() - 1e-9
        again = proven_of_steps(pairs, found)  # in a scene that others have worked with
        assert (again.proven == steps.proven).all() and (again.pair == steps.pair).all()


def test_what_only_turns_is_seen_to_move():
    """A bar that turns about its end by a table of its own, beside an arm that stands."""
    path = swinging(arm_robot(), np.random.default_rng(1), 30).trajectory
    stands = Trajectory(path.times, path.joint_names, 0.0 * path.positions)
    half = np.linspace(0.0, -0.5, 30)
    turns = np.column_stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)])
    cart = Obstacle(
        Body("cart", bar(0.3)), moves=PoseTable(path.times, [[0.5, 0.35, 0.1]] * 30, turns)
    )
    joints = {j.name: JointTolerance(0.001) for j in arm_robot().joints}
    budget = Budget({"arm": RobotTolerance(joints, PlacementTolerance(0.002, 0.001))})
    placed = PlacedRobot(arm_robot(), stands)
    for _, found, _, steps, _ in proven_sections(
        Case("cart", (placed,), (cart,), tolerance=budget)
    ):
        assert (steps.proven <= found.clearance).all()
        assert found.clearance[-1] < found.clearance[0] - 0.05


N_STEPS = 7

N_RANDOM = 3
"""Errors that are drawn, the last of which are made worse."""


def handling(seed: int) -> Case:
    """A part goes from the left arm to the right one, lies, and is put on a cart, which drives on with it.

    At first it stands, or rides on a table, on the left arm's own base, or on the cart, by turns.
    """
    rng = np.random.default_rng(seed)
    turned = rotations(rng, 6)
    away = at(0.9, 0.3, 0.2, turned=turned[0])
    robots = (
        swinging(arm_robot("left"), rng, N_STEPS),
        swinging(arm_robot("right"), rng, N_STEPS, away),
    )
    place = at(*rng.uniform(-0.3, 0.3, 3) + [0.5, 0.6, 0.3], turned=turned[1])
    on = (None, "table", "left/base", "cart")[seed % 4]
    first = {"world_from_body": place} if on is None else {"mount": Mount(on, place)}
    obstacles = (
        Obstacle(Body("part", bar(0.12)), **first),
        Obstacle(Body("label", cl.box([0.03] * 3)), mount=Mount("part", at(0.0, 0.1, 0.05))),
        Obstacle(Body("table", cl.box([0.2, 0.2, 0.05])), at(0.2, -0.7, 0.1, turned=turned[2])),
        Obstacle(Body("post", cl.box([0.05, 0.05, 0.4])), at(0.6, -0.4, 0.1, turned=turned[3])),
        Obstacle(
            Body("cart", cl.box([0.2, 0.1, 0.1])),
            moves=cart_table(rng, N_STEPS, turn=0.4, speed=0.3),
        ),
    )
    exact = (rng.random(3) < 0.25).tolist()
    carries = (
        cl.Carry("part", "left/hand", cl.Window(0.1, 0.3), exact_grasp=exact[0]),
        cl.Carry("part", "right/hand", cl.Window(0.3, 0.4), exact_grasp=exact[1]),
        cl.Carry("part", "cart", cl.Window(0.5), exact_grasp=exact[2]),
    )
    case = Case("handling", robots, obstacles, carries=carries)
    return replace(case, tolerance=random_budget(case, rng))


def of_parts(case: Case):
    """Each section with only the nearest pair of something that changes hands, and that pair with errors."""
    for section in sections_of(case):
        pairs = [pair for pair, named in zip(section.pairs, pair_names(case, section), strict=True)
                 if {"part", "label"} & set(named)]  # fmt: skip
        found = measure(replace(section.in_motion, pairs=tuple(pairs)))
        nearest = pairs[int(found.pair[np.argmin(found.clearance)])]
        alone = replace(section.in_motion, pairs=(nearest,))
        yield replace(section, pairs=(nearest,)), PairsWithErrors(alone, case.tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_no_errors_of_any_moment_come_below_what_is_proven(seed):
    case, rng = handling(seed), np.random.default_rng(seed)
    machine, n_apart = HandlingMachine(case), 0
    for section, pairs in of_parts(case):
        (pair,), times = pair_names(case, section), section.phase.times
        steps = proven_of_steps(pairs, measure(pairs.what))
        between = proven_between(pairs, steps, GAP)
        moments = [*machine.moments(times[0]), machine.NOW]
        i = int(rng.integers(len(times) - 1))
        for time, proven in (
            (times[i], steps.proven[i]),
            (rng.uniform(*times[i : i + 2]), between.proven[i]),
        ):
            n_apart += proven > 0.0
            for _ in range(N_RANDOM):
                errors = {moment: machine.random(rng) for moment in moments}
                assert machine.left_in(times[0], time, errors, pair) >= proven - ROUNDING
    assert machine.nearer(times[0], times[i], pair, errors) >= steps.proven[i] - ROUNDING
    assert n_apart
