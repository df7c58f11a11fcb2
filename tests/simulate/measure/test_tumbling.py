"""Bodies that float and tumble by tables, a robot on one of them: proofs against samples a thousand times finer.

Samples are placed by quaternions of their own.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.case import Case
from clearance.world.pose_table import PoseTable
from clearance.world.robot import JointKind
from clearance.world.rules import Allowance
from tests.made_cases import at, dented, driven, torus

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
