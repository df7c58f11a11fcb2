"""How parts that change hands move with a change: by what carries them now, less what picked them up.

A part keeps the pose on its carrier that it has when it is picked up. With the carrier at W(t), and at W(p)
then, it is at W(t) W(p)^-1 P, P where it was: so it moves as the carrier does now, and by the turn between as it
was moved before, less as the carrier was moved then. What is let go stays where that took it. Not for: which
part is where (`world.hands`), carriers that are such parts themselves, of which the first order is not complete.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clearance.geometry.pose import inverse
from clearance.simulate.answers.approaches import Approach
from clearance.world.forest import WORLD, forest_of, link_poses_at
from clearance.world.pairs import BodyIndex
from clearance.world.phase import Phase
from clearance.world.timeline import Timeline

ByFrame = Callable[[Phase, int, np.ndarray, np.ndarray], np.ndarray]
"""Of a phase, a link of its forest, its own steps (k,), and points (k, 3) that the link carries [m, world]: (k,
m, 3) how they move with each variable, by what carries the link in this phase alone."""


@dataclass(frozen=True, eq=False)
class Grasps:
    """The parts of a run, with what moves links.

    Attributes:
        by_frame: of points that a link carries. n: number of the variables.
    """

    timeline: Timeline
    by_frame: ByFrame
    n: int

    def gradient(self, approach: Approach) -> np.ndarray:
        """(k, m) what the clearances of an approach grow by."""
        i_phase = next(
            i
            for i, one in enumerate(self.timeline.phases)
            if one.first == approach.section.phase.first
        )
        own = approach.steps - approach.section.phase.first
        moved = [
            self._of_body(i_phase, body, own, approach.points[:, side])
            for side, body in enumerate(approach.pair)
        ]
        return approach.of_bodies(*moved)

    def _of_body(
        self, i_phase: int, body: BodyIndex, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        phase = self.timeline.phases[i_phase]
        if body.is_obstacle:
            return self._of_part(i_phase, body.name_in(phase.case), steps, points)
        return self._of_frame(phase, body.frame_in(phase.case), steps, points)

    def _of_part(
        self, i_phase: int, name: str, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        phases = self.timeline.phases
        if name in phases[i_phase].carried:
            return self._in_hand(i_phase, name, steps, points)
        before = [i for i in range(i_phase) if name in phases[i].carried]
        if before:
            last = np.full(len(points), phases[before[-1]].n_steps - 1)
            return self._in_hand(before[-1], name, last, points)
        case = phases[i_phase].case
        link = forest_of(case).link_called(case, name)
        return self._of_frame(phases[i_phase], link, steps, points)

    def _in_hand(
        self, i_phase: int, name: str, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        phases = self.timeline.phases
        phase, carry = phases[i_phase], phases[i_phase].carried[name]
        first = i_phase
        while first and phases[first - 1].carried.get(name) is carry:
            first -= 1
        here, then = (
            forest_of(one.case).link_called(one.case, carry.by) for one in (phase, phases[first])
        )
        if WORLD in (here, then):
            return np.zeros((len(points), self.n, 3))
        world_from_by = link_poses_at(phase.case, phase.motions, steps)[:, here]
        world_from_held = link_poses_at(phases[first].case, phases[first].motions, slice(0, 1))[
            0, then
        ]
        turned = world_from_by @ inverse(world_from_held)
        back = inverse(turned)
        points_then = np.einsum("kij,kj->ki", back[:, :3, :3], points) + back[:, :3, 3]
        start = np.zeros(len(points), dtype=np.int64)
        by_now = self._of_frame(phase, here, steps, points)
        by_then = self._of_frame(phases[first], then, start, points_then)
        part_then = np.zeros_like(by_then)
        if first:
            last = start + phases[first - 1].n_steps - 1
            part_then = self._of_part(first - 1, name, last, points_then)
        return by_now + np.einsum("kij,kmj->kmi", turned[:, :3, :3], part_then - by_then)

    def _of_frame(
        self, phase: Phase, frame: int, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        if frame == WORLD:
            return np.zeros((len(points), self.n, 3))
        return self.by_frame(phase, frame, steps, points)
