"""Links that follow quaternions: swept, certified and bounded, against bodies placed and measured one by one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import join
from clearance.kernels.motion.certify import (
    CertificateGoal,
    CertifiedMotion,
    CertifiedSteps,
    IntervalBounds,
    certify,
)
from clearance.kernels.motion.kinematics import (
    BALL,
    FIXED,
    NO_COLUMN,
    NO_PARENT,
    SLIDING,
    TURNING,
    Links,
)
from clearance.kernels.motion.sweep import sweep
from clearance.kernels.motion.sweep_goal import FirstPass, SweepGoal, SweptSteps
from clearance.kernels.motion.sweep_rows import PairRows, StepRows, SweepRows
from clearance.kernels.motion.world import World
from clearance.query.pair_query import Query
from clearance.simulate.measure.certify import joint_path, with_turning_balls
from clearance.simulate.measure.layout import with_whole_faces
from clearance.world.kinematics import (
    all_links,
    floating_links,
    standing_link,
)
from tests.made_cases import at, dented, torus


class Scene(NamedTuple):
    """Bodies that links carry, or that stand at the origin (frame -1), and positions (n, columns)."""

    links: Links
    shapes: Sequence[Polyhedron]
    frames: Sequence[int]
    pairs: Sequence[tuple[int, int]]
    positions: np.ndarray

    @property
    def world(self) -> World:
        """The bodies, all of one group."""
        n = len(self.shapes)
        return World(
            np.arange(n), np.array(self.frames), np.zeros(n, dtype=np.int64),
            np.tile(np.eye(4), (n, 1, 1)), np.array(self.pairs), self.links,
        )  # fmt: skip


def chain(
    kinds: Sequence[int], random: np.random.Generator, shift: float = 0.4
) -> tuple[Links, int]:
    """A chain below a root, joints shifted and turned at random; and how many columns it follows."""
    n = len(kinds) + 1
    fixed = np.tile(np.eye(4), (n, 1, 1))
    fixed[:, :3, :3] = Rotation.random(n, random_state=random).as_matrix()
    fixed[:, :3, 3] = random.uniform(-shift, shift, (n, 3))
    axes = random.normal(size=(n, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    widths = np.array([0, *({BALL: 4, TURNING: 1, SLIDING: 1}.get(kind, 0) for kind in kinds)])
    columns = np.where(widths > 0, np.cumsum(widths) - widths, NO_COLUMN)
    links = Links(
        np.arange(n) - 1, np.array([0, *kinds]), axes, fixed, columns, np.ones(n), np.zeros(n)
    )
    assert links.parents[0] == NO_PARENT
    return links, int(widths.sum())


def orientations(random: np.random.Generator, n: int, turn: float) -> np.ndarray:
    """(n, 4) unit quaternions, each turned by `turn` [rad] from the one before; axes and signs at random."""
    axes = random.normal(size=(n, 3))
    axes *= turn / np.linalg.norm(axes, axis=1)[:, None]
    now, found = Rotation.random(random_state=random), []
    for axis in axes:
        found.append(now.as_quat() * random.choice([-1.0, 1.0]))
        now = now * Rotation.from_rotvec(axis)
    return np.array(found)


def two_floating(
    random: np.random.Generator, n_steps: int, turn: float, far: float = 0.75
) -> Scene:
    """Two dented bodies that float and tumble past one another, and a ring that stands."""
    world = standing_link(np.eye(4))
    links = all_links(
        world, floating_links(1, 0, 0, np.eye(4)), floating_links(5, 7, 0, at(0.1, -0.2, 0.3))
    )
    share = np.linspace(-1.0, 1.0, n_steps)[:, None]
    places = [
        far * np.array([side, 0.2, 0.1]) + 0.1 * share * random.normal(size=3)
        for side in (-1.0, 1.0)
    ]
    turned = [orientations(random, n_steps, turn) for _ in range(2)]
    positions = np.hstack([places[0], turned[0], places[1], turned[1]])
    shapes = [dented(random, 1, 0.3, 0.4), dented(random, 1, 0.3, 0.35), torus(0.1, 0.04, 9, 5)]
    return Scene(links, shapes, [4, 8, -1], [(0, 1), (0, 2), (1, 2)], positions)


def swept(scene: Scene) -> StepRows:
    """The rows of all steps."""
    n, n_pairs = len(scene.positions), len(scene.pairs)
    rows = StepRows(
        np.empty(n), np.empty(n), np.empty(n, np.int64), np.empty((n, 2), np.int64), np.empty((n, 2, 3))
    )  # fmt: skip
    no_pairs = PairRows(
        np.empty((0, n_pairs)), np.empty(0), np.empty(0, np.int64), np.empty((0, 2, 3))
    )
    sweep(
        join(scene.shapes), scene.world, SweptSteps(scene.positions, np.arange(n), np.empty(0, np.int64)),
        SweepGoal(np.full(n_pairs, np.inf), False, False), FirstPass(np.empty(0, np.int64), 0),
        SweepRows(rows, no_pairs), np.empty(5, dtype=np.int64),
    )  # fmt: skip
    return rows


def certified(scene: Scene, gap: float = 1e-4) -> IntervalBounds:
    """The bounds of all intervals."""
    n = len(scene.positions)
    rows = swept(scene)
    times = np.arange(n, dtype=np.float64)
    linear = np.zeros(scene.positions.shape[1], dtype=bool)
    path = joint_path(scene.links, times, scene.positions, np.zeros_like(scene.positions), linear)
    bounds = IntervalBounds(
        np.full(n, np.nan), np.full(n, np.nan), np.empty(n), np.empty(n, np.int64)
    )
    certify(
        with_whole_faces(join(scene.shapes)), CertifiedMotion(with_turning_balls(scene.world), path),
        CertifiedSteps(0, n - 1, rows.pair, rows.clearance), CertificateGoal(gap, 0.0, 2**24), bounds,
        np.empty(4, dtype=np.int64),
    )  # fmt: skip
    return bounds


def between(links: Links, before: np.ndarray, after: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """(k, columns) positions between two steps: ball joints by the sines of the arc, the shorter way."""
    s = shares[:, None]
    found = before + s * (after - before)
    for column in links.columns[links.kinds == BALL]:
        p, q = before[column : column + 4], after[column : column + 4]
        if (
            sum(p[k] * q[k] for k in range(4)) < 0.0
        ):  # rounding decides about half a turn: as they are
            q = -q
        p, q = p / np.linalg.norm(p), q / np.linalg.norm(q)
        angle = 2.0 * np.arcsin(0.5 * np.linalg.norm(q - p))
        if angle > 1e-6:
            mixed = (np.sin((1.0 - s) * angle) * p + np.sin(s * angle) * q) / np.sin(angle)
        else:
            mixed = (1.0 - s) * p + s * q
        found[:, column : column + 4] = mixed
    return found


def poses(links: Links, positions: np.ndarray) -> np.ndarray:
    """(n, links, 4, 4) [m] by scipy's rotations."""
    found = np.tile(np.eye(4), (len(positions), len(links.parents), 1, 1))
    for i, parent in enumerate(links.parents):
        if parent == NO_PARENT:
            found[:, i] = links.parent_from_joint[i]
            continue
        moved = np.tile(np.eye(4), (len(positions), 1, 1))
        kind, column = links.kinds[i], links.columns[i]
        if kind == BALL:
            moved[:, :3, :3] = Rotation.from_quat(positions[:, column : column + 4]).as_matrix()
        elif kind == TURNING:
            turned = Rotation.from_rotvec(positions[:, column, None] * links.axes[i])
            moved[:, :3, :3] = turned.as_matrix()
        elif kind == SLIDING:
            moved[:, :3, 3] = positions[:, column, None] * links.axes[i]
        found[:, i] = found[:, parent] @ links.parent_from_joint[i] @ moved
    return found


