"""Random trees of links, bare ones and fixed groups among them, without an SRDF: every pair that nothing excuses,
asked of FCL as two boxes.

Where links are, and who is excused, is worked out here, by code that shares nothing with the package.
"""

import itertools

import fcl
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.errors import NothingToMeasure
from clearance.world.robot import Joint, JointKind

KINDS = ("fixed", "revolute", "continuous", "prismatic")
N_STEPS = 6


class RandomTree:
    """Links 0, 1, … with a joint above each but the first, a box on most, and where the joints are."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        self.n = int(random.integers(3, 9))
        self.parents = [-1, *(int(random.integers(0, i)) for i in range(1, self.n))]
        self.kinds = ["", *random.choice(KINDS, self.n - 1, p=[0.4, 0.2, 0.1, 0.3])]
        self.places = random.normal(0.0, 0.25, (self.n, 3))
        self.turns = Rotation.random(self.n, random_state=seed)
        self.axes = random.normal(size=(self.n, 3))
        self.axes /= np.linalg.norm(self.axes, axis=1)[:, None]
        self.sizes = random.uniform(0.05, 0.3, (self.n, 3))
        self.solid = [i for i in range(self.n) if random.random() < 0.7]
        self.values = random.uniform(-1.0, 1.0, (N_STEPS, self.n))
        self.moving = [i for i in range(1, self.n) if self.kinds[i] != "fixed"]

    def pose(self, link, step):
        """Rotation and place of a link in the root."""
        if link == 0:
            return Rotation.identity(), np.zeros(3)
        turn, place = self.pose(self.parents[link], step)
        place, turn = place + turn.apply(self.places[link]), turn * self.turns[link]
        way = self.values[step, link] * self.axes[link]
        if self.kinds[link] == "prismatic":
            place = place + turn.apply(way)
        elif self.kinds[link] != "fixed":
            turn = turn * Rotation.from_rotvec(way)
        return turn, place

    def chain(self, link):
        """The links from the root down to one."""
        return [link] if link == 0 else [*self.chain(self.parents[link]), link]

    def is_excused(self, a, b):
        """One rigid body, or one joint that moves between a link and one below it, nothing solid between them."""
        one, other = self.chain(a), self.chain(b)
        apart = {*one} ^ {*other}
        moving = [link for link in apart if link in self.moving]
        below = one == other[: len(one)] and not {*other[len(one) : -1]} & {*self.solid}
        return not moving or (len(moving) == 1 and below)

    def fcl_distances(self):
        """(steps,) [m] the least over all pairs that are not excused, 0 in contact; None without such pairs."""
        pairs = [
            pair for pair in itertools.combinations(self.solid, 2) if not self.is_excused(*pair)
        ]
        if not pairs:
            return None
        return [min(self.fcl_distance(*pair, step) for pair in pairs) for step in range(N_STEPS)]

    def fcl_distance(self, a, b, step):
        """[m] of two boxes, which FCL takes for solids; 0 in contact."""
        bodies = []
        for link in (a, b):
            turn, place = self.pose(link, step)
            shape = fcl.Box(*self.sizes[link])
            bodies.append(fcl.CollisionObject(shape, fcl.Transform(turn.as_matrix(), place)))
        if fcl.collide(*bodies, fcl.CollisionRequest(), fcl.CollisionResult()):
            return 0.0
        return fcl.distance(*bodies, fcl.DistanceRequest(), fcl.DistanceResult())

    def case(self):
        """The same as a case without an SRDF."""
        joints = tuple(self.joint(i) for i in range(1, self.n))
        bodies = tuple(cl.Body(f"l{i}", cl.box(self.sizes[i])) for i in self.solid)
        robot = cl.Robot("tree", tuple(f"l{i}" for i in range(self.n)), joints, bodies)
        names = tuple(f"j{i}" for i in self.moving)
        path = cl.Trajectory(np.arange(float(N_STEPS)), names, self.values[:, self.moving])
        return cl.Case(
            "tree", (cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance()),), ()
        )

    def joint(self, i):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = self.turns[i].as_matrix(), self.places[i]
        parent = f"l{self.parents[i]}"
        return Joint(f"j{i}", JointKind(self.kinds[i]), parent, f"l{i}", pose, self.axes[i])


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_no_pair_but_neighbours_and_rigid_ones_is_omitted(first):
    n_asked = n_touching = 0
    for seed in range(first, first + 25):
        tree = RandomTree(seed)
        least = tree.fcl_distances() if tree.moving else None
        if least is None:
            if tree.moving:
                with pytest.raises(NothingToMeasure):
                    cl.check(tree.case(), certify=False, contact="none")
            continue
        reported = cl.check(tree.case(), certify=False, contact="none").record.clearances
        np.testing.assert_allclose(reported, least, rtol=0.0, atol=2e-6)
        n_asked, n_touching = n_asked + 1, n_touching + sum(one == 0.0 for one in least)
    assert n_asked > 8 and n_touching > 8
