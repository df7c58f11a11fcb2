"""Prints what a step costs where more moves than one robot among standing things: ours and the peers'.

    python scripts/bench/actors.py [--cases NAME ...] [--seconds S] [--passes N] [--csv FILE]

An arm that minds itself and a scene, a humanoid that minds itself, two arms over one table, two arms that hand
over a part; and a certificate to 0.1 mm of each. Milliseconds of CPU a step, the median of interleaved passes.
The peers get our pairs and our triangles, and are asked for some evenly spread steps where all would exceed their
share of `--seconds`; poses are worked out beforehand for them, and inside the clock for ours.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from actor_cases import CASES, absent_robots, handover
from harness import Row, interleaved, tell
from inputs import solid
from peers import PairPeer, absent_peers, peer, silenced, versions
from trajectory import steps_for

from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.simulate.measure.sections import section_plan
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.timeline import timeline_of

LIBRARIES = ("coal", "fcl")

ONE_THREAD = Resources(jobs=1)

SMALLEST = ["--cases", "handover", "--seconds", "0.05", "--passes", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, cases=[*CASES, "handover"], seconds=3.0, passes=7)
    tell(*absent_robots(), *absent_peers(LIBRARIES))
    rows: list[Row] = []
    for name in asked.cases:
        if name == "handover":  # a part changes hands: no peer is asked
            rows += certificate_rows(name, handover(), asked.seconds, asked.passes)
        elif not absent_robots():
            case = CASES[name]()
            rows += step_rows(name, case, asked.seconds, asked.passes)
            rows += certificate_rows(name, case, asked.seconds, asked.passes)
    harness.show("where everything moves", rows)
    tell(versions(LIBRARIES))
    harness.write_csv(rows, asked.csv)
    return rows


def step_rows(name: str, case: Case, seconds: float, passes: int) -> list[Row]:
    """Ours and every peer's loop on one case."""
    actors = Actors(case)
    peers = [by for by in map(peer, LIBRARIES) if by is not None]
    loops = [OurLoop(actors), *(PeerLoop(actors, by) for by in peers)]
    steps = [steps_for(loop, actors.n_steps, seconds / passes) for loop in loops]
    works = [partial(loop.run, own) for loop, own in zip(loops, steps, strict=True)]
    timings = interleaved(works, passes, seconds)
    ours = timings[0]
    return [
        {
            "case": name, "method": loop.name, "pairs": len(actors.pairs), "steps": actors.n_steps,
            "ms": 1e3 * timing.median / len(own), "passes": timing.n_passes, "steps_asked": len(own),
            "ratio": timing.median / len(own) / (ours.median / actors.n_steps), "ratio_of": "a step of ours",
            "greatest_difference_m": float(np.abs(np.maximum(timing.answer, 0.0) - ours.answer[own]).max()),
        }
        for loop, own, timing in zip(loops, steps, timings, strict=True)
    ]  # fmt: skip


def certificate_rows(name: str, case: Case, seconds: float, passes: int) -> list[Row]:
    """A certificate to 0.1 mm in parts of the run's own `steps`; all phases and rules, laid out anew."""
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    plan = section_plan(timeline)

    def steps() -> list:
        return [measure(replace(own.in_motion), "steps", ONE_THREAD) for own in plan.sections]

    found = steps()

    def certified() -> list:
        return [
            certify_motion(replace(own.in_motion), one, CERTIFY_GAP, resources=ONE_THREAD)
            for own, one in zip(plan.sections, found, strict=True)
        ]

    timings = interleaved([steps, certified], passes, seconds)
    n_steps = timeline.motions[0].n_steps
    return [
        {
            "case": name, "method": method, "pairs": len(plan.pairs), "steps": n_steps,
            "ms": 1e3 * timing.median / n_steps, "passes": timing.n_passes,
            "ratio": timing.median / timings[0].median, "ratio_of": "its own steps",
        }
        for method, timing in zip(("steps", "certificate to 0.1 mm"), timings, strict=True)
    ]  # fmt: skip


class Actors:
    """A case in which nothing changes hands, ready to be measured: its pairs, its motion, its bodies."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.motions = tuple(kinematic_motion(placed) for placed in case.robots)
        self.pairs, _ = measured_pairs(case)
        bodies = sorted({body for pair in self.pairs for body in pair})
        self.index = [(bodies.index(p.a), bodies.index(p.b)) for p in self.pairs]
        self.n_steps = self.motions[0].n_steps
        self.solids = [solid(body.body_in(case)) for body in bodies]
        poses = link_poses_at(case, self.motions, slice(None))
        self.poses = np.stack([body.poses_in(case, poses) for body in bodies])


class OurLoop:
    """Kinematics, laying out and sweep, all in the clock."""

    name, coherent = "clearance: steps", True

    def __init__(self, actors: Actors) -> None:
        self._actors = actors

    def run(self, steps: np.ndarray) -> np.ndarray:
        """All steps."""
        own = self._actors
        pairs = PairsInMotion(own.case, own.motions, own.pairs)
        return measure(pairs, "steps", ONE_THREAD).clearance[steps]


class PeerLoop:
    """Every pair at every step by one peer, bodies placed beforehand by us."""

    coherent = False

    def __init__(self, actors: Actors, by: PairPeer) -> None:
        self._actors, self._peer, self.name = actors, by, f"{by.name}: all pairs"
        with silenced():
            self._bodies = [by.body(each) for each in actors.solids]

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        return np.array([self._step(int(step)) for step in steps])

    def _step(self, step: int) -> float:
        bodies, distance = self._bodies, self._peer.distance
        for body, pose in zip(bodies, self._actors.poses[:, step], strict=True):
            self._peer.place(body, pose)
        return min(distance(bodies[i], bodies[j]) for i, j in self._actors.index)


if __name__ == "__main__":
    main()
