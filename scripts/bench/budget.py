"""What tolerances cost and how tight their proof is, over the scenes: `python scripts/bench/budget.py`.

For each scene, with the same figures of a typical cell: the least that is proven; the least found by errors at
random and by making one after the other as bad as it can be, on distances measured anew; the sum of reach times
error that people add by hand; time with and without, steps alone and certified. `budget_campaign.py` draws random
budgets instead.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from clock import least_time
from inputs import SCENES

import clearance as cl
from clearance.budget.proven import PairsWithErrors, proven_between, proven_of_steps
from clearance.query.distance import distance
from clearance.record.measurement import Measurement
from clearance.run.answers import measurement_plan
from clearance.run.question import Question
from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.sections import Section
from clearance.tolerance import CERTIFY_GAP
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.pairs import BodyIndex
from tests.oracle.perturbed import Perturbed, ascended, random_errors, sizes

NAMES = ("box_box", "box_pipe", "hot_cell", "iiwa_pipe_rack", "panda_shelf", "turntable_cell")
NEAREST = 3
"""Pairs that are measured anew at a moment beside the one that decides it: the nearest."""


def typical(case: Case) -> Budget:
    """Repeatability and calibration of a typical cell."""
    frame = PlacementTolerance(0.0002, 0.0001)
    robots = {
        placed.robot.name: RobotTolerance(
            {joint.name: JointTolerance(0.0005, 0.0, frame) for joint in placed.robot.joints},
            PlacementTolerance(0.002, 0.001),
            dict.fromkeys(placed.robot.link_names, 0.0005),
        )
        for placed in case.robots
    }
    place = ObstacleTolerance(PlacementTolerance(0.001), 0.0005)
    return Budget(robots, {obstacle.name: place for obstacle in case.obstacles})


def scaled(case: Case, rng: np.random.Generator, factor: float) -> Budget:
    """Random tolerances of up to so many times those."""
    base = typical(case)

    def by(most: float) -> float:
        return float(factor * most * rng.random())

    def place(own: PlacementTolerance) -> PlacementTolerance:
        return PlacementTolerance(by(own.xyz), by(max(own.angle, 0.0005)))

    robots = {
        name: replace(
            own,
            joints={
                j: JointTolerance(by(t.position), 0.0, place(t.frame))
                for j, t in own.joints.items()
            },
            base=place(own.base),
            surfaces={link: by(s) for link, s in own.surfaces.items()},
        )
        for name, own in base.robots.items()
    }
    obstacles = {
        n: ObstacleTolerance(place(o.place), by(o.surface)) for n, o in base.obstacles.items()
    }
    return Budget(robots, obstacles)


class Measured(Perturbed):
    """Pairs whose bodies are measured where errors put them."""

    def each(self, time: float, errors: dict) -> dict[tuple[str, str], float]:
        poses = self.poses(time, errors)
        return {
            (a, b): distance(
                self.shapes[a], self.shapes[b], pose_a=poses[a], pose_b=poses[b]
            ).distance
            - self.surface(a)
            - self.surface(b)
            for a, b in self.pairs
        }

    def __post_init__(self) -> None:
        robots = self.case.robots
        links = {f"{p.robot.name}/{b.name}": b.shape for p in robots for b in p.robot.bodies}
        self.shapes = links | {o.name: o.body.shape for o in self.case.obstacles}


def name_of(case: Case, body: BodyIndex) -> str:
    """The name of a body with its robot's before it."""
    own = body.own_name_in(case)
    return own if body.is_obstacle else f"{case.robots[body.i_robot].robot.name}/{own}"


def worst_found(
    case: Case,
    section: Section,
    step: int,
    pair: int,
    n_random: int,
    n_ascended: int,
    rng: np.random.Generator,
) -> float:
    """[m] the least that is found left at a step."""
    machine = Measured(case, [])
    names = [(name_of(case, p.a), name_of(case, p.b)) for p in section.pairs]
    moment = float(section.phase.times[step])
    poses = machine.poses(moment, {})
    shapes = machine.shapes
    gaps = [
        distance(shapes[a], shapes[b], pose_a=poses[a], pose_b=poses[b]).distance for a, b in names
    ]
    machine.pairs = [names[i] for i in {pair, *np.argsort(gaps)[:NEAREST].tolist()}]
    wanted = sizes(case)
    zero = {key: np.zeros(size.n) for key, size in wanted.items()}
    least = machine.left(moment, zero)
    for _ in range(n_random):
        least = min(least, machine.left(moment, random_errors(wanted, rng)))
    for i in range(n_ascended):
        start = zero if i == 0 else random_errors(wanted, rng)
        least = min(least, ascended(lambda e: machine.left(moment, e), wanted, start)[0])
    return least


