"""The region that more than one robot of a cell passes through, whatever their timing.

Each case brings its robots, with all that they carry; all are in one world frame. The swept pieces are
convex; pairs of pieces that overlap are found by common points, their unions and what these share by manifold3d.
Not for: whether the robots collide at one time.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from clearance.errors import BadDimension, BadInput, Contradiction
from clearance.extras import require
from clearance.geometry import boolean
from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.convex_parts import solid_of
from clearance.query.common_point import common_point
from clearance.record.workspace import SharedLinks, Workspace
from clearance.simulate.answers.workspace.swept_pieces import SweptPiece, swept_pieces
from clearance.world.body import require_no_shortfall
from clearance.world.case import Case, uncounted_in_sweeps
from clearance.world.robot_in_cell import RobotInCell, robots_in_cell

WITHIN = 0.005
"""[m] Stretches of the sweep, by default: the pieces then stand out of the sweep by about as much."""


def shared_workspace(
    cases: Sequence[Case], *, within: float = WITHIN, cut_concave: bool = False
) -> Workspace:
    """The region that more than one robot of `cases` passes through during its trajectory.

    What a robot has in hand, and what is mounted on it, belongs to it. A robot that stands on another one moves
    with it, whatever its timing; what these two share is not counted.

    Args:
        within: [m] see `swept_pieces`; smaller is tighter and slower.
        cut_concave: links whose hulls meet by their convex parts.

    Raises:
        BadInput: fewer than two robots; an obstacle of one name stands elsewhere in another case (another
            frame); two robots on one spot; no two robots of which neither stands on the other.
        BadDimension: `within` is no length. Unavailable: manifold3d is missing.

    Exactness: an upper bound: the pieces contain the links at every moment, and between the samples.
    """
    if not 0.0 < within < np.inf:
        raise BadDimension(f"within is {within!r} m", valid="a length above 0")
    require("contact", "a shared workspace", "manifold3d")
    robots = robots_in_cell(cases)
    bodies = [body for case in cases for one in case.robots for body in one.robot.bodies]
    bodies += [obstacle.body for case in cases for obstacle in case.obstacles]
    require_no_shortfall(bodies, "a shared workspace")
    _require_one_cell(cases)
    _require_different_places(robots)
    carried = [(a, b) for a in robots for b in robots if a.stands_on(b)]
    pairs = _independent_pairs(robots, carried)
    swept = [swept_pieces(cases[one.i_case], one.timeline, one.i_robot, within) for one in robots]
    meeting, links = _meeting(robots, swept, pairs)
    if cut_concave and links:  # only what meets as hulls
        meet = [{piece.link for piece in pieces} for pieces in meeting]
        swept = [
            swept_pieces(cases[one.i_case], one.timeline, one.i_robot, within, cut)
            for one, cut in zip(robots, meet, strict=True)
        ]
        meeting, links = _meeting(robots, swept, pairs)
    return Workspace(
        robots=tuple(robots),
        region=_shared_region([[solid_of(p.body) for p in rows] for rows in meeting], pairs),
        links=links,
        n_pieces=tuple(len(pieces) for pieces in swept),
        leaves=max((piece.leaves for pieces in swept for piece in pieces), default=0.0),
        within=within,
        excluded=tuple(f"{one.name}/{n}" for one in robots for n in one.placed.exclude_links),
        uncounted=uncounted_in_sweeps(cases),
        carried=tuple((a.name, b.name) for a, b in carried),
    )


def _independent_pairs(
    robots: Sequence[RobotInCell], carried: Sequence[tuple[RobotInCell, RobotInCell]]
) -> list[tuple[int, int]]:
    """The pairs of robots of which neither stands on the other."""
    joined = {(id(a), id(b)) for a, b in carried} | {(id(b), id(a)) for a, b in carried}
    every = combinations(range(len(robots)), 2)
    pairs = [(a, b) for a, b in every if (id(robots[a]), id(robots[b])) not in joined]
    if not pairs:
        raise Contradiction(
            f"each of {', '.join(robot.name for robot in robots)} stands on the other",
            valid="two robots of which neither stands on the other",
        )
    return pairs


def _require_one_cell(cases: Sequence[Case]) -> None:
    """Obstacles of one name stand at one place; else the cases have different world frames.

    Of those that move, nothing is known that must be alike.
    """
    seen: dict[str, tuple[str, np.ndarray]] = {}
    for case in cases:
        for obstacle in (one for one in case.obstacles if one.stands):
            before = seen.setdefault(obstacle.name, (case.name, obstacle.world_from_body))
            off = float(np.abs(before[1] - obstacle.world_from_body).max())
            if off > 1e-6:
                raise BadInput(
                    f"obstacle {obstacle.name!r} stands elsewhere in {case.name!r} than in "
                    f"{before[0]!r} (poses differ by {off:.3g})",
                    valid="cases of one cell, in one world frame",
                )


def _require_different_places(robots: Sequence[RobotInCell]) -> None:
    for a, b in combinations(robots, 2):
        if np.abs(a.poses(0)[0] - b.poses(0)[0]).max() < 1e-6:
            raise BadInput(
                f"robots {a.name!r} and {b.name!r} stand on the same spot",
                valid="give each its own robot.base in one world frame",
            )


def _meeting(
    robots: Sequence[RobotInCell],
    swept: Sequence[list[SweptPiece]],
    pairs: Sequence[tuple[int, int]],
) -> tuple[list[list[SweptPiece]], tuple[SharedLinks, ...]]:
    """Of each robot the pieces that overlap a piece of another, and the pairs of links they are of."""
    names = [robot.name for robot in robots]
    selected: list[set[int]] = [set() for _ in swept]
    links: dict[SharedLinks, None] = {}
    for a, b in pairs:
        for i, j in _boxes_that_meet(swept[a], swept[b]):
            shared = SharedLinks(names[a], swept[a][i].link, names[b], swept[b][j].link)
            if i in selected[a] and j in selected[b] and shared in links:
                continue
            if common_point([swept[a][i].body, swept[b][j].body]).relation == "overlap":
                selected[a].add(i)
                selected[b].add(j)
                links[shared] = None
    chosen = [
        [rows[i] for i in sorted(places)] for rows, places in zip(swept, selected, strict=True)
    ]
    order = {
        (n, p.link): i for n, rows in zip(names, swept, strict=True) for i, p in enumerate(rows)
    }
    ranked = sorted(links, key=lambda s: (order[s.robot_a, s.link_a], order[s.robot_b, s.link_b]))
    return chosen, tuple(ranked)


def _boxes_that_meet(a: list[SweptPiece], b: list[SweptPiece]) -> list[tuple[int, int]]:
    if not a or not b:
        return []
    one, two = np.array([piece.box for piece in a]), np.array([piece.box for piece in b])
    disjoint = (one[:, None, 0] > two[None, :, 1]) | (two[None, :, 0] > one[:, None, 1])
    return [(int(i), int(j)) for i, j in np.argwhere(~disjoint.any(axis=2))]


def _shared_region(solids: Sequence[list[Any]], pairs: Sequence[tuple[int, int]]) -> ClosedMesh:
    """What lies in the unions of both groups of a pair."""
    unions = {i: boolean.union(group) for i, group in enumerate(solids) if group}
    shared = [unions[a] ^ unions[b] for a, b in pairs if a in unions and b in unions]
    return boolean.mesh_of(boolean.union(shared)) if shared else ClosedMesh.empty()
