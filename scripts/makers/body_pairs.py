"""Pairs of bodies by seed, as a benchmark asks about them: boxes, pipes, links of real arms, a rod in a bore.

How far apart they stand is worked out elsewhere, since it takes a distance: each pair has an attitude, a way to
come nearer, and the gap that is wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.pairs import measured_pairs
from scripts.makers.hostile_cases import at
from scripts.makers.polygon_pairs import rotations

SCENES = Path(__file__).parents[2] / "scenes"


class BodyPair(NamedTuple):
    """Two bodies.

    Attributes:
        turned: (3, 3) of b. toward: (3,) of length 1, from a to b.
        gap: [m] wanted; below 0 where they are to overlap. None: b stands at `toward`, as it is.
    """

    family: str
    a: Polyhedron
    b: Polyhedron
    turned: np.ndarray
    toward: np.ndarray
    gap: float | None


def body_pairs(n: int) -> Iterator[BodyPair]:
    """`n` pairs of each family: gaps from 1 um to 0.3 m, every fourth in contact; then two inside another."""
    random = np.random.default_rng(17)
    families: dict[str, Callable[[], tuple[Polyhedron, Polyhedron]]] = {
        "boxes": lambda: (_box(random), _box(random)),
        "pipes": lambda: (_pipe(random), _pipe(random)),
        "box and pipe": lambda: (_box(random), _pipe(random)),
    }
    iiwa, panda = _links("iiwa_pipe_rack"), _links("panda_shelf")
    families["iiwa link and pipe"] = lambda: (iiwa[random.integers(3, 7)], _pipe(random))
    families["panda links"] = lambda: (panda[random.integers(0, 10)], panda[random.integers(0, 10)])
    for i in range(n):
        for name, draw in families.items():
            a, b = draw()
            turned = rotations(random, 1)[0]
            toward = random.normal(size=3)
            gap = -0.002 if i % 4 == 3 else 10.0 ** random.uniform(-6.0, -0.5)
            yield BodyPair(name, a, b, turned, toward / np.linalg.norm(toward), gap)
    bore = cl.pipe(inner_radius=0.08, outer_radius=0.16, length=1.0)
    still = np.eye(3)
    yield BodyPair("rod in a bore", cl.cylinder(0.05, 3.0), bore, still, 0.01 * still[0], None)
    small, large = (cl.box((width, width, width)) for width in (0.2, 1.0))
    yield BodyPair("box in a box", small, large, still, 0.1 * still[0], None)


def placed(pair: BodyPair) -> np.ndarray:
    """(4, 4) `world_from_b` [m]: b comes nearer to a until the gap is left, or is as far into it."""
    if pair.gap is None:
        return at(*pair.toward)
    wanted, reach = max(0.0, pair.gap), 2.0 * float(np.ptp(pair.a.bounds)) + 2.0
    for _ in range(200):
        pose = at(*(reach * pair.toward), turned=pair.turned)
        gap = cl.distance(pair.a, pair.b, pose_b=pose).distance
        if gap <= wanted * (1 + 1e-3) + 1e-9 or reach <= 0.0:
            break
        reach -= gap - wanted
    return at(*((reach + min(0.0, pair.gap)) * pair.toward), turned=pair.turned)


def _box(random: np.random.Generator) -> Polyhedron:
    return cl.box(tuple(10.0 ** random.uniform(-2.0, 0.0, 3)))


def _pipe(random: np.random.Generator) -> Polyhedron:
    outer = random.uniform(0.02, 0.15)
    return cl.pipe(inner_radius=0.8 * outer, outer_radius=outer, length=random.uniform(0.3, 1.5))


def _links(scene: str) -> list[Polyhedron]:
    """The links of a scene's robot that are measured."""
    case = cl.load_case(SCENES / scene / "case.yaml")
    bodies = sorted({pair.a.i_body for pair in measured_pairs(case)[0]})
    return [case.robots[0].robot.bodies[i].shape for i in bodies]
