"""Prints what one question about two bodies costs that were never asked about before: ours and the peers'.

    python scripts/bench/single_pairs.py [--pairs NAME ...] [--poses N] [--csv FILE] [--seconds S]

Trees are built beforehand; poses are random and far from one another, so that nothing can be carried over.
Ours is asked by `cl.distance`, by `cl.Query.distance` and by `cl.Query.distances` for all poses at once; the
peers place one body and ask. Microseconds of CPU a question, median over interleaved passes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from inputs import Solid, solid  # first: it sets the number of threads before numpy is loaded

import numpy as np  # isort: skip

from clock import interleaved
from peers import Coal, Fcl, Klampt, absent_peers, available, silenced, versions
from rich.console import Console
from rich.table import Table
from rows import write_csv

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from scripts.makers.hostile_cases import at, ball, torus
from scripts.makers.polygon_pairs import rotations

COLUMNS = (
    "pair",
    "library",
    "method",
    "triangles",
    "us",
    "us_least",
    "ratio_to_ours",
    "greatest_difference_m",
)

Poses = np.ndarray
"""(n, 4, 4) `world_from_b` [m]; a stands."""


def anywhere(random: np.random.Generator, n: int) -> Poses:
    """Balls of radius 1 at gaps of 1 mm to 1 m, turned at random."""
    away = random.normal(size=(n, 3))
    away *= (2.0 + 10.0 ** random.uniform(-3, 0, (n, 1))) / np.linalg.norm(
        away, axis=1, keepdims=True
    )
    return np.array([at(*x, turned=r) for x, r in zip(away, rotations(random, n), strict=True)])


def crossed(random: np.random.Generator, n: int) -> Poses:
    """Pipes of radius 0.1 along z, over each other at gaps of 1 mm to 1 m and any angle above 15 degrees."""
    made = []
    for _ in range(n):
        angle, roll = random.uniform(0.26, np.pi - 0.26), random.uniform(0, 2 * np.pi)
        gap = 10.0 ** random.uniform(-3, 0)
        made.append(
            about_z(roll)
            @ at(0.2 + gap, 0, random.uniform(-0.5, 0.5))
            @ about_x(angle)
            @ about_z(roll)
        )
    return np.array(made)


def linked(random: np.random.Generator, n: int) -> Poses:
    """A ring through the hole of another, moved and turned a little, and by any angle about its own axis."""
    made = []
    for _ in range(n):
        moved = at(1.0 + random.uniform(-0.1, 0.1), *random.uniform(-0.1, 0.1, 2))
        made.append(
            moved
            @ about_x(np.pi / 2 + random.uniform(-0.2, 0.2))
            @ about_z(random.uniform(0, 6.28))
        )
    return np.array(made)


def about_x(angle: float) -> np.ndarray:
    """(4, 4) a turn about x [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return at(turned=np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]))


