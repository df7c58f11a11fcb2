"""Links that follow quaternions: swept, certified and bounded, against bodies placed and measured one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.geometry.tree import surface_of
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.interval_middle import IntervalMiddle
from clearance.kernels.motion.joint_motion_bound import (
    loosened,
    motion_bound_of,
    motion_bound_of_box,
    orientation_rounding,
)
from clearance.kernels.motion.joint_path import BallPath
from clearance.kernels.motion.kinematics import BALL, FIXED, SLIDING, TURNING, place_by_link
from clearance.world.kinematics import (
    all_links,
    floating_links,
    poses_by_link,
    standing_link,
    values_by_link,
)
from clearance.world.slerp import aligned, arcs_between
from tests.examples import examples
from tests.made_cases import at, dented
from tests.simulate.measure import floating
from tests.simulate.measure.floating import Scene, chain, orientations, two_floating
from tests.simulate.measure.forests import ways_in

TURNS = {"usual": 0.7, "half a turn": np.pi, "tiny": 1e-9, "none": 0.0}
SHAPE = cl.box((0.3, 0.1, 0.2))


def arm_below(random: np.random.Generator, n_steps: int, turn: float) -> Scene:
    """An arm of three joints on a base that tumbles, past a body that stands."""
    links, n = chain([SLIDING, BALL, TURNING, FIXED, SLIDING, TURNING], random, shift=0.25)
    positions = random.uniform(-1.0, 1.0, (1, n)) + 0.1 * random.normal(size=(n_steps, n)).cumsum(0)
    column = links.columns[2]
    positions[:, column : column + 4] = orientations(random, n_steps, turn)
    shapes = [cl.box((0.1, 0.15, 0.1)), cl.box((0.3, 0.1, 0.1)), dented(random, 1, 0.3, 0.2)]
    tip = floating.poses(links, positions)[n_steps // 2, 6, :3, 3]
    away = random.normal(size=3)
    stands = shapes[2].transformed(at(*(tip + 0.8 * away / np.linalg.norm(away))))
    return Scene(links, [*shapes[:2], stands], [3, 6, -1], [(0, 2), (1, 2)], positions)


SCENES = {"two that float": two_floating, "an arm below": arm_below}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("make", SCENES.values(), ids=SCENES)
@pytest.mark.parametrize("seed", range(1))
def test_no_bound_is_above_samples_a_thousand_times_finer(seed, make, turn):
    scene = make(np.random.default_rng(seed), 4, turn)
    bounds = floating.certified(scene)
    shares = np.linspace(0.0, 1.0, 1001)
    for step in range(3):
        finer = floating.between(scene.links, *scene.positions[step : step + 2], shares)
        least = floating.distances(scene, finer).min()
        assert bounds.lower[step] <= least
        assert bounds.upper[step] - bounds.lower[step] <= 1e-4
        assert least <= bounds.upper[step] + 1e-4


def test_half_a_turn_sweeps_the_side_of_the_given_signs():
    """A blade that stands up turns down over one side or the other; a body is in the way on one of them."""
    links = all_links(standing_link(np.eye(4)), floating_links(1, 0, 0, np.eye(4)))
    blade = cl.box((0.02, 0.02, 0.2)).transformed(at(0.0, 0.0, 0.5))
    block = cl.box((0.1, 0.1, 0.1)).transformed(at(0.5, 0.0, 0.0))
    up = np.array([0, 0, 0, 0, 0, 0, 1.0])
    for sign, touches in ((1.0, True), (-1.0, False)):
        down = np.array([0, 0, 0, 0, sign, 0, 0.0])  # about y: z goes to x first, or to -x
        scene = Scene(links, [blade, block], [4, -1], [(0, 1)], np.array([up, down]))
        bounds = floating.certified(scene)
        assert (bounds.lower[0] == 0.0) == touches
        if not touches:  # nearest where it begins and ends
            assert bounds.lower[0] == pytest.approx(floating.swept(scene)[0].clearance[0], abs=1e-4)


KINDS = st.lists(st.sampled_from([FIXED, TURNING, SLIDING, BALL]), max_size=4)


@examples(60)
@given(
    st.integers(0, 2**32 - 1), KINDS, KINDS, st.sampled_from([0.0, 1e-9, 1e-3, 0.3, 3.0]),
    st.sampled_from([1.0, 1.0 - 1e-6, 0.5]),
)  # fmt: skip
def test_no_body_moves_farther_than_its_columns_say(seed, above, below, size, length):
    random = np.random.default_rng(seed)
    links, n = chain([*above, BALL, *below], random, shift=random.choice([0.0, 0.5, 50.0]))
    positions = random.uniform(-2.0, 2.0, n) + size * random.uniform(-1.0, 1.0, (12, n))
    for column in links.columns[links.kinds == BALL]:
        turned = orientations(random, 12, min(size, np.pi))
        turned = aligned(turned) if random.random() < 0.7 else turned
        positions[:, column : column + 4] = length * turned
    link = len(links.parents) - 1
    body = SHAPE.transformed(at(0.4, 0.0, -0.2)) if random.random() < 0.5 else SHAPE
    corners = np.column_stack([body.vertices, np.ones(8)])
    world = corners @ poses_by_link(links, positions)[:, link].transpose(0, 2, 1)
    moved = np.linalg.norm(world - world[0], axis=2).max(axis=1)
    scene = Scene(links, [body], [link], np.empty((0, 2), np.int64), positions)
    assert (moved <= ways_in(surface_of(body), scene.world, positions)).all()


def bound_about(surface, links, link, balls, middle):
    place_by_link(links, middle.positions, middle.poses)
    box = box_of(surface, 0)
    bound = motion_bound_of(box, links, link, middle)
    rounding = orientation_rounding(box, links, link, balls, middle)
    return motion_bound_of_box(box, loosened(bound, rounding)), rounding


@examples(50)
@given(st.integers(0, 2**32 - 1), KINDS, KINDS, st.sampled_from([0.0, 1e-9, 1e-3, 0.3, 3.1]))
def test_no_point_leaves_its_bound_about_the_middle(seed, above, below, size):
    """Every ball joint turns about an axis of its own, the others move linearly."""
    random = np.random.default_rng(seed)
    links, n = chain([*above, BALL, *below], random)
    ends = random.uniform(-2.0, 2.0, n) + size * random.uniform(-1.0, 1.0, (2, n))
    values = values_by_link(links, ends)
    middle, swing = values.mean(axis=0), 0.5 * (values[1] - values[0])
    bend, balls = np.zeros(len(swing)), np.flatnonzero(links.kinds == BALL)
    turning = links._replace(
        kinds=np.where(links.kinds == BALL, TURNING, links.kinds),
        axes=links.axes.copy(),
        parent_from_joint=links.parent_from_joint.copy(),
    )
    for link in balls:
        at_link = slice(links.columns[link], links.columns[link] + 4)
        ends[:, at_link] = orientations(random, 2, size)
        *axis, angle = arcs_between(*ends[:, at_link])
        turned = floating.Rotation.from_quat(ends[0, at_link]).as_matrix()
        turning.parent_from_joint[link, :3, :3] = links.parent_from_joint[link, :3, :3] @ turned
        turning.axes[link], middle[link], swing[link] = axis, angle / 2, angle / 2
    swing *= 1.0 + 1e-12
    link = len(links.parents) - 1
    room = np.empty((link + 1, 4, 4))
    state = IntervalMiddle(middle, swing, bend, room)
    path = BallPath(balls, links.parent_from_joint[balls], np.empty((0, len(balls), 8)))
    bound, rounding = bound_about(surface_of(SHAPE), turning, link, path, state)
    slides = np.abs(values[:, links.kinds == SLIDING]).max(axis=0).sum()
    apart = np.linalg.norm(links.parent_from_joint[:, :3, 3], axis=1).sum()
    reach = np.linalg.norm(SHAPE.bounds[1]) + apart + slides
    assert 0.0 < rounding <= 2.0**-45 * len(balls) * reach * (1.0 + 1e-6)
    shares = np.array([0.5, *np.linspace(0.0, 1.0, 41)])
    placed = floating.poses(links, floating.between(links, *ends, shares))[:, link]
    world = np.column_stack([SHAPE.vertices, np.ones(8)]) @ placed.transpose(0, 2, 1)
    assert np.linalg.norm(world - world[0], axis=2).max() <= bound
    assert np.abs(placed[0] - room[link]).max() <= 1e-14
