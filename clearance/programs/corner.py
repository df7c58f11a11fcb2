"""How far admissible paths through a corner zone take the links of a robot from its nominal motion, proven.

Admissible is every path of the tool's point in the triangle entry, corner, exit, with any rotation between:

    p = E + a d1 + b d2,   0 <= b <= a <= 1,   R = exp(b' w2) exp(a' w1) R_E,   0 <= a', b' <= 1.

The nominal motion has a = 2u - u^2 and b = u^2. A path's point with a + b = 2u is held against the nominal one at
u, from which it is off by s (d1 - d2), -(u - u^2) <= s <= min(u, 1 - u) - (u - u^2). The ranges of s, a' and b'
are cut into cells until `enclosure` proves a box of joints for the poses of each cell about the nominal cubic,
shifted for it. Where no two joints in the hull of a cell's and its neighbours' boxes hold the same pose, a path
that goes on without a jump is in these boxes everywhere. Not for: what that takes of a clearance
(`world.corner_paddings`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.errors import BadProgram
from clearance.kernels.motion.kinematics import NO_COLUMN, NO_PARENT, SLIDING, Links
from clearance.programs.arm import Arm
from clearance.programs.enclosure import Enclosed, Intervals, Spread, enclosed
from clearance.programs.following import Follower
from clearance.programs.inverse import joints_at
from clearance.programs.path_samples import PathSamples
from clearance.programs.series import half_skew
from clearance.programs.tool_path import Stretch
from clearance.world.corner_zone import CornerZone, Deviation
from clearance.world.kinematics import links_of_robot, poses_by_link
from clearance.world.robot import JointKind, Robot
from clearance.world.tool import rates_of

PATH_ERROR = 1e-6
"""[rad or m] How far a joint may be off its cubic on lines and arcs; a robot of 1 m loses some 6 um of
clearance."""

CELLS = (4, 6, 8, 12)
"""Into how many parts each range is cut, one after another, until boxes are proven."""

MOST_CELLS = 50_000
"""Cells of a zone, over all its intervals: some seconds of work. A zone that needs more is refused."""


def corner_of(
    follower: Follower, samples: PathSamples, start: float, radius: float, name: str
) -> CornerZone:
    """What a corner zone admits, proven.

    Args:
        samples: of the nominal motion through it. start: [s] when it begins. radius: [m]. name: of its move.

    Raises:
        BadInput: nothing is proven: the zone is too wide for the arm so near a singularity.
    """
    for n_cells in CELLS:
        if np.prod(_shape(follower.stretch, samples, n_cells)) > MOST_CELLS:
            break
        found = _cells(follower, samples, n_cells)
        if found is not None:
            ends = start + samples.times[[0, -1]]
            links = _links(follower.arm, *found)
            return CornerZone(name, float(ends[0]), float(ends[1]), radius, links)
    raise BadProgram(
        f"a corner zone of {radius * 1e3:g} mm is too wide to be proven where the arm is",
        where="zone",
        valid="a smaller zone, or another configuration",
    )


@dataclass(frozen=True, eq=False)
class _Grid:
    """The cells of all intervals.

    Attributes:
        shape: (intervals, cells of s, of a', of b'). spread: of each cell, in that order.
    """

    shape: tuple[int, ...]
    spread: Spread


def _cells(
    follower: Follower, samples: PathSamples, n_cells: int
) -> tuple[Enclosed, Spread] | None:
    """The boxes of all cells, if they are proven and joined."""
    arm, stretch = follower.arm, follower.stretch
    grid = _grid(follower, samples, n_cells)
    n_each = int(np.prod(grid.shape[1:]))
    given = Intervals(
        *(np.repeat(part, n_each, axis=0) for part in samples.intervals[:3]),
        *(np.repeat(part, n_each, axis=1) for part in samples.intervals[3:]),
    )
    found = enclosed(arm, stretch, given, follower.free, grid.spread)
    if not np.isfinite(found.box).all():
        return None
    reach = _to_neighbours(grid, found.box)
    return (found, grid.spread) if found.is_unique(arm, reach).all() else None


def _shape(stretch: Stretch, samples: PathSamples, n_cells: int) -> tuple[int, ...]:
    """How many intervals there are, and cells of s, a' and b': one of a turn that is none."""
    turned = np.linalg.norm(stretch.turns, axis=1) > 0.0
    return (len(samples.shares) - 1, n_cells, *np.where(turned, n_cells, 1).tolist())


def _grid(follower: Follower, samples: PathSamples, n_cells: int) -> _Grid:
    """The cells, and the cubics shifted to the joints that hold the pose in the middle of each."""
    stretch = follower.stretch
    sizes = np.linalg.norm(stretch.turns, axis=1)
    shape = _shape(stretch, samples, n_cells)
    counts = shape[1:]
    i, *cell = (axis.ravel() for axis in np.indices(shape))
    given = samples.intervals
    half = 0.5 * given.lengths[:, None]
    middle = given.strokes[0] + half * (given.strokes[1] + 0.5 * given.strokes[2] * half)
    moved = (
        np.abs(given.strokes[1] + given.strokes[2] * half) * half
        + np.abs(given.strokes[2]) * half**2
    )
    at = np.stack([(own + 0.5) / count for own, count in zip(cell, counts, strict=True)], axis=1)
    shifts = np.stack(
        [0.5 * (at[:, 0] - 0.5), at[:, 1] - middle[i, 0], at[:, 2] - middle[i, 1]], axis=1
    )
    halves = np.stack(
        [np.full(len(i), 0.25 / counts[0]), *(0.5 / counts[1 + k] + moved[i, k] for k in range(2))],
        axis=1,
    )
    shifts[:, 1:][:, sizes == 0.0] = 0.0
    halves[:, 1:][:, sizes == 0.0] = 0.0
    near = 0.5 * (given.before + given.after) + 0.25 * half * (given.rates[0] - given.rates[1])
    poses = stretch.poses(
        middle[i] + shifts[:, :1] * np.array([1.0, -1.0]), middle[i] + shifts[:, 1:]
    )
    solved = joints_at(follower.arm.tool, poses, near[i], follower.free)
    return _Grid(shape, Spread(solved.positions - near[i], shifts, halves))


def _to_neighbours(grid: _Grid, box: np.ndarray) -> np.ndarray:
    """(n, k) how far the boxes of a cell's neighbours, and its own, reach from its cubic.

    That of the cell by which the zone is entered reaches to where the joints then are.
    """
    shape = (*grid.shape, box.shape[1])
    joints, own = grid.spread.joints.reshape(shape), box.reshape(shape)
    reach = own.copy()
    for axis in range(4):
        first, second = (
            tuple(slice(*ends) if k == axis else slice(None) for k in range(4))
            for ends in ((None, -1), (1, None))
        )
        between = np.abs(joints[first] - joints[second])
        reach[first] = np.maximum(reach[first], between + own[second])
        reach[second] = np.maximum(reach[second], between + own[first])
    entered = 0, grid.shape[1] // 2, 0, 0
    reach[entered] = np.maximum(reach[entered], np.abs(joints[entered]) + PATH_ERROR)
    return reach.reshape(box.shape)


def _links(arm: Arm, found: Enclosed, spread: Spread) -> dict[str, Deviation]:
    """How far each link that the arm moves may be off the nominal motion, in any cell."""
    robot = arm.robot
    moving = [joint.name for joint in robot.moving_joints]
    columns = [moving.index(joint.name) for joint in arm.joints]
    links, lengths = links_of_robot(robot), _path_lengths(robot)
    at, off = np.zeros((2, len(found.box), len(moving)))
    at[:, columns], off[:, columns] = found.middle - spread.joints, found.middle
    nominal, shifted = poses_by_link(links, at), poses_by_link(links, off)
    told: dict[str, Deviation] = {}
    for i, name in enumerate(robot.link_names):
        above = _Above.of(links, i, columns)
        if not above.driven:
            continue
        carrier = robot.link_names[above.driven[0][0]]
        if above.others == 0:
            told[name] = _off(links, nominal, shifted, above, lengths[name], found, spread)
        elif carrier in told and above.others == above.others_below:
            held, farther = told[carrier], lengths[name] - lengths[carrier]
            told[name] = Deviation(held.at(farther) * MORE, held.turn)
        else:
            turned, slid = above.sums(np.abs(spread.joints) + found.box)
            ways = lengths[name] * turned + slid
            told[name] = Deviation(float(ways.max()) * MORE, float(turned.max()) * MORE)
    return told


class _Above(NamedTuple):
    """The joints between a link and the root.

    Attributes:
        link: whose they are. driven: those that the arm drives, from the link to the root: the link below each and
            its place among the arm's.
        columns, factors, slides: (m,) of those joints: their place among the arm's, and how they follow it.
        others: how many joints are not the arm's, wherever they are. others_below: how many of them are below the
            driven.
    """

    link: int
    driven: tuple[tuple[int, int], ...]
    columns: np.ndarray
    factors: np.ndarray
    slides: np.ndarray
    others: int
    others_below: int

    @classmethod
    def of(cls, links: Links, link: int, columns: list[int]) -> _Above:
        """Those of a link, where an arm drives some columns."""
        driven, others, others_below, above = [], 0, 0, link
        while above != NO_PARENT:
            if int(links.columns[above]) in columns:
                driven.append((above, columns.index(int(links.columns[above]))))
            elif links.columns[above] != NO_COLUMN:
                others += 1
                others_below += not driven
            above = int(links.parents[above])
        own, at = np.array(driven, dtype=np.int64).reshape(-1, 2).T
        slides = links.kinds[own] == SLIDING
        return cls(link, tuple(driven), at, links.factors[own], slides, others, others_below)

    def sums(self, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) [rad] what those that turn, and (n,) [m] what those that slide, move by with the arm's ways (n,
        k)."""
        moved = np.abs(self.factors) * ways[:, self.columns]
        return moved[:, ~self.slides].sum(axis=1), moved[:, self.slides].sum(axis=1)

    def change(
        self, length: float, moved: np.ndarray, ways: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) [m] and [rad] by how much more joints that go by `ways` move the link once joints are `moved` (n,
        k).

        The column of a joint that turns has a way of at most `length` for the link's origin; a turn by a turns it
        by a at most, a slide by d moves it by d. That of a joint that slides has length 1 and turns likewise.

        Args:
            length: [m] of the path from the root to the link.
        """
        (turned, slid), (turns, slides) = self.sums(moved), self.sums(ways)
        return turns * (length * turned + slid) + slides * turned, turns * turned


def _off(
    links: Links,
    nominal: np.ndarray,
    shifted: np.ndarray,
    above: _Above,
    length: float,
    found: Enclosed,
    spread: Spread,
) -> Deviation:
    """How far a link may be off that the arm alone moves.

    At the middle of an interval the shift of a cell moves a link by what both poses differ by; within it by more
    by the change of the Jacobian with the shift, times how far the cubics go; and the box by the Jacobian there.
    """
    box, within, i = found.box, found.variation.within, above.link
    by_shift = above.change(length, np.abs(spread.joints), within)
    by_box = above.change(length, within + box, box)
    rates = rates_of(links, shifted, shifted[:, i, :3, 3], above.driven, box.shape[1])
    rest = (np.abs(rates) @ box[..., None])[..., 0]
    ways = np.linalg.norm(shifted[:, i, :3, 3] - nominal[:, i, :3, 3], axis=1)
    ways += np.linalg.norm(rest[:, :3], axis=1) + by_shift[0] + by_box[0]
    turns = _angles(nominal[:, i, :3, :3], shifted[:, i, :3, :3])
    turns += np.linalg.norm(rest[:, 3:], axis=1) + by_shift[1] + by_box[1]
    return Deviation(float(ways.max()) * MORE, float(turns.max()) * MORE)


def _path_lengths(robot: Robot) -> dict[str, float]:
    """[m] No link's frame is farther from a joint above it than this, by link; slides reach to their limits."""
    path = {robot.link_names[0]: 0.0}
    for joint in robot.joints:
        own = float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        if joint.kind is JointKind.PRISMATIC:
            own += max(abs(joint.lower), abs(joint.upper))
        path[joint.child] = path[joint.parent] + own
    return path


MORE = 1.0 + 1e-6
"""What covers rounding."""


def _angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n,) [rad] between rotations (n, 3, 3)."""
    between = np.swapaxes(a, 1, 2) @ b
    cosines = 0.5 * (np.trace(between, axis1=1, axis2=2) - 1.0)
    return np.arctan2(np.linalg.norm(half_skew(between), axis=1), cosines)