def about_z(angle: float) -> np.ndarray:
    """(4, 4) a turn about z [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return at(turned=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def pipe(n_triangles: int) -> Polyhedron:
    """A straight pipe whose two walls and rims have eight triangles a side of its outline."""
    return cl.pipe(inner_radius=0.08, outer_radius=0.1, length=2.0, sections=n_triangles // 8)


def ring(n_triangles: int) -> Polyhedron:
    """Four times across^2 triangles."""
    across = round((n_triangles / 4) ** 0.5)
    return torus(1.0, 0.25, 2 * across, across)


PAIRS: dict[str, tuple[Callable[[], Polyhedron], Callable[[np.random.Generator, int], Poses]]] = {
    "spheres 320": (lambda: ball(1.0, 2), anywhere),
    "spheres 5k": (lambda: ball(1.0, 4), anywhere),
    "spheres 82k": (lambda: ball(1.0, 6), anywhere),
    "crossed pipes 256": (lambda: pipe(256), crossed),
    "crossed pipes 1024": (lambda: pipe(1024), crossed),
    "crossed pipes 4096": (lambda: pipe(4096), crossed),
    "linked tori 1k": (lambda: ring(1024), linked),
    "linked tori 16k": (lambda: ring(16384), linked),
}


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--pairs", nargs="*", choices=list(PAIRS), default=None, metavar="NAME")
    parser.add_argument("--poses", type=int, default=40)
    parser.add_argument("--passes", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.5, help="CPU a method and pair")
    parser.add_argument("--csv", type=Path, help="write the rows here")
    asked = parser.parse_args()
    console = Console(width=None if sys.stdout.isatty() else 132)
    modules = ("fcl", "coal", "klampt")
    for line in absent_peers(modules):
        console.print(line, style="yellow", highlight=False)
    rows = [row for name in asked.pairs or PAIRS for row in rows_of(name, asked)]
    console.print(table_of(rows))
    console.print(summary(rows), highlight=False)
    console.print(versions(modules), highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def rows_of(name: str, asked: argparse.Namespace) -> list[dict]:
    """One row a way to ask; ours first."""
    make, place = PAIRS[name]
    poses = place(np.random.default_rng(23), asked.poses)
    a, b = solid(Body("a", make())), solid(Body("b", make()), stands=True)
    ways = ways_of(a, b, poses)
    timings = interleaved(list(ways.values()), asked.passes, asked.seconds)
    ours = timings[0]
    return [
        {
            "pair": name,
            "library": method.split(":")[0],
            "method": method,
            "triangles": len(a.soup.triangles),
            "us": timing.median / len(poses) * 1e6,
            "us_least": timing.least / len(poses) * 1e6,
            "ratio_to_ours": timing.median / ours.median,
            "greatest_difference_m": float(
                np.abs(np.maximum(timing.answer, 0.0) - ours.answer).max()
            ),
        }
        for method, timing in zip(ways, timings, strict=True)
    ]


def ways_of(a: Solid, b: Solid, poses: Poses) -> dict[str, Callable[[], np.ndarray]]:
    """Ways to ask for the distances at all poses, by name."""
    rest = np.eye(4)
    query = cl.Query(a.shape, b.shape)
    ways: dict[str, Callable[[], np.ndarray]] = {
        "clearance: distance": lambda: np.array(
            [cl.distance(a.shape, b.shape, pose_b=pose).distance for pose in poses]
        ),
        "clearance: Query.distance": lambda: np.array(
            [query.distance(rest, pose).distance for pose in poses]
        ),
        "clearance: Query.distances": lambda: query.distances(rest, poses).distances,
    }
    for kind, module in ((Fcl, "fcl"), (Coal, "coal"), (Klampt, "klampt")):
        if available(module):
            with silenced():
                peer = kind()
                ways[f"{peer.name}: distance"] = _asking(peer, peer.body(a), peer.body(b), poses)
    return ways


def _asking(peer, a, b, poses: Poses) -> Callable[[], np.ndarray]:
    def ask() -> np.ndarray:
        found = []
        for pose in poses:
            peer.place(b, pose)
            found.append(peer.distance(a, b))
        return np.array(found)

    return ask


def summary(rows: list[dict]) -> str:
    """A line a pair: the fastest peer, and how much longer it takes than each way of ours."""
    lines = []
    for name in dict.fromkeys(row["pair"] for row in rows):
        ours = {
            row["method"]: row["us"]
            for row in rows
            if row["pair"] == name and row["library"] == "clearance"
        }
        peers = {
            row["method"]: row["us"]
            for row in rows
            if row["pair"] == name and row["library"] != "clearance"
        }
        if peers:
            best = min(peers, key=peers.get)
            told = ", ".join(
                f"{peers[best] / us:.2f} ({method.split()[-1]})" for method, us in ours.items()
            )
            lines.append(f"{name}: the fastest peer ({best.split(':')[0]}) takes times ours {told}")
    return "\n".join(lines)


def table_of(rows: list[dict]) -> Table:
    """A row a pair, a column a way, in microseconds."""
    methods = list(dict.fromkeys(row["method"] for row in rows))
    table = Table(title="microseconds a question, cold", title_justify="left")
    table.add_column("pair", no_wrap=True)
    for method in methods:
        table.add_column(method, justify="right")
    for name in dict.fromkeys(row["pair"] for row in rows):
        found = {row["method"]: row["us"] for row in rows if row["pair"] == name}
        table.add_row(
            name, *[f"{found[method]:.4g}" if method in found else "" for method in methods]
        )
    return table


if __name__ == "__main__":
    main()
