"""The region that more than one robot of a cell passes through, whatever their timing.

Each case brings its robots; all stand in one world frame. The links' swept pieces are convex; pairs of pieces
that overlap are found by common points, their unions and what these share by manifold3d. Not for: whether the
robots collide at one time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from clearance.errors import BadDimension, BadInput, Unavailable
from clearance.extras import install
from clearance.geometry import boolean
from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.convex_parts import solid_of
from clearance.query.common_point import common_point
from clearance.simulate.swept_pieces import SweptPiece, swept_pieces
from clearance.world.case import Case, PlacedRobot
from clearance.world.motion import Motion, kinematic_motion

WITHIN = 0.005
"""[m] Stretches of the sweep, by default: the pieces then stand out of the sweep by about as much."""


@dataclass(frozen=True)
class SharedLinks:
    """Two links of different robots with swept pieces in common."""

    robot_a: str
    link_a: str
    robot_b: str
    link_b: str


@dataclass(frozen=True, eq=False)
class Workspace:
    """What robots share.

    Attributes:
        robots: a name for each. region: the surface of what more than one passes through, world frame.
        volume: [m^3] of the region: an upper bound. links: which links meet there.
        n_pieces: convex pieces of each robot's sweep. leaves: [m] the most a piece was made wider by.
        motions: the robots' motions. excluded: links that were left out, `robot/link`.
    """

    robots: tuple[str, ...]
    region: ClosedMesh
    links: tuple[SharedLinks, ...]
    n_pieces: tuple[int, ...]
    leaves: float
    within: float
    motions: tuple[Motion, ...]
    excluded: tuple[str, ...]

    @property
    def volume(self) -> float:
        """[m^3] an upper bound."""
        return self.region.volume


def shared_workspace(
    cases: Sequence[Case], *, within: float = WITHIN, cut_concave: bool = False
) -> Workspace:
    """The region that more than one robot of `cases` passes through during its trajectory.

    Args:
        within: [m] see `swept_pieces`; smaller is tighter and slower.
        cut_concave: links whose hulls meet by their convex parts.

    Raises:
        BadInput: fewer than two robots; an obstacle of one name stands elsewhere in another case (another
            frame); two robots on one spot. BadDimension: `within` is no length. Unavailable: manifold3d is
            missing.

    Exactness: an upper bound: the pieces hold the links at every moment, and between the samples.
    """
    if not 0.0 < within < np.inf:
        raise BadDimension(f"within is {within!r} m", valid="a length above 0")
    if not boolean.available():
        raise Unavailable("manifold3d is not installed", valid=install("contact"))
    named = _named_robots(cases)
    _require_one_cell(cases)
    _require_different_places(named)
    motions = tuple(kinematic_motion(placed) for _, placed in named)
    names = [name for name, _ in named]
    swept = [swept_pieces(motion, within) for motion in motions]
    meeting, links = _meeting(names, swept)
    if cut_concave and links:  # only what meets as hulls
        meet = [{piece.link for piece in pieces} for pieces in meeting]
        swept = [swept_pieces(m, within, cut) for m, cut in zip(motions, meet, strict=True)]
        meeting, links = _meeting(names, swept)
    return Workspace(
        robots=tuple(name for name, _ in named),
        region=_shared_region([[solid_of(piece.body) for piece in rows] for rows in meeting]),
        links=links,
        n_pieces=tuple(len(pieces) for pieces in swept),
        leaves=max((piece.leaves for pieces in swept for piece in pieces), default=0.0),
        within=within,
        motions=motions,
        excluded=tuple(f"{name}/{link}" for name, one in named for link in one.exclude_links),
    )


def _named_robots(cases: Sequence[Case]) -> list[tuple[str, PlacedRobot]]:
    """All robots, each with a name of its own: the robot's, with its case's where that is not enough."""
    found = [(case.name, placed) for case in cases for placed in case.robots]
    if len(found) < 2:
        raise BadInput(
            f"{len(found)} robot is given", valid="cases with two or more robots in all are needed"
        )
    names = [placed.robot.name for _, placed in found]
    full = [
        name if names.count(name) == 1 else f"{case}/{name}"
        for (case, _), name in zip(found, names, strict=True)
    ]
    told = [
        name if full.count(name) == 1 else f"{name}#{full[: i + 1].count(name)}"
        for i, name in enumerate(full)
    ]
    return [(name, placed) for name, (_, placed) in zip(told, found, strict=True)]


def _require_one_cell(cases: Sequence[Case]) -> None:
    """Obstacles of one name stand at one place; else the cases have different world frames."""
    seen: dict[str, tuple[str, np.ndarray]] = {}
    for case in cases:
        for obstacle in case.obstacles:
            before = seen.setdefault(obstacle.name, (case.name, obstacle.world_from_body))
            off = float(np.abs(before[1] - obstacle.world_from_body).max())
            if off > 1e-6:
                raise BadInput(
                    f"obstacle {obstacle.name!r} stands elsewhere in {case.name!r} than in "
                    f"{before[0]!r} (poses differ by {off:.3g})",
                    valid="cases of one cell, in one world frame",
                )


def _require_different_places(named: Sequence[tuple[str, PlacedRobot]]) -> None:
    for (name_a, a), (name_b, b) in combinations(named, 2):
        if np.abs(a.world_from_base - b.world_from_base).max() < 1e-6:
            raise BadInput(
                f"robots {name_a!r} and {name_b!r} stand on the same spot",
                valid="give each its own robot.base in one world frame",
            )


def _meeting(
    names: Sequence[str], swept: Sequence[list[SweptPiece]]
) -> tuple[list[list[SweptPiece]], tuple[SharedLinks, ...]]:
    """Of each robot the pieces that overlap a piece of another, and the pairs of links they are of."""
    kept: list[set[int]] = [set() for _ in swept]
    links: dict[SharedLinks, None] = {}
    for a, b in combinations(range(len(swept)), 2):
        for i, j in _boxes_that_meet(swept[a], swept[b]):
            shared = SharedLinks(names[a], swept[a][i].link, names[b], swept[b][j].link)
            if i in kept[a] and j in kept[b] and shared in links:
                continue
            if common_point([swept[a][i].body, swept[b][j].body]).relation == "overlap":
                kept[a].add(i)
                kept[b].add(j)
                links[shared] = None
    chosen = [[rows[i] for i in sorted(keep)] for rows, keep in zip(swept, kept, strict=True)]
    order = {
        (n, p.link): i for n, rows in zip(names, swept, strict=True) for i, p in enumerate(rows)
    }
    ranked = sorted(links, key=lambda s: (order[s.robot_a, s.link_a], order[s.robot_b, s.link_b]))
    return chosen, tuple(ranked)


def _boxes_that_meet(a: list[SweptPiece], b: list[SweptPiece]) -> list[tuple[int, int]]:
    if not a or not b:
        return []
    one, two = np.array([piece.box for piece in a]), np.array([piece.box for piece in b])
    apart = (one[:, None, 0] > two[None, :, 1]) | (two[None, :, 0] > one[:, None, 1])
    return [(int(i), int(j)) for i, j in np.argwhere(~apart.any(axis=2))]


def _shared_region(solids: Sequence[list[Any]]) -> ClosedMesh:
    """What lies in the unions of two or more of the groups."""
    unions = [boolean.union(group) for group in solids if group]
    shared = [a ^ b for a, b in combinations(unions, 2)]
    return boolean.mesh_of(boolean.union(shared)) if shared else ClosedMesh.empty()
