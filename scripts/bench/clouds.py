"""Prints what a cloud of points costs beside a mesh of as many triangles: time, memory, and the trees of both.

    python scripts/bench/clouds.py [--count N] [--passes N] [--csv FILE]

One robot, the Panda of `scenes/panda_shelf` on its way, in what a scanner might see: a table with things on it,
a vault all round, and the table higher, so that the arm is in it for half of its way. The mesh is the surface;
the cloud is one point a triangle, in its middle. CPU seconds, least of interleaved passes after one to warm up;
memory in bytes of the arrays that are searched. The target is that the cloud takes no more than three times as
long a step as the mesh.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path

from inputs import scene_of  # first: it sets the number of threads before numpy is loaded

import numpy as np  # isort: skip

from clock import interleaved, timed
from rich.console import Console
from rich.table import Table
from rows import write_csv

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

COLUMNS = ("scene", "what", "mesh", "cloud", "ratio")

SCENES = Path(__file__).parents[2] / "scenes"

RADIUS = 0.003
"""[m] Of each ball."""


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=1_000_000, help="triangles, and points")
    parser.add_argument("--passes", type=int, default=5)
    parser.add_argument("--csv", type=Path, help="write the rows here")
    asked = parser.parse_args()
    rows = []
    for name, height in (("table", table), ("vault", vault), ("in contact", table_in_arm)):
        rows += rows_of(name, *mesh_and_cloud(height, asked.count), asked.passes)
    Console(width=None if sys.stdout.isatty() else 132).print(table_of(rows, asked.count))
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def rows_of(name: str, mesh: Polyhedron, cloud: PointCloud, n_passes: int) -> list[dict]:
    """All that is compared in one scene."""
    built = [timed(lambda shape=shape: surface_of(shape)) for shape in (mesh, cloud)]
    sizes = [sum(one.nbytes for one in {id(a): a for a in tree}.values()) for _, tree in built]
    whats = [in_motion(Obstacle(Body("scan", shape))) for shape in (mesh, cloud)]
    found = [measure(what, resources=Resources(jobs=1)) for what in whats]
    print(
        name, "least clearance [mm]:", *(f"{1e3 * np.nanmin(one.clearance):.3f}" for one in found)
    )
    n_steps = len(found[0].clearance)
    swept = interleaved(
        [lambda what=what: measure(what, resources=Resources(jobs=1)) for what in whats],
        n_passes, 200.0,
    )  # fmt: skip
    proven = interleaved(
        [
            lambda what=what, one=one: certify_motion(
                what, one, CERTIFY_GAP, resources=Resources(jobs=1)
            )
            for what, one in zip(whats, found, strict=True)
        ],
        2, 200.0,
    )  # fmt: skip
    pairs = {
        "tree, s": [seconds for seconds, _ in built],
        "memory of the tree, MB": [size / 1e6 for size in sizes],
        "a step, ms": [1e3 * one.least / n_steps for one in swept],
        "certificate of a step, ms": [1e3 * one.least / n_steps for one in proven],
        "nodes a step": [one.tally["node_tests"] / n_steps for one in found],
    }
    return [
        {
            "scene": name,
            "what": what,
            "mesh": of_mesh,
            "cloud": of_cloud,
            "ratio": of_cloud / of_mesh,
        }
        for what, (of_mesh, of_cloud) in pairs.items()
    ]


def in_motion(obstacle: Obstacle) -> PairsInMotion:
    """The Panda of the shelf scene on its way, with nothing but one obstacle."""
    case: Case = dataclasses.replace(
        scene_of(SCENES / "panda_shelf" / "case.yaml").case, obstacles=(obstacle,), allow=()
    )
    pairs, _ = measured_pairs(case)
    return PairsInMotion(case, tuple(kinematic_motion(placed) for placed in case.robots), pairs)


def mesh_and_cloud(points_of, count: int) -> tuple[Polyhedron, PointCloud]:
    """A surface of some `count` triangles, and the middles of these as a cloud."""
    n = round(np.sqrt(count / 2.0))
    u, v = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1), indexing="ij")
    points = points_of(u, v).reshape(-1, 3)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    one = np.stack([corner, corner + n + 1, corner + 1], axis=1)
    two = np.stack([corner + n + 1, corner + n + 2, corner + 1], axis=1)
    triangles = np.concatenate([one, two])
    middles = points[triangles].mean(axis=1)
    return Polyhedron(points, triangles), PointCloud(middles, RADIUS)


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


def table_of(rows: list[dict], count: int) -> Table:
    """All rows."""
    shown = Table(title=f"{count:,} triangles or points", title_justify="left")
    for column in COLUMNS:
        shown.add_column(column, justify="left" if column in COLUMNS[:2] else "right")
    for row in rows:
        numbers = [f"{row[name]:.4g}" for name in COLUMNS[2:]]
        shown.add_row(row["scene"], row["what"], *numbers)
    return shown


if __name__ == "__main__":
    main()
