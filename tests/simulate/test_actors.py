"""Hostile pairs of bodies that both move, against rational arithmetic, finer samples and what symmetry demands."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.simulate.layout import PairsInMotion
from clearance.simulate.measure import measure
from clearance.simulate.names import sides_in
from clearance.simulate.resources import Resources
from clearance.world.body import Body
from clearance.world.carry import Carry
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.forest import link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.mount import Mount
from clearance.world.pairs import measured_pairs
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.timing import Window
from clearance.world.trajectory import Trajectory
from tests import oracle
from tests.examples import first_fast
from tests.made_cases import at, dented, faces_of, random_robot
from tests.oracle.kinematics import link_poses, on, placed, seen_from
from tests.simulate.certified import assert_as_tight_as_asked
from tests.simulate.wandering import N_STEPS, case_of, every_distance, poses_of, wandering
from tests.strategies import rotations

NEEDLE, SLAB, CUBE = (1.0, 1e-4, 1e-4), (0.6, 0.6, 1e-3), (0.2, 0.2, 0.2)
NEAR_ORIGIN, FAR_OFF = (0.0, 0.0, 0.0), (700.0, -1300.0, 400.0)


def chain(name: str, random: np.random.Generator, n_joints: int, shapes: dict[int, tuple]) -> Robot:
    """Joints of any kind behind one another, and boxes on some of the links, turned as they come."""
    robot = random_robot(random, n_joints, sizes=(0.0, 0.3), mimics=0.1)
    bodies = tuple(
        Body(robot.link_names[link], box(size).transformed(at(turned=rotations(random, 1)[0])))
        for link, size in shapes.items()
    )
    return replace(robot, name=name, bodies=bodies)


def every(case: cl.Case) -> np.ndarray:
    """(steps, pairs) [m] as the sweep finds them."""
    pairs, _ = measured_pairs(case)
    motions = [kinematic_motion(robot) for robot in case.robots]
    return measure(PairsInMotion(case, motions, pairs), "pairs", Resources(jobs=1)).every


def exact_poses(placed_robot: PlacedRobot, step: int) -> dict:
    """Of all links of a robot that stands in the world, at a step."""
    asked = placed_robot.asked
    values = dict(zip(asked.joint_names, asked.positions[step].tolist(), strict=True))
    return link_poses(placed_robot.robot, values, placed_robot.world_from_base)


def exact_sq(one: cl.Polyhedron, pose_one, other: cl.Polyhedron, pose_other) -> Fraction:
    """The squared distance of two solids at exact poses."""
    return oracle.solid_distance_sq(
        placed(one.vertices, pose_one),
        faces_of(one),
        placed(other.vertices, pose_other),
        faces_of(other),
    )


def exact_errors(case: cl.Case, steps: range) -> Iterator[float]:
    """[m] How far each pair is off at some steps; of a case of robots and obstacles that stand in the world."""
    pairs, _ = measured_pairs(case)
    found = every(case)
    for step in steps:
        by_robot = [exact_poses(robot, step) for robot in case.robots]

        def pose_of(body, by_robot=by_robot):
            if body.is_obstacle:
                return case.obstacles[body.i_body].world_from_body
            return by_robot[body.i_robot][body.own_name_in(case)]

        for i_pair, pair in enumerate(pairs):
            sq = exact_sq(
                pair.a.shape_in(case), pose_of(pair.a), pair.b.shape_in(case), pose_of(pair.b)
            )
            yield float(oracle.error(float(found[step, i_pair]), sq))


@pytest.mark.parametrize("origin", [NEAR_ORIGIN, FAR_OFF])
@pytest.mark.parametrize("seed", first_fast(range(4), 1))
def test_two_robots_of_needles_and_slabs_are_as_far_apart_as_is_exact(seed, origin):
    """Of rounding, far from the origin, there is some 2^-52 of the coordinates in each of a few sums."""
    random = np.random.default_rng(seed)
    robots = []
    for name in ("left", "right"):
        robot = chain(name, random, 5, {1: CUBE, 3: SLAB, 5: NEEDLE})
        base = at(*(np.array(origin) + random.normal(0.0, 0.6, 3)), turned=rotations(random, 1)[0])
        path = wandering(random, robot, cubic=False)
        robots.append(PlacedRobot(robot, path, base, self_clearance=SelfClearance()))
    case = cl.Case("hostile", tuple(robots), ())
    size = 1.0 + np.abs(origin).max()
    assert max(exact_errors(case, range(0, N_STEPS, 20))) < 2e-14 * size


@pytest.mark.parametrize("gap", [1e-7, 1e-4])
def test_parallel_slabs_that_both_slide_keep_their_exact_gap(gap):
    """Everything is equally near all the time, and both bodies move far more than they are apart."""
    slab = box((0.5, 0.5, 0.01))
    robots = tuple(
        PlacedRobot(
            Robot(
                name,
                ("base", "slide", "plate"),
                (
                    Joint(
                        "x",
                        JointKind.PRISMATIC,
                        "base",
                        "slide",
                        np.eye(4),
                        np.array([1.0, 0.0, 0.0]),
                    ),
                    Joint(
                        "y",
                        JointKind.PRISMATIC,
                        "slide",
                        "plate",
                        np.eye(4),
                        np.array([0.0, 1.0, 0.0]),
                    ),
                ),
                (Body("plate", slab),),
            ),
            Trajectory(np.linspace(0.0, 1.0, 30), ("x", "y"), np.linspace((0, 0), way, 30)),
            at(z=height),
        )
        for name, way, height in (
            ("below", (0.25, 0.125), 0.0),
            ("above", (-0.125, 0.25), 0.01 + gap),
        )
    )
    run = cl.check(cl.Case("parallel", robots, ()))
    assert max(exact_errors(run.record.case, range(0, 30, 7))) < 1e-16
    assert (run.certificate.lower_bound >= gap - run.certificate.gap).all()
    assert (run.certificate.lower_bound <= run.record.clearances).all()


@pytest.mark.parametrize("seed", first_fast(range(3), 1))
def test_two_bodies_with_a_long_chain_between_are_as_far_apart_as_is_exact(seed):
    """36 joints between, of which some follow others; each adds its rounding of coordinates of some metres."""
    random = np.random.default_rng(seed)
    robot = chain("snake", random, 38, {1: CUBE, 2: SLAB, 37: CUBE, 38: NEEDLE})
    base = at(1.0, 2.0, 3.0, turned=rotations(random, 1)[0])
    asked = SelfClearance()
    snake = PlacedRobot(robot, wandering(random, robot, cubic=False), base, self_clearance=asked)
    case = cl.Case("snake", (snake,), ())
    pairs, _ = measured_pairs(case)
    n_between = [
        abs(
            robot.link_names.index(p.a.own_name_in(case))
            - robot.link_names.index(p.b.own_name_in(case))
        )
        for p in pairs
    ]
    assert max(n_between) >= 36
    assert max(exact_errors(case, range(0, N_STEPS, 12))) < 2e-13


CARRIED_FROM, CARRIED_UNTIL = 0.71, 2.23


def carrying(seed: int) -> cl.Case:
    """A robot that takes up a part with its last link, carries it past its other links, and lets it go."""
    random = np.random.default_rng(seed)
    robot = chain("arm", random, 6, {0: CUBE, 1: SLAB, 2: CUBE, 4: NEEDLE, 6: CUBE})
    arm = PlacedRobot(
        robot,
        wandering(random, robot, cubic=False),
        at(0.3, -0.2, 0.5, turned=rotations(random, 1)[0]),
        exclude_links=tuple(robot.link_names[k] for k in (1, 2)),
        self_clearance=SelfClearance(),
    )
    shape = dented(random, 1, depth=0.3, radius=0.15)
    part = cl.Obstacle(
        Body("part", shape), at(*random.normal(0.0, 0.5, 3), turned=rotations(random, 1)[0])
    )
    carry = Carry("part", "l6", Window(CARRIED_FROM, CARRIED_UNTIL))
    return cl.Case("carrying", (arm,), (part,), carries=(carry,))


@pytest.mark.parametrize("seed", range(4))
def test_a_body_and_a_part_carried_on_its_own_tree_are_as_far_apart_as_is_exact(seed):
    case = carrying(seed)
    run = cl.check(case, certify=False)
    times, clearances = run.record.timeline.times, run.record.clearances
    (arm,), (part,) = case.robots, case.obstacles
    for step in range(0, len(times), 9):
        if times[step] in (CARRIED_FROM, CARRIED_UNTIL):
            continue
        links = exact_poses_at(arm, times[step])
        held = CARRIED_FROM < times[step] < CARRIED_UNTIL
        mates = [body for body in arm.robot.bodies if body.name not in arm.exclude_links]
        least = min(
            exact_sq(body.shape, links[body.name], part.body.shape, exact_part(case, times[step]))
            for body in mates
            if not (held and is_rigid(arm.robot, body.name, "l6"))
        )
        least = min([least, *self_sq(case, links)])
        assert oracle.error(clearances[step], least) < 1e-13


def self_sq(case: cl.Case, links: dict) -> Iterator[Fraction]:
    """Of the pairs of links that are measured."""
    pairs, _ = measured_pairs(case)
    for pair in pairs:
        if not pair.b.is_obstacle:
            one, other = (body.body_in(case) for body in (pair.a, pair.b))
            yield exact_sq(one.shape, links[one.name], other.shape, links[other.name])


def exact_part(case: cl.Case, time: float):
    """Where the part is: as it was picked up, and after it is let go where it was then."""
    (arm,), (part,) = case.robots, case.obstacles
    if time <= CARRIED_FROM:
        return part.world_from_body
    grip = seen_from(exact_poses_at(arm, CARRIED_FROM)["l6"], part.world_from_body)
    return on(exact_poses_at(arm, min(time, CARRIED_UNTIL))["l6"], grip)


def exact_poses_at(arm: PlacedRobot, time: float) -> dict:
    """Of all links; between samples the joints are interpolated in rational numbers."""
    asked = arm.asked
    after = int(np.clip(np.searchsorted(asked.times, time), 1, asked.n_steps - 1))
    first, last = (Fraction(float(t)) for t in asked.times[after - 1 : after + 1])
    share = (Fraction(float(time)) - first) / (last - first)
    values = {
        name: float(Fraction(a) + share * (Fraction(b) - Fraction(a)))
        for name, a, b in zip(
            asked.joint_names,
            asked.positions[after - 1].tolist(),
            asked.positions[after].tolist(),
            strict=True,
        )
    }
    return link_poses(arm.robot, values, arm.world_from_base)


def is_rigid(robot: Robot, one: str, other: str) -> bool:
    """True if only fixed joints are between two links of a chain."""
    low, high = sorted(robot.link_names.index(name) for name in (one, other))
    return all(joint.kind is JointKind.FIXED for joint in robot.joints[low:high])


def finer(case: cl.Case, times: np.ndarray) -> cl.Case:
    """The case with samples at these times of all robots, which move linearly between their own."""
    robots = []
    for robot in case.robots:
        asked = robot.asked
        columns = [np.interp(times, asked.times, column) for column in asked.positions.T]
        path = Trajectory(times, asked.joint_names, np.stack(columns, axis=1))
        robots.append(replace(robot, trajectory=path))
    return replace(case, robots=tuple(robots))


@pytest.mark.parametrize("seed", range(5))
def test_no_bound_on_two_moving_bodies_is_above_samples_a_thousand_times_finer(seed):
    """Dented bodies that turn by up to a radian a step, apart from each other by less than they move."""
    random = np.random.default_rng(seed)
    robots = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        robot = random_robot(random, 4, sizes=(0.05,))
        robot = replace(
            robot, name=name, bodies=(Body("l4", dented(random, 2, depth=0.4, radius=0.15)),)
        )
        names = tuple(joint.name for joint in robot.moving_joints)
        steps = random.uniform(-1.0, 1.0, (8, len(names))) * 0.4
        slides = [joint.kind is JointKind.PRISMATIC for joint in robot.moving_joints]
        steps[:, slides] *= 0.05
        path = Trajectory(np.arange(8.0), names, steps.cumsum(axis=0))
        robots.append(PlacedRobot(robot, path, at(side * random.uniform(0.2, 0.3))))
    case = cl.Case("turning", tuple(robots), ())
    run = cl.check(case)
    bounds, clearances = run.certificate.lower_bound, run.record.clearances
    for step in {int(np.argmin(bounds[:-1])), *random.integers(0, 7, 2).tolist()}:
        times = np.linspace(step, step + 1.0, 1001)
        sampled = cl.check(finer(case, times), certify=False).record.clearances
        assert bounds[step] <= sampled.min() + 1e-12
        assert sampled.min() <= run.certificate.upper_bound[step] + 1e-4
    assert (bounds <= clearances).all()
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("faster", ["left", "right"])
@pytest.mark.parametrize("seed", range(3))
def test_tips_that_pass_each_other_between_two_samples_are_seen(seed, faster):
    """Two blades turn to and fro about their middles, one far and one a little; in between both tips point in."""
    random = np.random.default_rng(seed)
    blade = box((0.6, 0.04, 0.04))
    robots = []
    for name, side in (("left", -0.31), ("right", 0.31)):
        spin = Joint(
            "spin", JointKind.CONTINUOUS, "base", "blade", np.eye(4), np.array([0.0, 0.0, 1.0])
        )
        far = random.uniform(0.5, 1.0, 9) if name == faster else random.uniform(0.0, 0.01, 9)
        path = Trajectory(np.arange(9.0), ("spin",), (far * (-1.0) ** np.arange(9))[:, None])
        robot = Robot(name, ("base", "blade"), (spin,), (Body("blade", blade),))
        robots.append(PlacedRobot(robot, path, at(side, 0.0, 0.01 * seed)))
    case = cl.Case("blades", tuple(robots), ())
    run = cl.check(case)
    sampled = cl.check(finer(case, np.linspace(0.0, 8.0, 8001)), certify=False).record.clearances
    dips = [sampled[1000 * k : 1000 * k + 1001].min() for k in range(8)]
    assert (run.certificate.lower_bound[:-1] <= np.array(dips) + 1e-12).all()
    assert min(dips) < run.record.clearances.min() - 1e-3
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("seed", range(2))
def test_no_bound_on_a_part_that_changes_hands_within_an_interval_is_above_finer_samples(seed):
    """The hand-over is at no sample: the steps about it are its own."""
    case = carrying(seed)
    run = cl.check(case)
    times, bounds = run.record.timeline.times, run.certificate.lower_bound
    assert {CARRIED_FROM, CARRIED_UNTIL} <= set(times.tolist())
    for first in np.flatnonzero(np.isin(times, (CARRIED_FROM, CARRIED_UNTIL))) - 1:
        fine = np.linspace(times[first], times[first + 2], 1001)
        edges = np.array([0.0, CARRIED_FROM, CARRIED_UNTIL, 3.0])
        sampled = cl.check(finer(case, np.union1d(fine, edges)), certify=False).record
        within = (sampled.timeline.times >= times[first]) & (
            sampled.timeline.times <= times[first + 2]
        )
        assert bounds[first : first + 2].min() <= sampled.clearances[within].min() + 1e-12


@pytest.mark.parametrize("seed", range(3))
def test_a_body_that_turns_by_half_a_turn_between_two_samples_is_followed_all_the_way(seed):
    """The robot moves too; between the samples of the pose table the body sweeps a half circle."""
    random = np.random.default_rng(seed)
    robot = random_robot(random, 3, sizes=(0.1,))
    robot = replace(robot, bodies=(Body("l3", dented(random, 1, depth=0.3, radius=0.1)),))
    path = wandering(random, robot, cubic=False)
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    half = np.array([[0.0, 0.0, 0.0, 1.0], [*axis, 6e-17]])
    table = PoseTable(np.array([0.0, 3.0]), np.array([[0.5, 0.0, 0.0], [0.5, 0.1, 0.0]]), half)
    blade = cl.Obstacle(Body("blade", box((0.6, 0.05, 0.05))), moves=table)
    few = np.linspace(0.0, 3.0, 7)
    case = finer(cl.Case("half", (PlacedRobot(robot, path),), (blade,)), few)
    run = cl.check(case)
    sampled = cl.check(finer(case, np.linspace(0.0, 3.0, 6001)), certify=False).record
    step = np.clip(np.searchsorted(few, sampled.timeline.times, side="right") - 1, 0, 5)
    assert (run.certificate.lower_bound[step] <= sampled.clearances + 1e-12).all()
    turns = sampled.clearances.max() - sampled.clearances.min()
    assert turns > 0.01 and len(run.record.timeline.times) == 7


def glued(case: cl.Case, base: str, pose: np.ndarray) -> cl.Case:
    """The same world on something else: all that stood in the world stands on `base`, at `pose`."""
    robots = tuple(
        replace(robot, world_from_base=np.eye(4), mount=Mount(base, pose @ robot.world_from_base))
        for robot in case.robots
    )
    obstacles = tuple(
        cl.Obstacle(o.body, mount=Mount(base, pose @ o.world_from_body), padding=o.padding)
        for o in case.obstacles
    )
    return replace(case, robots=robots, obstacles=obstacles)


def stage(*, turns: bool) -> PlacedRobot:
    """A turntable without geometry, which stands askew."""
    joint = Joint(
        "turn", JointKind.CONTINUOUS, "floor", "plate", at(0.1, 0.2, 0.3), np.array([0.0, 0.6, 0.8])
    )
    times = np.linspace(0.0, 3.0, N_STEPS)
    turned = (2.0 * times if turns else np.full(N_STEPS, 0.7))[:, None]
    base = at(-2.0, 1.0, 0.5, turned=rotations(np.random.default_rng(9), 1)[0])
    return PlacedRobot(
        Robot("stage", ("floor", "plate"), (joint,), ()), Trajectory(times, ("turn",), turned), base
    )


def rootless(case: cl.Case) -> cl.Case:
    """Without the links that stand where the base does: on a stage they are rigid with what stands beside them."""
    robots = []
    for robot in case.robots:
        still = [
            n for n in robot.robot.link_names if is_rigid(robot.robot, n, robot.robot.link_names[0])
        ]
        robots.append(replace(robot, exclude_links=tuple(still)))
    return replace(case, robots=tuple(robots))


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_gluing_the_world_to_another_base_changes_no_answer(seed, turns):
    """Neither to one that stands askew nor to one that turns all the while."""
    case = rootless(case_of(seed, 2))
    pose = at(0.4, -0.3, 1.1, turned=rotations(np.random.default_rng(seed + 50), 1)[0])
    on_stage = glued(case, "stage/plate", pose)
    on_stage = replace(on_stage, robots=(*on_stage.robots, stage(turns=turns)))
    one, other = cl.check(case), cl.check(on_stage)
    assert one.record.clearances == pytest.approx(other.record.clearances, abs=1e-9)
    gap = one.certificate.gap
    assert one.certificate.lower_bound == pytest.approx(
        other.certificate.lower_bound, abs=gap + 1e-9
    )
    columns = ["body_a", "body_b", "status"]
    apart = one.record.clearances > 0.0
    assert [
        row for row, far in zip(one.steps.select(columns).to_pylist(), apart, strict=True) if far
    ] == [
        row for row, far in zip(other.steps.select(columns).to_pylist(), apart, strict=True) if far
    ]


def test_gluing_the_world_to_an_obstacle_that_stands_changes_no_answer():
    case = rootless(case_of(2, 2))
    pose = at(0.4, -0.3, 1.1, turned=rotations(np.random.default_rng(3), 1)[0])
    slab = cl.Obstacle(
        Body("slab", box((0.1, 0.1, 0.1))), at(40.0, 0.0, 0.0, turned=pose[:3, :3].T)
    )
    on_slab = glued(case, "slab", pose)
    on_slab = replace(on_slab, obstacles=(*on_slab.obstacles, slab), allow=(("*", "slab"),))
    one, other = cl.check(case), cl.check(on_slab)
    assert one.record.clearances == pytest.approx(other.record.clearances, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_swapping_the_names_of_two_robots_changes_only_names(seed):
    case = case_of(seed, 2)
    new = {"r0": "r1", "r1": "r0"}
    swapped = replace(
        case,
        robots=tuple(
            replace(robot, robot=replace(robot.robot, name=new[robot.robot.name]))
            for robot in case.robots
        ),
    )
    one, other = (cl.check(each, need="pairs") for each in (case, swapped))
    assert one.record.clearances.tobytes() == other.record.clearances.tobytes()
    assert one.certificate.lower_bound.tobytes() == other.certificate.lower_bound.tobytes()

    def renamed(name: str) -> str:
        robot, slash, link = name.partition("/")
        return f"{new[robot]}/{link}" if slash else name

    for table in ("steps", "pairs"):
        rows, others = (getattr(run, table).to_pylist() for run in (one, other))
        for row in rows:
            for side in sides_in(list(row)):
                row[side] = renamed(row[side])
        assert rows == others


@pytest.mark.parametrize("seed", range(4))
def test_the_order_of_two_robots_changes_no_answer(seed):
    case = case_of(seed, 2)
    turned = replace(case, robots=case.robots[::-1])
    one, other = (cl.check(each) for each in (case, turned))
    assert one.record.clearances == pytest.approx(other.record.clearances, abs=1e-12)
    gap = one.certificate.gap
    assert one.certificate.lower_bound == pytest.approx(other.certificate.lower_bound, abs=gap)


@pytest.mark.parametrize("seed", range(3))
def test_what_rides_on_a_link_stays_as_far_from_it_and_from_what_is_rigid_with_it(seed):
    """Such pairs are left out with the reason; their bodies are as far apart at every step."""
    random = np.random.default_rng(seed)
    case = case_of(seed, 1)
    (arm,) = case.robots
    last = arm.robot.link_names[-1]
    flange = Joint(
        "weld", JointKind.FIXED, last, "flange", at(0.0, 0.0, 0.4), np.array([1.0, 0.0, 0.0])
    )
    robot = replace(
        arm.robot,
        link_names=(*arm.robot.link_names, "flange"),
        joints=(*arm.robot.joints, flange),
        bodies=(*arm.robot.bodies, Body("flange", box((0.1, 0.1, 0.05)))),
    )
    camera = cl.Obstacle(
        Body("camera", box((0.05, 0.05, 0.1))),
        mount=Mount(last, at(0.5, 0.1, 0.0, turned=rotations(random, 1)[0])),
    )
    case = replace(case, robots=(replace(arm, robot=robot),), obstacles=(*case.obstacles, camera))
    run = cl.check(case, certify=False)
    left_out = {(row.link, row.obstacle): row.reason for row in run.record.unmeasured}
    assert left_out["flange", "camera"] == "moves with it"
    motions = [kinematic_motion(each) for each in case.robots]
    poses = link_poses_at(case, motions, slice(None))
    bodies = {
        body.name_in(case): body for pair in measured_pairs(case)[0] for body in (pair.a, pair.b)
    }
    of_flange, of_camera = (bodies[name].poses_in(case, poses) for name in ("flange", "camera"))
    apart = [
        cl.distance(bodies["flange"].shape_in(case), camera.body.shape, pose_a=a, pose_b=b).distance
        for a, b in zip(of_flange, of_camera, strict=True)
    ]
    assert np.ptp(apart) < 1e-14 and min(apart) > 0.0


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_what_moves_by_itself_exactly_with_a_link_has_constant_clearance_to_it(need):
    """The link turns about an axis and the obstacle's pose table turns about the same one at the same rate."""
    axis, base = np.array([0.0, 0.0, 1.0]), at(0.2, 0.1, 0.3)
    spin = Joint("spin", JointKind.CONTINUOUS, "base", "wheel", np.eye(4), axis)
    rigid = Joint("weld", JointKind.FIXED, "wheel", "tip", at(0.3), axis)
    bodies = (Body("wheel", box((0.2, 0.2, 0.1))), Body("tip", box((0.05, 0.05, 0.3))))
    robot = Robot("wheel", ("base", "wheel", "tip"), (spin, rigid), bodies)
    times = np.linspace(0.0, 3.0, 25)
    angles = 2.0 * times
    half = 0.5 * angles
    quaternions = np.stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)], axis=1)
    table = PoseTable(times, np.tile(base[:3, 3], (25, 1)), quaternions)
    shape = dented(np.random.default_rng(1), 1, depth=0.2, radius=0.1).transformed(
        at(0.0, 0.4, 0.1)
    )
    wheel = PlacedRobot(robot, Trajectory(times, ("spin",), angles[:, None]), base)
    case = cl.Case("wheel", (wheel,), (cl.Obstacle(Body("moon", shape), moves=table),))
    run = cl.check(case, need=need)
    assert np.ptp(every(case), axis=0) == pytest.approx(0.0, abs=1e-14)
    assert np.ptp(run.record.clearances) < 1e-14
    assert (run.certificate.lower_bound >= run.record.clearances - run.certificate.gap).all()
    assert (run.certificate.lower_bound <= run.record.clearances).all()


