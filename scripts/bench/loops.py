"""Ways to find the least clearance of every step of a scene: ours, and what users of the peers write.

Each loop is built outside the clock and answers `run(steps)`; poses are worked out beforehand for the
peers and inside the clock for ours. `coherent` loops need every step in order; the others may be asked
for a sample. Counters are of the last run. Not for: the clock (`clock`).
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from inputs import Scene
from peers import Coal, CoalShapes, Fcl, FclShapes, Klampt, PairPeer, available, silenced

from clearance.crosscheck.peer_run import greatest_displacements
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources

SLACK = 0.02
"""[m] How far beyond the best the carried loop still asks, so that an aborted query leaves a bound that
lasts some steps: of 0.5, 2, 8, 30 and 100 mm, on fetch, kuka, panda and hot_cell, 2 to 30 mm were best,
each on another scene; this lies between and was not tuned further."""

ROUNDING = 1e-12
"""[m] Taken off every bound of the loops, which are plain float64."""


class StepLoop(Protocol):
    """One way to measure the steps of a scene."""

    name: str
    library: str
    coherent: bool
    counters: dict[str, int]

    def run(self, steps: np.ndarray) -> np.ndarray:
        """[m] the least clearance of each of `steps`, as the library says it."""


class OurSteps:
    """`clearance.simulate.measure.measure.measure`: forward kinematics, laying out and sweep, all in the clock."""

    name = "clearance: steps"
    library = "clearance"
    coherent = True

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.counters: dict[str, int] = {}

    def run(self, steps: np.ndarray) -> np.ndarray:
        """All steps."""
        scene = self._scene
        found = measure(
            PairsInMotion(scene.case, scene.motions, scene.pairs), resources=Resources(jobs=1)
        )
        self.counters = found.tally
        return found.clearance[steps]


class OurPairs(OurSteps):
    """The same and then the least clearance of every pair over the whole motion."""

    name = "clearance: steps and pair minima"

    def run(self, steps: np.ndarray) -> np.ndarray:
        """All steps."""
        scene = self._scene
        found = measure(
            PairsInMotion(scene.case, scene.motions, scene.pairs), resources=Resources(jobs=1)
        )
        minima = found.measure_pair_minima(None)
        self.counters = {**found.tally, "pairs": len(minima.clearance)}
        return found.clearance[steps]


class AllPairs:
    """Every pair at every step by one peer."""

    coherent = False
    style = "all pairs"

    def __init__(self, scene: Scene, by: PairPeer) -> None:
        self._scene, self._peer = scene, by
        self.name, self.library = f"{by.name}: {self.style}", by.name
        self.counters: dict[str, int] = {}
        self._n_queries = 0
        with silenced():
            self._bodies = [by.body(body) for body in scene.bodies]
        for i in scene.standing:
            by.place(self._bodies[i], scene.poses[0, i])
        self._moving = scene.moving
        self._index = [(int(i), int(j)) for i, j in scene.index]

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        self._n_queries = 0
        found = np.array([self._step(int(step)) for step in steps])
        self.counters = {"queries": self._n_queries}
        return found

    def _place(self, step: int) -> None:
        poses = self._scene.poses[step]
        for i in self._moving:
            self._peer.place(self._bodies[i], poses[i])

    def _ask(self, i_pair: int, **options: Any) -> float:
        i, j = self._index[i_pair]
        self._n_queries += 1
        return self._peer.distance(self._bodies[i], self._bodies[j], **options)

    def _step(self, step: int) -> float:
        self._place(step)
        return min(self._ask(i_pair) for i_pair in range(len(self._index)))


class SortedPairs(AllPairs):
    """Pairs by the bound of their bounding spheres, ending where it exceeds the best."""

    style = "sorted by spheres"

    def __init__(self, scene: Scene, by: PairPeer) -> None:
        super().__init__(scene, by)
        centres, radii = zip(*(sphere_of(body.soup.vertices) for body in scene.bodies), strict=True)
        self._own = np.array(centres)[self._moving]
        self._centres = np.einsum("bij,bj->bi", scene.poses[0, :, :3, :3], np.array(centres))
        self._centres += scene.poses[0, :, :3, 3]
        self._reach = np.array(radii)[scene.index].sum(axis=1)

    def _bounds(self, step: int) -> np.ndarray:
        poses, index = self._scene.poses[step, self._moving], self._scene.index
        self._centres[self._moving] = (
            np.einsum("bij,bj->bi", poses[:, :3, :3], self._own) + poses[:, :3, 3]
        )
        apart = self._centres[index[:, 0]] - self._centres[index[:, 1]]
        return np.linalg.norm(apart, axis=1) - self._reach

    def _step(self, step: int) -> float:
        self._place(step)
        bounds, best = self._bounds(step) - ROUNDING, np.inf
        for i_pair in np.argsort(bounds).tolist():
            if bounds[i_pair] >= best or best <= 0.0:
                break
            best = min(best, self._ask_below(i_pair, best))
        return best

    def _ask_below(self, i_pair: int, best: float) -> float:
        return self._ask(i_pair)


class BestSoFar(SortedPairs):
    """The same order, each query told the best so far as the bound above which it may stop."""

    style = "sorted, best so far"

    def _ask_below(self, i_pair: int, best: float) -> float:
        return self._ask(i_pair, upper_bound=best)


class CarriedBounds(SortedPairs):
    """Bounds carried from step to step less what both bodies can have moved, or those of the spheres where
    they are greater; sorted, best so far: the best known by hand."""

    style = "carried bounds"
    coherent = True

    def run(self, steps: np.ndarray) -> np.ndarray:
        """All steps from the first."""
        scene = self._scene
        moved = np.zeros((len(steps), len(scene.bodies)))
        for i in self._moving:
            bounds = scene.bodies[i].soup.bounds
            moved[1:, i] = greatest_displacements(bounds, scene.poses[: len(steps), i])
        self._moved = moved[:, scene.index].sum(axis=2)
        self._lower = self._bounds(int(steps[0]))
        return super().run(steps)

    def _step(self, step: int) -> float:
        self._place(step)
        lower = np.maximum(self._lower - self._moved[step], self._bounds(step)) - ROUNDING
        best = np.inf
        for i_pair in np.argsort(lower).tolist():
            if lower[i_pair] >= best:
                break
            cap = best + SLACK
            answer = self._ask(i_pair, upper_bound=cap)
            lower[i_pair] = min(answer, cap)
            best = min(best, answer)
        self._lower = lower
        return best


class FclManagers:
    """python-fcl's broad phase: a DynamicAABBTreeCollisionManager of links against one of obstacles.

    Its callback cannot leave pairs out, so that links that face the same obstacles share a manager.
    """

    coherent = False

    def __init__(self, scene: Scene, by: Fcl) -> None:
        self._peer, self._scene = by, scene
        self.name, self.library = f"{by.name}: two AABB-tree managers", by.name
        self._bodies = [by.body(body) for body in scene.bodies]
        for i in scene.standing:
            by.place(self._bodies[i], scene.poses[0, i])
        facing: dict[tuple[int, ...], list[int]] = {}
        for i in scene.moving:
            facing.setdefault(tuple(scene.index[scene.index[:, 0] == i, 1].tolist()), []).append(i)
        self._groups = [
            tuple(self._manager([self._bodies[i] for i in side]) for side in (links, them))
            for them, links in facing.items()
        ]
        self.counters = {"managers": 2 * len(self._groups)}

    def _manager(self, objects: list) -> Any:
        made = self._peer.fcl.DynamicAABBTreeCollisionManager()
        made.registerObjects(objects)
        made.setup()
        return made

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        return np.array([self._step(int(step)) for step in steps])

    def _step(self, step: int) -> float:
        for i in self._scene.moving:
            self._peer.place(self._bodies[i], self._scene.poses[step, i])
        answers = []
        for links, obstacles in self._groups:
            links.update()
            asked = self._peer.fcl.DistanceData()
            links.distance(obstacles, asked, self._peer.fcl.defaultDistanceCallback)
            answers.append(asked.result.min_distance)
        return min(answers)


def sphere_of(vertices: np.ndarray) -> tuple[np.ndarray, float]:
    """A ball that holds all vertices: centre of their box, greatest distance from it."""
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    return centre, float(np.linalg.norm(vertices - centre, axis=1).max())


def loops_of(scene: Scene) -> list[StepLoop]:
    """Ours first, then every peer's loop whose library is there."""
    loops: list[StepLoop] = [OurSteps(scene), OurPairs(scene)]
    has_round = any(body.round_shape for body in scene.bodies)
    all_stand = {*scene.index[:, 1].tolist()} <= {*scene.standing}  # what managers can be asked
    if available("fcl"):
        for by in [Fcl, FclShapes] if has_round else [Fcl]:
            loops += [AllPairs(scene, by()), *([FclManagers(scene, by())] if all_stand else [])]
    if available("coal"):
        for by in [Coal, CoalShapes] if has_round else [Coal]:
            loops += [AllPairs(scene, by()), SortedPairs(scene, by())]
    if available("klampt"):
        loops += [kind(scene, Klampt()) for kind in (AllPairs, BestSoFar, CarriedBounds)]
    return loops
