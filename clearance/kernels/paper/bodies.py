"""The first paper's loop over all face pairs of two bodies with its two rejection rules (section
4).

Each rule is a function of its own, can be switched off, and counts what it cut. Neither keeps the
minimum for certain: rule 1 by the user's tolerance, rule 2 because it looks at face centres only.

Source: as `paper.polygons`, section 4, steps 1 to 9.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    dot,
    gap_sq,
    move,
    relative,
    rigid,
    row,
    sub,
    turn,
)
from clearance.kernels.paper.polygons import Polygon, nearest_by_paper

PASSES_SHOWN = 5
"""Bins of the histogram of passes: 1, 2, 3, 4, and 5 or more."""


class PaperBody(NamedTuple):
    """Faces one after the other: `corners[starts[i]:starts[i + 1]]`, with normals, centres and
    radii [m]."""

    corners: Floats2
    starts: Integers
    normals: Floats2
    centres: Floats2
    radii: Floats


class PaperDistance(NamedTuple):
    """The least distance over all measured pairs, in the frame of body a, and what was counted.

    `gap_sq` is infinite and the faces are -1 where no pair was measured. `passes` holds 1, 2, 3,
    4, 5+ and last the pairs given up.
    """

    gap_sq: float
    p: Vec3
    q: Vec3
    face_a: int
    face_b: int
    cut_by_rule_1: int
    cut_by_rule_2: int
    measured: int
    passes: Integers


@inline
def far_apart(centre_a, centre_b, reach, tolerance):
    """Rule 1 (step 6): the distance of the centres less both radii is not below the tolerance."""
    return math.sqrt(gap_sq(centre_a, centre_b)) - reach >= tolerance


@inline
def turned_away(normal_a, normal_b, centre_a, centre_b):
    """Rule 2 (steps 2 and 5): the normals do not oppose, or a face's centre is not before the
    other's.

    Reading: a product of exactly zero rejects the pair; the steps name only + and -, the prose
    before them demands - and +.
    """
    v = sub(centre_b, centre_a)
    opposed = dot(normal_a, normal_b) < 0.0
    return not (opposed and dot(normal_a, v) > 0.0 and dot(normal_b, v) < 0.0)


@inline
def moved_points(motion, points):
    """The (n, 3) points after a rigid motion."""
    result = np.empty_like(points)
    for i in range(len(points)):
        x = move(motion, row(points, i))
        result[i, 0], result[i, 1], result[i, 2] = x.x, x.y, x.z
    return result


@inline
def face_polygon(body, i, normal, centre):
    """Face `i` as a polygon."""
    return Polygon(body.corners, body.starts[i], body.starts[i + 1], normal, centre)


@kernel
def nearest_bodies_paper(
    a: PaperBody,
    b_own: PaperBody,
    world_from_a: Floats2,
    world_from_b: Floats2,
    tolerance: float,
    rule_1: bool,
    rule_2: bool,
) -> PaperDistance:
    """Steps 1 to 8 for two bodies at two (4, 4) poses; computed in the frame of `a`.

    Rule 2 comes first, as in the steps. Ties: the least face of a, then of b.
    """
    a_from_b = relative(rigid(world_from_a), rigid(world_from_b))
    b = PaperBody(
        moved_points(a_from_b, b_own.corners),
        b_own.starts,
        b_own.normals,
        moved_points(a_from_b, b_own.centres),
        b_own.radii,
    )
    normals_b = np.empty_like(b.normals)
    for j in range(len(b.radii)):
        n = turn(a_from_b, row(b.normals, j))
        normals_b[j, 0], normals_b[j, 1], normals_b[j, 2] = n.x, n.y, n.z
    nothing = Vec3(math.nan, math.nan, math.nan)
    best, best_p, best_q, face_a, face_b = math.inf, nothing, nothing, -1, -1
    cut_1, cut_2, measured = 0, 0, 0
    passes = np.zeros(PASSES_SHOWN + 1, np.int64)
    for i in range(len(a.radii)):
        normal_a, centre_a = row(a.normals, i), row(a.centres, i)
        one = face_polygon(a, i, normal_a, centre_a)
        for j in range(len(b.radii)):
            normal_b, centre_b = row(normals_b, j), row(b.centres, j)
            if rule_2 and turned_away(normal_a, normal_b, centre_a, centre_b):
                cut_2 += 1
                continue
            if rule_1 and far_apart(centre_a, centre_b, a.radii[i] + b.radii[j], tolerance):
                cut_1 += 1
                continue
            measured += 1
            found = nearest_by_paper(one, face_polygon(b, j, normal_b, centre_b))
            shown = min(found.passes, PASSES_SHOWN) - 1 if found.converged else PASSES_SHOWN
            passes[shown] += 1
            found_sq = gap_sq(found.p, found.q)
            if found_sq < best:
                best, best_p, best_q, face_a, face_b = found_sq, found.p, found.q, i, j
    return PaperDistance(best, best_p, best_q, face_a, face_b, cut_1, cut_2, measured, passes)