@pytest.mark.parametrize("seed", range(4))
def test_a_part_on_a_link_is_as_near_as_if_it_were_of_the_link(seed):
    """To the scene and to another robot, at every step and between."""
    random = np.random.default_rng(seed)
    case = case_of(seed, 2)
    robots = tuple(replace(robot, self_clearance=None) for robot in case.robots)
    first = robots[0].robot
    last = first.link_names[-1]
    alone = replace(
        first,
        bodies=tuple(body for body in first.bodies if body.name == last)
        or (Body(last, box(CUBE)),),
    )
    shape = dented(random, 1, depth=0.3, radius=0.1)
    pose = at(0.2, 0.0, 0.1, turned=rotations(random, 1)[0])
    whole = cl.Polyhedron.merged([alone.bodies[-1].shape, shape.transformed(pose)])
    merged = replace(alone, bodies=(Body(last, whole),))
    mounted = cl.Obstacle(Body("part", shape), mount=Mount(f"r0/{last}", pose))
    as_part = replace(
        case,
        robots=(replace(robots[0], robot=alone), robots[1]),
        obstacles=(*case.obstacles, mounted),
    )
    as_link = replace(case, robots=(replace(robots[0], robot=merged), robots[1]))
    one, other = cl.check(as_part), cl.check(as_link)
    assert one.record.clearances == pytest.approx(other.record.clearances, abs=1e-12)
    gap = one.certificate.gap
    assert one.certificate.lower_bound == pytest.approx(other.certificate.lower_bound, abs=gap)


@pytest.mark.parametrize("seed", range(2))
def test_single_questions_agree_where_a_robot_stands_on_another(seed):
    """The second robot's base rides on the first one's last link."""
    case = case_of(seed, 2)
    lower, upper = case.robots
    mount = Mount(f"r0/{lower.robot.link_names[-1]}", at(0.0, 0.0, 0.5))
    case = replace(case, robots=(lower, replace(upper, world_from_base=np.eye(4), mount=mount)))
    assert poses_of(case).shape[0] == N_STEPS
    assert every(case) == pytest.approx(every_distance(case), abs=1e-9)
