"""Receipts with tolerances: no error, at no time, brings parts nearer than is proven, nor parts in hands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadSyntax
from clearance.receipt.case_data import case_data
from clearance.receipt.proof.error_terms import along_of, most_of_balls
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.separation import Sides, centre_of
from clearance.receipt.proof.stage import by_balls, by_directions
from clearance.receipt.proof.views import chain_above
from clearance.world.budget import Budget, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.forest import forest_of
from tests.budget.budget_cases import random_case
from tests.budget.part_cases import carried, off_by, quarter_turn, slid
from tests.budget.sampled_machine import HandlingMachine, SampledMachine
from tests.budget.test_budget_sound import handling
from tests.receipt.receipts import saved, stage_of, turning_arm

ROUNDING = 1e-12
SAMPLES = 12
FAR = 100.0
"""[m] What no bound comes to, so that parts are looked at as closely as can be."""


def rows_of(stage, node: int, rng: np.random.Generator):
    """An item a pair, each in an interval of its own, of a node of the first body; and a direction for each."""
    n = len(stage.stretch.pairs)
    zero = np.zeros(n, dtype=np.int64)
    start = rng.integers(0, stage.stretch.n_intervals, n)
    items = Items(np.arange(n), zero + node, zero, start, zero + 1, zero, zero)
    u = rng.normal(size=(3, n))
    return items, u / np.sqrt((u * u).sum(axis=0))


def corners_of(stage, body: int, node: int) -> np.ndarray:
    """(k, 3) the corners of a node's faces."""
    at = stage.halves.first_node[body] + node
    own = slice(stage.halves.start[at], stage.halves.stop[at])
    return stage.halves.corners[:, :, own].reshape(3, -1).T


def names_in(case) -> list[str]:
    """Of all bodies, as `SampledMachine` calls them."""
    links = [f"{p.robot.name}/{b.name}" for p in case.robots for b in p.robot.bodies]
    return [*links, *(obstacle.name for obstacle in case.obstacles)]


def link_above(stage, case, a: int, b: int) -> str | None:
    """The nearest link above two bodies, from which they are seen; None for the world."""
    forest, joints, carriers = forest_of(case), stage.stretch.joints, stage.stretch.carriers
    others = chain_above(joints.parents, int(carriers[b]))
    both = [link for link in chain_above(joints.parents, int(carriers[a])) if link in others]
    names = {
        start + i: f"{placed.robot.name}/{name}"
        for placed, start in zip(case.robots, forest.robot_starts, strict=True)
        for i, name in enumerate(placed.robot.link_names)
    }
    names |= {
        link: one.name for one, link in zip(case.obstacles, forest.obstacle_links, strict=True)
    }
    return names[both[0]] if both else None


def seen_from(link: str | None, poses) -> dict[str, np.ndarray]:
    """The poses as they are seen from a link, wherever that is."""
    if link is None:
        return poses
    return {name: np.linalg.inv(poses[link]) @ pose for name, pose in poses.items()}


def left_of(stage, items, u, case, rng) -> np.ndarray:
    """(pairs,) [m] the least that samples of errors and times leave along each direction."""
    machine, names = SampledMachine(case), names_in(case)
    least = np.full(len(items.pair), np.inf)
    for i, (a, b) in enumerate(stage.stretch.pairs.tolist()):
        times = stage.stretch.times[items.start[i] :][:2]
        first, second = corners_of(stage, a, int(items.node_a[i])), corners_of(stage, b, 0)
        for _ in range(SAMPLES):
            poses = machine.poses(float(rng.uniform(*times)), machine.random(rng))
            poses = seen_from(link_above(stage, case, a, b), poses)
            x, y = (
                points @ poses[names[body]][:3, :3].T + poses[names[body]][:3, 3]
                for points, body in ((first, a), (second, b))
            )
            least[i] = min(least[i], (y @ u[:, i]).min() - (x @ u[:, i]).max())
    return least


