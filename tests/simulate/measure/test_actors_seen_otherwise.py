"""Bodies that both move, in one world seen otherwise: on another base, by other names, in another order."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.record.names import sides_in
from clearance.world.body import Body
from clearance.world.case import PlacedRobot
from clearance.world.forest import link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.mount import Mount
from clearance.world.pairs import measured_pairs
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, dented
from tests.simulate.measure.hostile_actors import (
    CUBE,
    is_rigid,
)
from tests.simulate.measure.wandering import N_STEPS, case_of
from tests.strategies import rotations


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
@pytest.mark.parametrize("seed", range(2))
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


@pytest.mark.parametrize("seed", range(2))
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


@pytest.mark.parametrize("seed", range(2))
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
