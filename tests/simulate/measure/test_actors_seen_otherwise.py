"""Bodies that both move, in one world seen otherwise: on another base, by other names, in another order."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.case import PlacedRobot
from clearance.world.mount import Mount
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
