"""What run time against error is measured on, with the truth: polygon pairs, body pairs, whole steps.

Truth of the first two is rational arithmetic (tests/oracle); of steps the shared cases' references, where
the nearest obstacle is the very mesh that is measured. Seeds are fixed; made outside the clock.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from inputs import Scene, Solid, scenes, solid

import clearance as cl
from clearance.crosscheck.triangles import TriangleSoup
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from tests import oracle
from tests.made_cases import faces_of
from tests.strategies import FAMILIES, rotations


@dataclass(frozen=True, eq=False)
class Question:
    """Two bodies where they stand, and how far apart they are.

    Attributes:
        size: [m] the greatest extent of the two; errors are told in parts of it.
        true_sq: [m^2] exact.
    """

    family: str
    a: Solid
    b: Solid
    pose_a: np.ndarray
    pose_b: np.ndarray
    size: float
    true_sq: object

    @property
    def truth(self) -> float:
        """[m]"""
        return float(oracle.root(self.true_sq))

    def error(self, answer: float) -> float:
        """|answer - truth| in parts of the size, from 50 digits; below 0 is contact."""
        return float(oracle.error(max(0.0, float(answer)), self.true_sq)) / self.size


def polygon_questions(n: int) -> list[Question]:
    """`n` pairs of each family of tests/strategies.py, families in turn."""
    by_family = [
        [
            _polygon_question(name, p, q)
            for p, q in zip(*family(np.random.default_rng(5), n), strict=True)
        ]
        for name, family in FAMILIES.items()
    ]
    return [question for row in zip(*by_family, strict=True) for question in row]


def _polygon_question(family: str, p: np.ndarray, q: np.ndarray) -> Question:
    p, q = _from_least_corner(p), _from_least_corner(q)
    size = max(np.ptp(p, axis=0).max(), np.ptp(q, axis=0).max())
    true_sq = oracle.polygon_distance_sq(p, q)
    return Question(
        family, fan("p", p), fan("q", q, True), np.eye(4), np.eye(4), float(size), true_sq
    )


def _from_least_corner(polygon: np.ndarray) -> np.ndarray:
    """The polygon read so that all take the same fan of triangles, where rounding has bent it."""
    doubled = [tuple(x) for x in polygon.tolist()] * 2
    n = len(polygon)
    return np.roll(polygon, -min(range(n), key=lambda i: doubled[i : i + n]), axis=0)


def fan(name: str, corners: np.ndarray, stands: bool = False) -> Solid:
    """A polygon as the peers take it; `shape` is missing, since ours takes the corners."""
    k = np.arange(1, len(corners) - 1)
    triangles = np.stack([np.zeros_like(k), k, k + 1], axis=1)
    open_soup = TriangleSoup(
        np.ascontiguousarray(corners), triangles, np.zeros(len(triangles)), np.empty((0, 3, 3))
    )
    return Solid(name, None, open_soup, None, stands)


def body_questions(n: int) -> list[Question]:
    """`n` poses of each family of bodies: gaps from 1 um to 0.3 m, every fourth in contact."""
    random = np.random.default_rng(17)
    families: dict[str, Callable[[], tuple[Polyhedron, Polyhedron]]] = {
        "boxes": lambda: (_box(random), _box(random)),
        "pipes": lambda: (_pipe(random), _pipe(random)),
        "box and pipe": lambda: (_box(random), _pipe(random)),
    }
    iiwa, panda = _links("iiwa_pipe_rack"), _links("panda_shelf")
    families["iiwa link and pipe"] = lambda: (iiwa[random.integers(3, 7)], _pipe(random))
    families["panda links"] = lambda: (panda[random.integers(0, 10)], panda[random.integers(0, 10)])
    asked = []
    for i in range(n):
        for name, draw in families.items():
            a, b = (
                solid(Body(part, shape), part == "b")
                for part, shape in zip("ab", draw(), strict=True)
            )
            asked.append(_body_question(random, name, a, b, touching=i % 4 == 3))
    asked.append(_body_question_at("rod in a bore", _rod(0.05), _bore(0.08), _lifted(0.01)))
    asked.append(_body_question_at("box in a box", _cube(0.2), _cube(1.0), _lifted(0.1)))
    return asked


def _body_question(
    random: np.random.Generator, family: str, a: Solid, b: Solid, touching: bool
) -> Question:
    """b at a random attitude, moved towards a until the wanted gap is left, or 2 mm into it."""
    pose = np.eye(4)
    pose[:3, :3] = rotations(random, 1)[0]
    toward = random.normal(size=3)
    toward /= np.linalg.norm(toward)
    wanted = 0.0 if touching else 10.0 ** random.uniform(-6.0, -0.5)
    reach = (
        2.0 * (a.shape.bounds.ptp() if hasattr(a.shape.bounds, "ptp") else np.ptp(a.shape.bounds))
        + 2.0
    )
    for _ in range(200):
        pose[:3, 3] = reach * toward
        gap = cl.distance(a.shape, b.shape, pose_b=pose).distance
        if gap <= wanted * (1 + 1e-3) + 1e-9 or reach <= 0.0:
            break
        reach -= gap - wanted
    pose[:3, 3] = (reach - 0.002 * touching) * toward
    return _body_question_at(family, a, b, pose)


def _body_question_at(family: str, a: Solid, b: Solid, pose: np.ndarray) -> Question:
    true_sq = oracle.solid_distance_sq(
        a.shape.vertices, faces_of(a.shape), b.shape.vertices, faces_of(b.shape), None, pose,
        _has_inside(a.shape), _has_inside(b.shape),
    )  # fmt: skip
    size = max(np.ptp(s.shape.bounds, axis=0).max() for s in (a, b))
    return Question(family, a, b, np.eye(4), pose, float(size), true_sq)


def _has_inside(shape: Polyhedron) -> bool:
    return shape.closed and shape.oriented


def _box(random: np.random.Generator) -> Polyhedron:
    return cl.box(tuple(10.0 ** random.uniform(-2.0, 0.0, 3)))


def _pipe(random: np.random.Generator) -> Polyhedron:
    outer = random.uniform(0.02, 0.15)
    return cl.pipe(inner_radius=0.8 * outer, outer_radius=outer, length=random.uniform(0.3, 1.5))


def _links(scene: str) -> list[Polyhedron]:
    return [link.shape for link in next(scenes([scene])).links]


def _rod(radius: float) -> Solid:
    return solid(Body("rod", cl.cylinder(radius, 3.0)))


def _bore(radius: float) -> Solid:
    return solid(
        Body("bore", cl.pipe(inner_radius=radius, outer_radius=2 * radius, length=1.0)), True
    )


def _cube(width: float) -> Solid:
    return solid(Body("cube", cl.box((width, width, width))), width == 1.0)


def _lifted(x: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def step_sample(scene: Scene, n: int) -> np.ndarray:
    """At most `n` steps, evenly spread over those whose reference is exact."""
    exact = np.flatnonzero(scene.reference[1])
    return exact[np.unique(np.linspace(0, len(exact) - 1, n).round().astype(int))]


def step_scenes(names: list[str] | None) -> list[Scene]:
    """The shared cases among `names`."""
    return [scene for scene in scenes(names) if scene.reference is not None]
