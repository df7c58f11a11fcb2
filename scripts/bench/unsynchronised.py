"""Prints what two arms on clocks that nothing ties cost: the least of all steps, and the proof between them.

    python scripts/bench/unsynchronised.py [--robots FOLDER] [--slack S] [--steps N] [--jobs J] [--grid N]

Two arms stand face to face and wave, 300 steps each in 10 s; every pair of a link of either is measured. Beside
the proof stands the least of a grid of N x N pairs of times, by single questions of the pairs whose balls come
near enough: it may not be below the proof. Seconds are those of the processor, compiled, medians of three.
FOLDER holds `panda_vamp` and `kuka_iiwa_pybullet`.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from inputs import SHARED
from rich.console import Console
from rich.table import Table

import clearance as cl
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.formats import read_robot
from clearance.formats.robot.request import RobotRequest
from clearance.simulate.measure.clocks.pairs import ClockMotion, PairsOfTwoClocks
from clearance.simulate.measure.clocks.unsynchronised import (
    UnsynchronisedAnswers,
    least_unsynchronised,
)
from clearance.simulate.measure.resources import Resources
from clearance.world.case import PlacedRobot
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import BodyIndex, Pair, measured_pairs
from clearance.world.trajectory import Trajectory

ARMS = {
    "panda": ("panda_vamp/panda.urdf", (0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.7)),
    "kuka": ("kuka_iiwa_pybullet/model.urdf", (0.0, 0.3, 0.0, -1.5, 0.0, 1.0, 0.0)),
}

GAP = 1e-4
COLUMNS = (
    "arms",
    "apart",
    "links",
    "slack",
    "least",
    "of grid",
    "steps s",
    "proof s",
    "rectangles",
    "searches",
    "gap mm",
)


class Scene(NamedTuple):
    """Two arms whose clocks are two."""

    name: str
    case: cl.Case
    motions: list[Motion]
    pairs: list[Pair]


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
    return Scene(
        " and ".join(names),
        case,
        [kinematic_motion(each) for each in placed],
        measured_pairs(case)[0],
    )


def arm(
    folder: Path, name: str, random: np.random.Generator, base: np.ndarray, n_steps: int, i: int
) -> PlacedRobot:
    """An arm that waves about its rest."""
    urdf, rest = ARMS[name]
    path = folder / urdf
    robot = read_robot(RobotRequest(path, (path.parent,)), MeshStore(InputFiles(path.parent)))
    joints = [joint.name for joint in robot.moving_joints][: len(rest)]
    times = np.linspace(0.0, 10.0, n_steps)
    rate, phase = random.uniform(0.3, 1.5, len(rest)), random.uniform(0.0, 6.0, len(rest))
    size = random.uniform(0.2, 0.5, len(rest)) * np.array([3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    positions = np.array(rest) + size * np.sin(times[:, None] * rate + phase)
    return PlacedRobot(
        replace(robot, name=f"{name}_{i}"), Trajectory(times, tuple(joints), positions), base
    )


def two_clocks(scene: Scene, slack: float) -> PairsOfTwoClocks:
    """The pairs of both arms, the second arm on its own clock."""
    side = ClockMotion(scene.case, scene.motions)
    second = frozenset([BodyIndex(1, 0)])
    return PairsOfTwoClocks(side, side, second, scene.pairs, scene.case.limits, slack)


def least_of_grid(scene: Scene, slack: float, n: int) -> float:
    """[m] the least over a grid of both times, of those pairs whose boxes of corners come near enough."""
    times = scene.motions[0].times
    shares = np.linspace(0.0, times[-1], n)
    poses = np.concatenate([poses_at(motion, shares) for motion in scene.motions], axis=1)
    best = np.inf
    for pair in scene.pairs:
        a, b = pair.a.shape_in(scene.case), pair.b.shape_in(scene.case)
        at_a, at_b = pair.a.poses_in(scene.case, poses), pair.b.poses_in(scene.case, poses)
        balls = [ball_of(shape.vertices, at) for shape, at in ((a, at_a), (b, at_b))]
        for i, k in cells(balls, shares, slack):
            way = np.linalg.norm(balls[0][0][i] - balls[1][0][k]) - balls[0][1] - balls[1][1]
            if way < best:
                best = min(best, cl.distance(a, b, pose_a=at_a[i], pose_b=at_b[k]).distance)
    return best


def cells(balls: list, shares: np.ndarray, slack: float) -> Iterator[tuple[int, int]]:
    """The cells of the grid in the band, those whose balls are nearest first."""
    apart = np.linalg.norm(balls[0][0][:, None] - balls[1][0][None], axis=2)
    apart[np.abs(shares[:, None] - shares[None]) > slack] = np.inf
    order = np.argsort(apart, axis=None)
    for cell in order[: np.isfinite(apart).sum()]:
        yield divmod(int(cell), len(shares))


def ball_of(vertices: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, float]:
    """The centres (n, 3) of a body's ball at some poses, and its radius [m]."""
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    radius = float(np.linalg.norm(vertices - centre, axis=1).max())
    return poses[:, :3, :3] @ centre + poses[:, :3, 3], radius