def naive(case: Case, section: Section, pair: int) -> float:
    """[m] what people take off by hand: angles times how far the arm reaches, and lengths."""
    body = section.pairs[pair].a
    robot = case.robots[max(0, body.i_robot)].robot
    own = case.tolerance.robots[robot.name]
    box = body.shape_in(case).vertices
    reach = float(np.abs(box).max())
    total = 0.0
    parents = {joint.child: joint for joint in robot.joints}
    link = body.own_name_in(case)
    while link in parents:
        joint = parents[link]
        tolerance = own.joints[joint.name]
        size = tolerance.position * (1.0 if joint.kind.value == "prismatic" else reach)
        total += size + tolerance.frame.angle * reach + tolerance.frame.xyz
        reach += float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        link = joint.parent
    total += own.base.angle * reach + own.base.xyz + own.surfaces.get(body.own_name_in(case), 0.0)
    other = section.pairs[pair].b
    if other.is_obstacle:
        obstacle = case.tolerance.obstacles[case.obstacles[other.i_body].name]
        total += obstacle.place.xyz + obstacle.surface
    return total


def milliseconds(work: Callable[[], object]) -> float:
    """[ms] of CPU time, the least of five."""
    return 1e3 * least_time(work, 5)


def sections_of(
    name: str, budget: Callable[[Case], Budget]
) -> Iterator[tuple[Case, Section, Measurement]]:
    """The case of a scene with a budget, its sections and what is measured of each."""
    case = cl.load_case(SCENES / name / "case.yaml")
    case = replace(case, tolerance=budget(case))
    for section in measurement_plan(Question(case)).sections.sections:
        yield case, section, measure(section.in_motion)


def table(n_random: int, n_ascended: int) -> None:
    """One line a section of each scene."""
    print(
        "scene, pair, nominal, proven, worst found [mm], tightness, naive/worst, steps, certified (ratio of time)"
    )
    rng = np.random.default_rng(1)
    for name in NAMES:
        for case, section, found in sections_of(name, typical):
            pairs = PairsWithErrors(section.in_motion, case.tolerance)
            rows = proven_of_steps(pairs, found)
            step = int(np.argmin(rows.proven))
            pair = int(rows.pair[step])
            if found.clearance[step] <= 0.0 or section.pairs[pair].a.is_obstacle:
                continue
            worst = worst_found(case, section, step, pair, n_random, n_ascended, rng)
            nominal = float(found.clearance[step])
            taken = nominal - worst
            proven_between(pairs, rows, CERTIFY_GAP)
            certify_motion(section.in_motion, found, CERTIFY_GAP)
            steps = milliseconds(lambda s=section: measure(s.in_motion))
            extra = milliseconds(lambda p=pairs, f=found: proven_of_steps(p, f))
            motion = milliseconds(
                lambda s=section, f=found: certify_motion(s.in_motion, f, CERTIFY_GAP)
            )
            more = milliseconds(lambda p=pairs, r=rows: proven_between(p, r, CERTIFY_GAP))
            names = "-".join(name_of(case, body).split("/")[-1] for body in section.pairs[pair])
            print(
                f"{name}, {names}, {nominal * 1e3:.3f}, {rows.proven[step] * 1e3:.3f}, {worst * 1e3:.3f}, "
                f"{(nominal - rows.proven[step]) / taken:.4f}, {naive(case, section, pair) / taken:.2f}, "
                f"{1 + extra / steps:.2f}, {1 + (extra + more) / (steps + motion):.2f}",
                flush=True,
            )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=20, help="samples at random a worst moment")
    parser.add_argument("--ascended", type=int, default=1, help="samples made as bad as can be")
    asked = parser.parse_args()
    table(asked.random, asked.ascended)


if __name__ == "__main__":
    main()
