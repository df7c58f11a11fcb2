"""Prints what one question about two bodies costs that were never asked about before: ours and the peers'.

    python scripts/bench/single_pairs.py [--pairs NAME ...] [--poses N] [--csv FILE] [--seconds S]

Trees are built beforehand; poses are random and far from one another, so that nothing can be carried over.
Ours is asked by `cl.distance`, by `cl.Query.distance` and by `cl.Query.distances` for all poses at once; the
peers place one body and ask. Microseconds of CPU a question, median over interleaved passes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import Row, interleaved, tell
from inputs import Solid, solid
from peers import Coal, Fcl, Klampt, PairPeer, absent_peers, available, silenced, versions

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from scripts.makers.hostile_cases import at, ball, torus
from scripts.makers.polygon_pairs import rotations

LIBRARIES = ("fcl", "coal", "klampt")

Poses = np.ndarray
"""(n, 4, 4) `world_from_b` [m]; a stands."""


def anywhere(random: np.random.Generator, n: int) -> Poses:
    """Balls of radius 1 at gaps of 1 mm to 1 m, turned at random."""
    away = random.normal(size=(n, 3))
    reach = 2.0 + 10.0 ** random.uniform(-3, 0, (n, 1))
    away *= reach / np.linalg.norm(away, axis=1, keepdims=True)
    return np.array([at(*x, turned=r) for x, r in zip(away, rotations(random, n), strict=True)])


def crossed(random: np.random.Generator, n: int) -> Poses:
    """Pipes of radius 0.1 along z, over each other at gaps of 1 mm to 1 m and any angle above 15 degrees."""
    made = []
    for _ in range(n):
        angle, roll = random.uniform(0.26, np.pi - 0.26), random.uniform(0, 2 * np.pi)
        gap = 10.0 ** random.uniform(-3, 0)
        beside = at(0.2 + gap, 0, random.uniform(-0.5, 0.5))
        made.append(about_z(roll) @ beside @ about_x(angle) @ about_z(roll))
    return np.array(made)


def linked(random: np.random.Generator, n: int) -> Poses:
    """A ring through the hole of another, moved and turned a little, and by any angle about its own axis."""
    made = []
    for _ in range(n):
        moved = at(1.0 + random.uniform(-0.1, 0.1), *random.uniform(-0.1, 0.1, 2))
        turned = about_x(np.pi / 2 + random.uniform(-0.2, 0.2))
        made.append(moved @ turned @ about_z(random.uniform(0, 6.28)))
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


PAIRS: dict[str, tuple[Callable[[], Polyhedron], Callable[[np.random.Generator, int], Poses]]] = {
    "spheres 320": (lambda: ball(1.0, 2), anywhere),
    "spheres 5k": (lambda: ball(1.0, 4), anywhere),
    "spheres 82k": (lambda: ball(1.0, 6), anywhere),
    "crossed pipes 256": (lambda: pipe(256), crossed),
    "crossed pipes 1024": (lambda: pipe(1024), crossed),
    "crossed pipes 4096": (lambda: pipe(4096), crossed),
    "linked tori 1k": (lambda: torus(1.0, 0.25, 32, 16), linked),
    "linked tori 16k": (lambda: torus(1.0, 0.25, 128, 64), linked),
}

SMALLEST = [
    "--pairs",
    "spheres 320",
    "linked tori 1k",
    "--poses",
    "4",
    "--seconds",
    "0.01",
    "--passes",
    "1",
]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, pairs=[*PAIRS], poses=40, passes=5, seconds=0.5)
    tell(*absent_peers(LIBRARIES))
    rows: list[Row] = []
    for name in asked.pairs:
        found = rows_of(name, asked)
        harness.show(f"{name}: microseconds a question, cold", found)
        rows += found
        peers = [row for row in found if row["library"] != "clearance"]
        if peers:
            best = min(peers, key=lambda row: row["us"])
            ours = [f"{best['us'] / r['us']:.2f} ({r['method']})" for r in found if r not in peers]
            tell(f"the fastest peer ({best['library']}) takes times ours {', '.join(ours)}")
    harness.write_csv(rows, asked.csv)
    tell(versions(LIBRARIES))
    return rows


def rows_of(name: str, asked: argparse.Namespace) -> list[Row]:
    """One row a way to ask; ours first."""
    make, place = PAIRS[name]
    poses = place(np.random.default_rng(23), asked.poses)
    a, b = solid(Body("a", make())), solid(Body("b", make()), stands=True)
    ways = ways_of(a, b, poses)
    timings = interleaved(list(ways.values()), asked.passes, asked.seconds)
    ours, each = timings[0], 1e6 / len(poses)
    return [
        {
            "pair": name, "library": method.split(":")[0], "method": method,
            "triangles": len(a.soup.triangles), "us": timing.median * each, "us_least": timing.least * each,
            "ratio_to_ours": timing.median / ours.median,
            "greatest_difference_m": float(np.abs(np.maximum(timing.answer, 0.0) - ours.answer).max()),
        }
        for method, timing in zip(ways, timings, strict=True)
    ]  # fmt: skip


def ways_of(a: Solid, b: Solid, poses: Poses) -> dict[str, Callable[[], np.ndarray]]:
    """Ways to ask for the distances at all poses, by name."""
    rest, query = np.eye(4), cl.Query(a.shape, b.shape)
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


def _asking(peer: PairPeer, a: object, b: object, poses: Poses) -> Callable[[], np.ndarray]:
    def ask() -> np.ndarray:
        found = []
        for pose in poses:
            peer.place(b, pose)
            found.append(peer.distance(a, b))
        return np.array(found)

    return ask


if __name__ == "__main__":
    main()