def poses_at(motion: Motion, times: np.ndarray) -> np.ndarray:
    """(k, n_links, 4, 4) at times [s]."""
    steps = np.clip(np.searchsorted(motion.times, times, side="right") - 1, 0, motion.n_steps - 2)
    shares = (times - motion.times[steps]) / (motion.times[steps + 1] - motion.times[steps])
    at = [motion.positions_after(int(i), float(s)) for i, s in zip(steps, shares, strict=True)]
    return link_poses(motion.placed, np.array(at))


def measured(scene: Scene, slack: float, jobs: int) -> tuple[UnsynchronisedAnswers, float, float]:
    """The answers, and the median processor seconds of the steps and of the proof."""
    n_steps = scene.motions[0].n_steps
    marks: list[float] = []
    runs = []
    for _ in range(4):  # the first one compiles
        marks.clear()
        start = time.process_time()

        def note(done: int, of: int) -> None:
            if done == n_steps:
                marks.append(time.process_time())

        found = least_unsynchronised(two_clocks(scene, slack), GAP, Resources(jobs, note))
        runs.append((marks[0] - start, time.process_time() - marks[0]))
    steps, proof = (statistics.median(column) for column in zip(*runs[1:], strict=True))
    return found, steps, proof


def row_of(scene: Scene, apart: float, asked: argparse.Namespace, slack: float) -> list[str]:
    """One line of the table."""
    found, steps, proof = measured(scene, slack, asked.jobs)
    bounds = found.intervals
    grid = f"{least_of_grid(scene, slack, asked.grid) * 1000:.3f}" if asked.grid else ""
    return [
        scene.name, f"{apart:g}", str(len(scene.pairs)), f"{slack:g}",
        f"{bounds.lower_bound.min() * 1000:.3f} to {bounds.upper_bound.min() * 1000:.3f}", grid,
        f"{steps:.3f}", f"{proof:.3f}",
        f"{found.steps_tally['rectangles']} {found.intervals_tally['rectangles']}",
        f"{found.steps_tally['queries']} {found.intervals_tally['queries']}",
        f"{(bounds.upper_bound - bounds.lower_bound).max() * 1000:.4f}",
    ]  # fmt: skip


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--robots", type=Path, default=SHARED / "robots", metavar="FOLDER")
    parser.add_argument("--slack", type=float, nargs="*", default=[np.inf, 0.2], metavar="S")
    parser.add_argument("--steps", type=int, default=300, metavar="N")
    parser.add_argument("--jobs", type=int, default=1, metavar="J")
    parser.add_argument("--grid", type=int, default=0, metavar="N")
    asked = parser.parse_args()
    table = Table(*COLUMNS)
    for names in (("panda", "panda"), ("kuka", "kuka"), ("panda", "kuka")):
        for apart in (1.0, 1.4):
            scene = scene_of(asked.robots, names, apart, asked.steps)
            for slack in asked.slack:
                row = row_of(scene, apart, asked, slack)
                print(*row, sep=" | ", file=sys.stderr, flush=True)
                table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else 160).print(table)


if __name__ == "__main__":
    main()
