"""Prints what two arms on clocks that nothing ties cost: the least of all steps, and the proof between them.

    python scripts/bench/unsynchronised.py [--robots FOLDER] [--slack S ...] [--steps N] [--jobs J] [--grid N]

Two arms stand face to face and wave, 300 steps each in 10 s; every pair of a link of either is measured. Beside
the proof stands the least of a grid of N x N pairs of times, by single questions of the pairs whose balls come
near enough: it may not be below the proof. Seconds are those of the processor, medians of three. FOLDER holds
`panda_vamp` and `kuka_iiwa_pybullet`; where it is not there, two carts of `robots/gantry_box` wave instead.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import ROOT, SHARED, Row

import clearance as cl
from clearance.simulate.measure.clocks.pairs import ClockMotion, PairsOfTwoClocks
from clearance.simulate.measure.clocks.unsynchronised import (
    UnsynchronisedAnswers,
    least_unsynchronised,
)
from clearance.simulate.measure.resources import Resources
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import BodyIndex, Pair, measured_pairs
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import Trajectory

ARMS = {
    "panda": ("panda_vamp/panda.urdf", (0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.7)),
    "kuka": ("kuka_iiwa_pybullet/model.urdf", (0.0, 0.3, 0.0, -1.5, 0.0, 1.0, 0.0)),
    "cart": ("gantry_box/gantry_box.urdf", (-2.0,)),
}
GAP = 1e-4
APART = (1.0, 1.4)
"""[m] Between the bases."""

SMALLEST = ["--robots", str(ROOT / "robots"), "--steps", "30", "--slack", "inf", "--grid", "20"]


class Scene(NamedTuple):
    """Two arms whose clocks are two."""

    name: str
    case: cl.Case
    motions: list[Motion]
    pairs: list[Pair]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__,
        words,
        robots=str(SHARED / "robots"),
        slack=[np.inf, 0.2],
        steps=300,
        jobs=1,
        grid=0,
    )
    rows: list[Row] = []
    arms = (("panda", "panda"), ("kuka", "kuka"), ("panda", "kuka"))
    if not (Path(asked.robots) / "panda_vamp").is_dir():
        asked.robots, arms = str(ROOT / "robots"), (("cart", "cart"),)
    for names in arms:
        for apart in APART:
            scene = scene_of(Path(asked.robots), names, apart, asked.steps)
            rows += [row_of(scene, apart, asked, slack) for slack in asked.slack]
            harness.write_csv(rows, asked.csv)
    harness.show("arms on clocks that are not tied", rows)
    return rows


def row_of(scene: Scene, apart: float, asked: argparse.Namespace, slack: float) -> Row:
    """What the proof of one scene comes to and takes."""
    found, steps, proof = measured(scene, slack, asked.jobs)
    bounds = found.intervals
    grid = 1e3 * least_of_grid(scene, slack, asked.grid) if asked.grid else None
    return {
        "arms": scene.name, "apart": apart, "pairs": len(scene.pairs), "slack": slack,
        "proven_mm": 1e3 * bounds.lower.min(), "seen_mm": 1e3 * bounds.upper.min(),
        "grid_mm": grid, "steps_s": steps, "proof_s": proof,
        "rectangles": found.steps_tally["rectangles"] + found.intervals_tally["rectangles"],
        "searches": found.steps_tally["queries"] + found.intervals_tally["queries"],
        "gap_mm": 1e3 * (bounds.upper - bounds.lower).max(),
    }  # fmt: skip


def scene_of(folder: Path, names: tuple[str, str], apart: float, n_steps: int) -> Scene:
    """Two arms face to face, their bases so far apart [m]."""
    random = np.random.default_rng(1)
    facing = np.diag([-1.0, -1.0, 1.0, 1.0])
    facing[0, 3] = apart
    placed = [
        arm(folder, name, random, base, n_steps, i)
        for i, (name, base) in enumerate(zip(names, (np.eye(4), facing), strict=True))
    ]
    case = cl.Case("two_clocks", tuple(placed), ())
    motions = [kinematic_motion(each) for each in placed]
    return Scene(" and ".join(names), case, motions, measured_pairs(case)[0])


def arm(
    folder: Path, name: str, random: np.random.Generator, base: np.ndarray, n_steps: int, i: int
) -> PlacedRobot:
    """An arm that waves about its rest."""
    urdf, rest = ARMS[name]
    robot = cl.load_robot(folder / urdf, package_dirs=[(folder / urdf).parent])
    joints = [joint.name for joint in robot.moving_joints][: len(rest)]
    times, n = np.linspace(0.0, 10.0, n_steps), len(rest)
    rate, phase = random.uniform(0.3, 1.5, n), random.uniform(0.0, 6.0, n)
    size = random.uniform(0.2, 0.5, n) * np.array([3.0, *[1.0] * (n - 1)])
    positions = np.array(rest) + size * np.sin(times[:, None] * rate + phase)
    path = Trajectory(times, tuple(joints), positions)
    return PlacedRobot(replace(robot, name=f"{name}_{i}"), path, base)


def measured(scene: Scene, slack: float, jobs: int) -> tuple[UnsynchronisedAnswers, float, float]:
    """The answers, and the median processor seconds of the steps and of the proof."""
    n_steps, runs = scene.motions[0].n_steps, []
    side = ClockMotion(scene.case, scene.motions)
    second = frozenset([BodyIndex(1, 0)])
    for _ in range(4):  # the first one warms up
        marks = [time.process_time()]

        def note(done: int, of: int, marks: list[float] = marks) -> None:
            if done == n_steps:
                marks.append(time.process_time())

        pairs = PairsOfTwoClocks(side, side, second, scene.pairs, scene.case.limits, slack)
        found = least_unsynchronised(pairs, GAP, Resources(jobs, note))
        runs.append((marks[1] - marks[0], time.process_time() - marks[1]))
    steps, proof = (statistics.median(column) for column in zip(*runs[1:], strict=True))
    return found, steps, proof


def least_of_grid(scene: Scene, slack: float, n: int) -> float:
    """[m] the least over a grid of both times, of those pairs whose balls come near enough, nearest first."""
    shares = np.linspace(0.0, scene.motions[0].times[-1], n)
    poses = np.concatenate([poses_at(motion, shares) for motion in scene.motions], axis=1)
    best = np.inf
    for pair in scene.pairs:
        shapes = [body.shape_in(scene.case) for body in pair]
        at = [body.poses_in(scene.case, poses) for body in pair]
        balls = [ball_of(*each) for each in zip(shapes, at, strict=True)]
        apart = np.linalg.norm(balls[0][0][:, None] - balls[1][0][None], axis=2)
        apart[np.abs(shares[:, None] - shares[None]) > slack] = np.inf
        for cell in np.argsort(apart, axis=None).tolist():
            i, k = divmod(cell, n)
            if apart[i, k] - balls[0][1] - balls[1][1] >= best:
                break
            best = min(best, cl.distance(*shapes, pose_a=at[0][i], pose_b=at[1][k]).distance)
    return best


def ball_of(shape: cl.Polyhedron, poses: np.ndarray) -> tuple[np.ndarray, float]:
    """The centres (n, 3) of a body's ball at some poses, and its radius [m]."""
    centre = shape.bounds.mean(axis=0)
    radius = float(np.linalg.norm(shape.vertices - centre, axis=1).max())
    return poses[:, :3, :3] @ centre + poses[:, :3, 3], radius


def poses_at(motion: Motion, times: np.ndarray) -> np.ndarray:
    """(k, n_links, 4, 4) at times [s]."""
    steps = np.clip(np.searchsorted(motion.times, times, side="right") - 1, 0, motion.n_steps - 2)
    shares = (times - motion.times[steps]) / (motion.times[steps + 1] - motion.times[steps])
    at = [motion.positions_after(int(i), float(s)) for i, s in zip(steps, shares, strict=True)]
    return link_poses(motion.placed, np.array(at))


if __name__ == "__main__":
    main()