@pytest.mark.slow
@pytest.mark.parametrize("seed", (0, 3))
def test_no_error_brings_parts_nearer_than_a_direction_proves(seed):
    case, rng = random_case(seed), np.random.default_rng(seed)
    data = case_data(case)
    assert len(data.stretches) == 2 and data.stretches[1].errors is not None
    easily, with_errors, without = stage_of(data, 1), stage_of(data, 1, FAR), stage_of(data, 0, FAR)
    for node in (0, 1, 4):
        items, u = rows_of(with_errors, node, rng)
        least = left_of(with_errors, items, u, case, rng)
        at_once, closest, nominal = (
            by_directions(stage, items, u) + stage.wanted[items.pair, items.start]
            for stage in (easily, with_errors, without)
        )
        assert (at_once <= closest + ROUNDING).all()
        assert (closest <= least + ROUNDING).all()
        assert (nominal > least).any()


@pytest.mark.parametrize("seed", range(4))
def test_errors_do_no_more_to_any_corner_than_is_said_of_its_ball(seed):
    data, rng = case_data(random_case(seed)), np.random.default_rng(seed)
    stage = stage_of(data, 1)
    n = stage.stretch.n_intervals
    for node in (0, 1, 4):
        items, u = rows_of(stage, node, rng)
        body = stage.stretch.pairs[:, 0]
        place = stage.views.pairs[:, 0] * n + items.start
        side, at = Sides(place, body, items.node_a), stage.whole
        turn, origin = at.turn[:, :, place], at.at[:, place]
        exact = along_of(at.terms, turn, origin, place, u)
        nodes = stage.halves.first_node[body] + node
        half = 0.5 * (stage.halves.high[:, nodes] - stage.halves.low[:, nodes])
        centre = centre_of(stage.halves, at, side)
        most = most_of_balls(at.terms, place, u, centre, np.sqrt((half * half).sum(axis=0)))
        for i in range(len(body)):
            corners = corners_of(stage, body[i], node).T[:, :, None]
            found = exact.of(np.array([i])).at(corners).max()
            assert found <= most[i] + ROUNDING
        terms = [part[..., place] for part in at.terms]
        own = dict(zip(at.terms._fields, terms, strict=True))
        turned = np.cross(own["bars"], centre - own["pins"], axis=1)
        by_axes = [np.abs((u * part).sum(axis=1)).sum(axis=0) for part in (turned, own["slides"])]
        at_centre = most_of_balls(at.terms, place, u, centre, np.zeros(len(place)))
        assert np.allclose(at_centre, sum(by_axes) + own["anyway"], rtol=1e-11, atol=0.0)


def distance(machine: SampledMachine, poses, one: str, other: str) -> float:
    """[m] Of two bodies where they are at these poses."""
    places = {"pose_a": poses[one], "pose_b": poses[other]}
    return cl.distance(machine.shapes[one], machine.shapes[other], **places).distance


def taken_by(off: JointTolerance) -> float:
    """[m] What an error at the joint of a bar takes along y; its corners are 0.8, 0.05, 0.05 m from the joint."""
    case = turning_arm(turn=1e-9, n_steps=2)
    data = case_data(replace(case, tolerance=Budget({"arm": RobotTolerance({"turn": off})})))
    halves = np.array(
        [1, 2]
    )  # of the bar: six triangles each, whose corners are looked at one by one
    zero = np.zeros(2, dtype=np.int64)
    items = Items(zero, halves, zero, zero, zero + 1, zero, zero)
    u = np.repeat([[0.0], [1.0], [0.0]], 2, axis=1)
    nominal, left = (by_directions(stage_of(data, i, FAR), items, u).min() for i in (0, 1))
    return float(nominal - left)


def test_the_bound_of_a_single_turn_is_that_of_its_arc():
    """By e along y a corner goes 0.8 sin e + 0.05 (cos e - 1)."""
    e = 1e-3
    exact = 0.8 * np.sin(e) + 0.05 * (np.cos(e) - 1.0) + 0.002
    taken = taken_by(JointTolerance(e, 0.0, PlacementTolerance(0.002, 0.0)))
    assert exact <= taken <= exact + e * e


