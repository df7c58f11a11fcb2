"""Prints what a cloud of points costs beside a mesh of as many triangles: time, memory, and the trees of both.

    python scripts/bench/clouds.py [--count N] [--passes N] [--csv FILE]

One robot, the Panda of `scenes/panda_shelf` on its way, in what a scanner might see: a table with things on it,
a vault all round, and the table higher, so that the arm is in it for half of its way. The mesh is the surface;
the cloud is one point a triangle, in its middle. CPU seconds, least of interleaved passes after one to warm up;
memory in bytes of the arrays that are searched.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import SCENES, Row, interleaved, timed

from clearance import load_case
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.tolerance import CERTIFY_GAP
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs

RADIUS = 0.003
"""[m] Of each ball."""

ONE_THREAD = Resources(jobs=1)

SMALLEST = ["--count", "500", "--passes", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, count=1_000_000, passes=5)
    rows: list[Row] = []
    for name, height in (("table", table), ("vault", vault), ("in contact", table_in_arm)):
        rows += rows_of(name, mesh_and_cloud(height, asked.count), asked.passes)
    harness.show(f"{asked.count:,} triangles or points", rows)
    harness.write_csv(rows, asked.csv)
    return rows


def rows_of(name: str, shapes: tuple[Polyhedron, PointCloud], n_passes: int) -> list[Row]:
    """All that is compared in one scene."""
    built = [timed(lambda shape=shape: surface_of(shape)) for shape in shapes]
    sizes = [sum(one.nbytes for one in {id(a): a for a in tree}.values()) for _, tree in built]
    whats = [in_motion(Obstacle(Body("scan", shape))) for shape in shapes]
    works = [lambda what=what: measure(what, resources=ONE_THREAD) for what in whats]
    swept = interleaved(works, n_passes, 200.0)
    found = [timing.answer for timing in swept]
    proofs = [
        lambda what=what, one=one: certify_motion(what, one, CERTIFY_GAP, resources=ONE_THREAD)
        for what, one in zip(whats, found, strict=True)
    ]
    proven = interleaved(proofs, 2, 200.0)
    n_steps = len(found[0].clearance)
    pairs = {
        "least clearance, mm": [1e3 * np.nanmin(one.clearance) for one in found],
        "tree, s": [seconds for seconds, _ in built],
        "memory of the tree, MB": [size / 1e6 for size in sizes],
        "a step, ms": [1e3 * one.least / n_steps for one in swept],
        "certificate of a step, ms": [1e3 * one.least / n_steps for one in proven],
        "nodes a step": [one.tally["node_tests"] / n_steps for one in found],
    }
    return [
        {"scene": name, "what": what, "mesh": float(mesh), "cloud": float(cloud),
         "ratio": float(cloud / mesh) if mesh else None}
        for what, (mesh, cloud) in pairs.items()
    ]  # fmt: skip


def in_motion(obstacle: Obstacle) -> PairsInMotion:
    """The Panda of the shelf scene on its way, with nothing but one obstacle."""
    case = replace(shelf(), obstacles=(obstacle,), allow=())
    pairs, _ = measured_pairs(case)
    return PairsInMotion(case, tuple(kinematic_motion(placed) for placed in case.robots), pairs)


@functools.cache
def shelf() -> Case:
    """The scene of the shelf."""
    return load_case(SCENES / "panda_shelf" / "case.yaml")


def mesh_and_cloud(points_of, count: int) -> tuple[Polyhedron, PointCloud]:
    """A surface of some `count` triangles, and the middles of these as a cloud."""
    n = round(np.sqrt(count / 2.0))
    u, v = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1), indexing="ij")
    points = points_of(u, v).reshape(-1, 3)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    one = np.stack([corner, corner + n + 1, corner + 1], axis=1)
    two = np.stack([corner + n + 1, corner + n + 2, corner + 1], axis=1)
    triangles = np.concatenate([one, two])
    return Polyhedron(points, triangles), PointCloud(points[triangles].mean(axis=1), RADIUS)


def table(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(…, 3) [m] a table 1.6 m wide with things on it, rough to a millimetre."""
    x, y = 0.3 + 0.8 * u, 1.6 * (v - 0.5)
    z = 0.42 + 0.12 * np.exp(-((x - 0.8) ** 2 + (y - 0.3) ** 2) / 0.005)
    z += 0.2 * np.exp(-((x - 0.6) ** 2 + (y + 0.4) ** 2) / 0.01) + rough(u)
    return np.stack([x, y, z], axis=-1)


def table_in_arm(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(…, 3) [m] the table 100 mm higher."""
    return table(u, v) + [0.0, 0.0, 0.1]


def vault(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(…, 3) [m] a vault of radius 1.2 m about the robot, rough to a millimetre."""
    azimuth, height = 2.0 * np.pi * u, 1.5 * v
    radius = 1.2 + 0.02 * np.sin(9.0 * azimuth) * np.sin(11.0 * height) + rough(u)
    x, y = radius * np.cos(azimuth) * np.cos(height), radius * np.sin(azimuth) * np.cos(height)
    return np.stack([x, y, radius * np.sin(height)], axis=-1)


def rough(like: np.ndarray) -> np.ndarray:
    """[m] noise of a scanner."""
    return np.random.default_rng(5).normal(scale=0.0005, size=like.shape)


if __name__ == "__main__":
    main()