def distances(scene: Scene, positions: np.ndarray) -> np.ndarray:
    """(n, p) [m] of every pair, each asked by itself."""
    placed = poses(scene.links, positions)
    found = []
    for a, b in scene.pairs:
        at = [np.eye(4) if scene.frames[i] < 0 else placed[:, scene.frames[i]] for i in (a, b)]
        found.append(Query(scene.shapes[a], scene.shapes[b]).distances(*at).distances)
    return np.stack(found, axis=1)


TURNS = {"usual": 0.7, "half a turn": np.pi, "tiny": 1e-9, "none": 0.0}


def arm_below(random: np.random.Generator, n_steps: int, turn: float) -> Scene:
    """An arm of three joints on a base that tumbles, past a body that stands."""
    links, n = chain([SLIDING, BALL, TURNING, FIXED, SLIDING, TURNING], random, shift=0.25)
    positions = random.uniform(-1.0, 1.0, (1, n)) + 0.1 * random.normal(size=(n_steps, n)).cumsum(0)
    column = links.columns[2]
    positions[:, column : column + 4] = orientations(random, n_steps, turn)
    shapes = [cl.box((0.1, 0.15, 0.1)), cl.box((0.3, 0.1, 0.1)), dented(random, 1, 0.3, 0.2)]
    tip = poses(links, positions)[n_steps // 2, 6, :3, 3]
    away = random.normal(size=3)
    stands = shapes[2].transformed(at(*(tip + 0.8 * away / np.linalg.norm(away))))
    return Scene(links, [*shapes[:2], stands], [3, 6, -1], [(0, 2), (1, 2)], positions)


SCENES = {"two that float": two_floating, "an arm below": arm_below}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("make", SCENES.values(), ids=SCENES)
@pytest.mark.parametrize("seed", [0])
def test_no_bound_is_above_samples_a_thousand_times_finer(seed, make, turn):
    scene = make(np.random.default_rng(seed), 4, turn)
    bounds = certified(scene)
    shares = np.linspace(0.0, 1.0, 1001)
    for step in range(3):
        finer = between(scene.links, *scene.positions[step : step + 2], shares)
        least = distances(scene, finer).min()
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
        bounds = certified(scene)
        assert (bounds.lower[0] == 0.0) == touches
        if not touches:  # nearest where it begins and ends
            assert bounds.lower[0] == pytest.approx(swept(scene).clearance[0], abs=1e-4)
