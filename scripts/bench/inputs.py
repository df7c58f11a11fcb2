"""What the benchmarks run on: whole cases with their motion worked out, and single bodies.

Everything here is made outside the clock, with fixed seeds. Not for: measuring (`peers`, `loops`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from harness import SCENES, SHARED  # first: it sets the number of threads before numpy is loaded
from moving_cases import MOVING, absent_robots

import numpy as np  # isort: skip

from clearance import load_case
from clearance.crosscheck.triangles import TriangleSoup, triangle_soup
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.forest import WORLD, link_poses_at
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import Pair, measured_pairs
from scripts.makers import hostile_cases

MADE: dict[str, Callable[[], Case]] = {
    "arm_among_obstacles": lambda: hostile_cases.arm_among_obstacles(32, 300),
    "teleporting": lambda: hostile_cases.teleporting(32, 60),
    "linked_tori": lambda: hostile_cases.linked_tori(16, 40),
    "linked_tori_16k": lambda: hostile_cases.linked_tori(64, 10),
    "nested_shells": lambda: hostile_cases.nested_shells(4, 10),
    "everything_equidistant": lambda: hostile_cases.everything_equidistant(24, 20),
    "facing_plates": lambda: hostile_cases.facing_plates(24, 20),
}
"""The field's scene (seven links among 20 obstacles, 2048 triangles each), and those in which nothing is cut."""


class Round(NamedTuple):
    """A sphere, or a cylinder along z of a length above 0, about a centre (3,) in the body frame [m]."""

    radius: float
    length: float
    centre: np.ndarray


@dataclass(frozen=True, eq=False)
class Solid:
    """A body as we take it and as the peers take it.

    Attributes:
        round_shape: what it is before it is faceted, so that a peer may use its own; None for all others.
        stands: where it is at every step; of a pair of bodies the second.
    """

    name: str
    shape: Polyhedron
    soup: TriangleSoup
    round_shape: Round | None = None
    stands: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """A case in which nothing changes hands, ready to be measured.

    Attributes:
        bodies: those that occur in a pair. poses: (steps, bodies, 4, 4) `world_from_body` [m].
        index: (p, 2) the bodies of each measured pair.
        reference: (steps,) [m] clearances made elsewhere, and (steps,) True where they are exact for
            the meshes that are measured; None where the case brings none.
    """

    name: str
    case: Case
    motions: tuple[Motion, ...]
    pairs: list[Pair]
    bodies: list[Solid]
    poses: np.ndarray
    index: np.ndarray
    reference: tuple[np.ndarray, np.ndarray] | None

    @property
    def n_steps(self) -> int:
        """Number of steps."""
        return len(self.poses)

    @property
    def n_triangles(self) -> int:
        """Triangles of all bodies that are measured."""
        return sum(len(body.soup.triangles) for body in self.bodies)

    @property
    def moving(self) -> list[int]:
        """The bodies that move."""
        return [i for i, body in enumerate(self.bodies) if not body.stands]

    @property
    def standing(self) -> list[int]:
        """Those that do not."""
        return [i for i, body in enumerate(self.bodies) if body.stands]


def solid(body: Body, stands: bool = False) -> Solid:
    """A body with its triangles."""
    return Solid(body.name, body.shape, triangle_soup(body.shape), round_shape(body), stands)


def round_shape(body: Body) -> Round | None:
    """What a faceted round body was: all facets touch it, so their planes give its radius back.

    A cylinder that is turned in its link is None; its peers get the facets.
    """
    if body.origin not in ("sphere", "cylinder"):
        return None
    low, high = body.shape.bounds
    centre, normals = 0.5 * (low + high), body.shape.normals
    heights = (normals * (body.shape.centres - centre)).sum(axis=1)
    if body.origin == "sphere":
        return Round(float(heights.min()), 0.0, centre)
    sides = np.abs(normals[:, 2]) < 0.5
    if sides.sum() != len(sides) - 2:
        return None
    return Round(float(heights[sides].min()), float(high[2] - low[2]), centre)


def case_files() -> list[Path]:
    """The shared cases, if they are there, and our scenes of one robot among standing things."""
    ours = (path.with_name("case.yaml") for path in SCENES.glob("*/trajectory.csv"))
    return sorted(SHARED.glob("*/case.yaml")) + sorted(ours)


def absent_inputs() -> list[str]:
    """What cannot be run, one line each."""
    if sorted(SHARED.glob("*/case.yaml")):
        return absent_robots()
    return [f"skipped: no shared cases in {SHARED.name}/ beside the repository", *absent_robots()]


def scenes(names: Sequence[str] = ()) -> Iterator[Scene]:
    """The cases of some names, made ones too; every case file where none is named."""
    for path in case_files():
        if not names or path.parent.name in names:
            yield scene_of(path)
    yield from (scene_from(name, make()) for name, make in made().items() if name in names)


def made() -> dict[str, Callable[[], Case]]:
    """The cases that are made in memory; those of real robots where these are installed."""
    return MADE | ({} if absent_robots() else MOVING)


def scene_of(path: Path) -> Scene:
    """A case file loaded, its motion followed, its bodies triangulated."""
    case = load_case(path)
    return scene_from(path.parent.name, case, _reference(case, path.with_name("reference.csv")))


def scene_from(
    name: str, case: Case, reference: tuple[np.ndarray, np.ndarray] | None = None
) -> Scene:
    """A case with its motion followed and its bodies triangulated."""
    motions = tuple(kinematic_motion(placed) for placed in case.robots)
    pairs, _ = measured_pairs(case)
    bodies = sorted({body for pair in pairs for body in pair})
    links = link_poses_at(case, motions, slice(None))
    return Scene(
        name=name,
        case=case,
        motions=motions,
        pairs=pairs,
        bodies=[solid(one.body_in(case), one.frame_in(case) == WORLD) for one in bodies],
        poses=np.stack([one.poses_in(case, links) for one in bodies], axis=1),
        index=np.array([(bodies.index(pair.a), bodies.index(pair.b)) for pair in pairs]),
        reference=reference,
    )


def _reference(case: Case, path: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """The reference takes cylinders and spheres as they are; what is measured is faceted."""
    if not path.exists():
        return None
    rows = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    round_ones = {o.name for o in case.obstacles if o.body.shape.excess > 0.0}
    return rows["clearance"], np.array([name not in round_ones for name in rows["obstacle"]])