def test_the_bound_of_a_turn_about_any_axis_is_that_of_the_greatest_arc():
    """A corner at p goes farthest along y in the plane of p and y: from the angle of p to that and e."""
    e, size = 1e-3, np.sqrt(0.8**2 + 0.05**2 + 0.05**2)
    exact = size * np.sin(np.arcsin(0.05 / size) + e) - 0.05
    taken = taken_by(JointTolerance(0.0, 0.0, PlacementTolerance(0.0, e)))
    assert exact <= taken <= exact + e * e


LEAST = "default, with tolerances"
MOMENTS = 8


def in_the_world(stage) -> np.ndarray:
    """(pairs,) True where the pair is seen in the world."""
    joints, carriers = stage.stretch.joints, stage.stretch.carriers

    def root(link: int) -> int:
        while link >= 0 and joints.parents[link] >= 0:
            link = int(joints.parents[link])
        return link

    roots = np.array([root(int(link)) for link in carriers])[stage.stretch.pairs]
    return (roots[:, 0] != roots[:, 1]) | (roots < 0).any(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_no_error_of_any_moment_brings_parts_nearer_than_is_proven(seed):
    case, rng = handling(seed), np.random.default_rng(seed)
    data, machine, names = case_data(case), HandlingMachine(case), names_in(case)
    half = len(data.stretches) // 2
    for i in range(half, 2 * half):
        stage = stage_of(data, i, FAR)
        items, u = rows_of(stage, 0, rng)
        items = items._replace(start=np.full(len(u.T), stage.stretch.n_intervals - 1))
        world = in_the_world(stage)
        along = by_directions(stage, items, u) + FAR
        apart = by_balls(stage, items) + stage.stretch.padding + UNIT
        start, times = stage.stretch.times[0], stage.stretch.times[-2:]
        for _ in range(MOMENTS):
            errors = {
                moment: machine.random(rng) for moment in [*machine.moments(start), machine.NOW]
            }
            parts = machine.parts_at(start, errors)
            poses = machine.poses(float(rng.uniform(*times)), errors[machine.NOW], parts)
            for k, pair in enumerate(stage.stretch.pairs.tolist()):
                one, other = (names[body] for body in pair)
                assert apart[k] <= distance(machine, poses, one, other) + ROUNDING
                if world[k]:
                    a, b = (
                        machine.shapes[name].vertices @ (poses[name][:3, :3].T @ u[:, k])
                        + poses[name][:3, 3] @ u[:, k]
                        for name in (one, other)
                    )
                    least = b.min() - a.max()
                    assert along[k] <= least + ROUNDING


@pytest.mark.slow
def test_a_receipt_proves_what_the_errors_of_both_moments_leave(tmp_path):
    case = slid(off_by(0.004), carried("bar", 0.0))
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven
    assert 0.092 - 0.04 * 0.008 <= found.bounds[LEAST] <= 0.092


@pytest.mark.parametrize(("how", "taken"), [({}, 0.008), ({"exact_grasp": True}, 0.004)])
def test_along_a_slide_both_errors_are_taken_and_of_an_exact_grasp_one(how, taken):
    data = case_data(slid(off_by(0.004), carried("bar", 0.0, **how)))
    pairs = [{data.shapes[body].name for body in pair} for pair in data.stretches[0].pairs.tolist()]
    zero, one = np.zeros(1, dtype=np.int64), np.ones(1, dtype=np.int64)
    items = Items(zero + pairs.index({"part", "wall"}), zero, zero, zero, one, zero, zero)
    for u in np.array([[[1.0], [0.0], [0.0]], [[-1.0], [0.0], [0.0]]]):
        nominal, left = (by_directions(stage_of(data, i, FAR), items, u)[0] for i in (0, 1))
        assert nominal - left == pytest.approx(taken, abs=ROUNDING)


@pytest.mark.slow
def test_a_receipt_of_an_exact_grasp_is_not_one_of_another(tmp_path):
    saved(quarter_turn(0.1, 0.03, exact_grasp=True), tmp_path)
    with pytest.raises(BadSyntax, match="its numbers are not those"):
        cl.verify(tmp_path, quarter_turn(0.1, 0.03))
