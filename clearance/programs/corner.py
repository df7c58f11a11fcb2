"""How far admissible paths through a corner zone take the links of a robot from its nominal motion, proven.

Between lines, admissible is every path of the tool's point in the triangle entry, corner, exit, with any rotation
between:

    p = E + f1(a) + f2(b),   0 <= b <= a <= 1,   R = exp(b' w2) exp(a' w1) R_E,   0 <= a', b' <= 1,   f(s) = d s.

Joints that are told where to go are at q_E + a h1 + b h2, as far between as the point.
The nominal motion has a = 2u - u^2 and b = u^2. A path's point with a + b = 2u is held against the nominal one at
u, at strokes off by s and -s, -(u - u^2) <= s <= min(u, 1 - u) - (u - u^2). Where a side is an arc, f is the arc,
and admissible are all points of the convex hull of entry, corner, exit and arcs: p with a ball about it
(`_hull`). The ranges of s, a' and b'
are cut into cells until `enclosure` proves a box of joints for the poses of each cell about the nominal cubic,
shifted for it. Where no two joints in the hull of a cell's and its neighbours' boxes hold the same pose, a path
that goes on without a jump is in these boxes everywhere. Not for: what that takes of a clearance
(`world.corner_paddings`).
"""

from __future__ import annotations

import numpy as np

from clearance.programs.enclosure import (
    Enclosed,
    Intervals,
    Spread,
    cubic_series,
    enclosed,
    stroke_series,
)
from clearance.programs.following import Follower
from clearance.programs.inverse import joints_at
from clearance.programs.links_off import Cells, links_off
from clearance.programs.path_samples import PathSamples
from clearance.programs.tool_path import Stretch
from clearance.world.trajectory import CornerZone

PATH_ERROR = 1e-6
"""[rad or m] How far a joint may be off its cubic on lines and arcs; a robot of 1 m loses some 6 um of
clearance."""

CELLS = (4, 6, 8, 12, 16, 20)
"""Into how many parts each range is cut, one after another, until boxes are proven."""

MOST_CELLS = 50_000
"""Cells of a zone, over all its intervals: some seconds of work. A zone that needs more is not proven."""


def corner_of(
    follower: Follower, samples: PathSamples, start: float, radius: float, name: str
) -> CornerZone | None:
    """What a corner zone admits, proven; None where it is too wide for the arm so near a singularity.

    Args:
        samples: of the nominal motion through it. start: [s] when it begins. radius: [m]. name: of its move.
    """
    shapes = [_shape(follower.stretch, samples, n_cells) for n_cells in CELLS]
    shapes = [shape for shape in shapes if np.prod(shape) <= MOST_CELLS]
    if not shapes or not np.isfinite(_enclosed(follower, samples, shapes[-1], 3)[1].box).all():
        return None
    for shape in shapes:
        spread, proven = _enclosed(follower, samples, shape)
        if not np.isfinite(proven.box).all():
            continue
        reach = _to_neighbours(shape, spread, proven.box)
        if proven.is_unique(follower.arm, reach).all():
            ends = start + samples.times[[0, -1]]
            cells = Cells(proven.middle, spread.joints, proven.variation.within, proven.box)
            links = links_off(follower.arm, cells)
            return CornerZone(name, float(ends[0]), float(ends[1]), radius, links)
    return None


Shape = tuple[int, ...]
"""How many intervals there are, and cells of s, of a' and of b'."""


def _enclosed(
    follower: Follower, samples: PathSamples, shape: Shape, most: int | None = None
) -> tuple[Spread, Enclosed]:
    """The poses of all cells, in the order of the shape, and what is proven of joints for them.

    Args:
        most: of the cells across, so many along each range: the outer ones and those in the middle.
    """
    ranges = [np.arange(shape[0])]
    for count in shape[1:]:
        ranges.append(np.unique(np.linspace(0, count - 1, most or count).astype(int)))
    i, *cell = (axis.ravel() for axis in np.meshgrid(*ranges, indexing="ij"))
    given = samples.intervals
    spread = _spread(follower, given, shape, i, np.stack(cell, axis=1))
    return spread, enclosed(follower.arm, follower.stretch, given.rows(i), follower.free, spread)


def _shape(stretch: Stretch, samples: PathSamples, n_cells: int) -> Shape:
    """One cell of a turn that is none."""
    turned = np.linalg.norm(stretch.turns, axis=1) > 0.0
    return (len(samples.shares) - 1, n_cells, *np.where(turned, n_cells, 1).tolist())


def _spread(
    follower: Follower, given: Intervals, shape: Shape, i: np.ndarray, cell: np.ndarray
) -> Spread:
    """Cells (n, 3) of intervals (n,), and the cubics shifted to the joints that hold the pose in the middle of
    each."""
    stretch, counts = follower.stretch, np.array(shape[1:])
    sizes = np.linalg.norm(stretch.turns, axis=1)
    half = 0.5 * given.lengths[:, None]
    strokes = stroke_series(given, half)
    middle, moved = strokes[0], np.abs(strokes[1]) + 2.0 * np.abs(strokes[2])
    shifts, halves = (cell + 0.5) / counts, np.tile(0.5 / counts, (len(i), 1))
    shifts[:, 0], halves[:, 0] = 0.5 * (shifts[:, 0] - 0.5), 0.5 * halves[:, 0]
    shifts[:, 1:] -= middle[i]
    halves[:, 1:] += moved[i]
    shifts[:, 1:][:, sizes == 0.0] = 0.0
    halves[:, 1:][:, sizes == 0.0] = 0.0
    near = cubic_series(given, half)[0]
    change = follower.joints_on_path.held[0] - follower.joints_on_path.held[1]
    start = near[i] + np.where(follower.free, 0.0, shifts[:, :1] * change)
    poses = stretch.poses(
        middle[i] + shifts[:, :1] * np.array([1.0, -1.0]), middle[i] + shifts[:, 1:]
    )
    if given.carried is not None:
        poses = given.carried.poses[i] @ poses
    solved = joints_at(follower.arm.tool, poses, start, follower.free)
    off = np.where(follower.free, 0.0, halves[:, :1] * np.abs(change))
    return Spread(solved.positions - near[i], off, shifts, halves, _hull(stretch))


def _hull(stretch: Stretch) -> float:
    """[m] No point of the convex hull of the entry, the corner, the exit and the arcs is farther from some p.

    An arc is off its chord by an eighth of its bend at most, hence the hull off the flat triangle, and the
    triangle off the p.
    """
    sags = [0.125 * way.bend for way in stretch.ways]
    return sum(sags) + max(sags)


def _to_neighbours(within: Shape, spread: Spread, box: np.ndarray) -> np.ndarray:
    """(n, k) how far the boxes of a cell's neighbours, and its own, reach from its cubic.

    That of the cell by which the zone is entered reaches to where the joints then are.
    """
    shape = (*within, box.shape[1])
    joints, own = spread.joints.reshape(shape), box.reshape(shape)
    reach = own.copy()
    for axis in range(4):
        first, second = (
            tuple(slice(*ends) if k == axis else slice(None) for k in range(4))
            for ends in ((None, -1), (1, None))
        )
        between = np.abs(joints[first] - joints[second])
        reach[first] = np.maximum(reach[first], between + own[second])
        reach[second] = np.maximum(reach[second], between + own[first])
    entered = 0, within[1] // 2, 0, 0
    reach[entered] = np.maximum(reach[entered], np.abs(joints[entered]) + PATH_ERROR)
    return reach.reshape(box.shape)
