"""Corner zones held against random paths that they admit: no place on any is nearer than is proven.

The guide says what is admitted: between lines every point of the triangle, beside arcs of its hull with them, with
any rotation between those of its corners; beside a joint move all joints in the triangle of theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from harness import Row
from program_arms import LONG, ArmFile, OwnArm, Poses, arm_files, turned
from program_paths import TOOL, ZONE, OwnLeg, Pose, drawn, drawn_arc, end_of

import clearance as cl
from clearance.programs.motion import motion_of
from clearance.programs.moves import JointMove, Move, PathMove, Program
from clearance.world.cubic import positions_along
from clearance.world.trajectory import Trajectory

POINTS = 8
"""Places at which a random path is looked at."""


@dataclass(frozen=True, eq=False)
class Corner:
    """A motion with one corner zone.

    Attributes:
        legs: before and after it; the first is None for a joint move. joints: (k,) at the corner.
    """

    file: ArmFile
    own: OwnArm
    made: Trajectory
    legs: tuple[OwnLeg | None, OwnLeg]
    joints: np.ndarray

    def nominal(self, n: int) -> np.ndarray:
        """(n, k) the joints of the nominal motion through it."""
        (zone,) = self.made.corners
        return positions_along(self.made, np.linspace(zone.start, zone.end, n))

    def admissible(self, n_paths: int, draw: np.random.Generator) -> np.ndarray:
        """(n, k) the joints at places of random paths."""
        n = n_paths * POINTS
        if self.legs[0] is None:
            ends = self.nominal(2)
            return draw.dirichlet([0.5] * 3, n) @ np.array([ends[0], self.joints, ends[1]])
        (zone,) = self.made.corners
        before, after = self.legs
        into, out = zone.radius / before.length, _share_at(after, zone.radius)
        first, middle = before.poses(np.array([1 - into])), after.poses(np.zeros(1))
        last = after.poses(np.array([out]))
        between = after.poses(out * draw.random(n)).origin
        weights = draw.dirichlet([0.5] * 4, n).astype(LONG)[:, :, None]
        corners = (first.origin, middle.origin, last.origin, between)
        origin = sum(weights[:, i] * one for i, one in enumerate(corners))
        turns = (out * after.turns[0], into * before.turns[0])
        second, one = (turned(draw.random((n, 1)) * turn) for turn in turns)
        wanted = Poses((second @ one @ first.turn[0])[:, None], origin[:, None])
        return self.own.solved(wanted, self._near(origin)[:, None])[:, 0].astype(float)

    def _near(self, origins: np.ndarray) -> np.ndarray:
        """(n, k) the joints of the nominal motion where the tool is nearest to places (n, 3)."""
        nominal = self.nominal(100)
        _, at = self.own.poses(nominal.astype(LONG))
        ways = np.linalg.norm(origins[:, None].astype(float) - at[None].astype(float), axis=2)
        return nominal[np.argmin(ways, axis=1)]


def _share_at(leg: OwnLeg, radius: float) -> float:
    """The share of a line or an arc after which its point is so far [m] from where it begins."""
    if leg.circle is None:
        return radius / leg.length
    _, to_start, _, angle = leg.circle
    size = float(np.sqrt((to_start**2).sum()))
    return 2.0 * float(np.arcsin(radius / (2.0 * size))) / angle


Drawn = tuple[tuple[OwnLeg | None, OwnLeg], tuple[Move, ...], np.ndarray]


def lines(own: OwnArm, start: np.ndarray, draw: np.random.Generator) -> Drawn:
    """Two lines."""
    (first, second), moves = drawn("zone", _pose(own, start), draw)
    return (first, second), moves, start


def line_and_arc(own: OwnArm, start: np.ndarray, draw: np.random.Generator) -> Drawn:
    """A line, and an arc after it."""
    (first,), (move,) = drawn("lin", _pose(own, start), draw)
    (second,), (arc,) = drawn_arc(end_of(first), draw.uniform(-0.3, 0.3, 3).astype(LONG), draw)
    assert isinstance(move, PathMove)
    return (first, second), (replace(move, zone=ZONE), arc), start


def joints_and_line(own: OwnArm, start: np.ndarray, draw: np.random.Generator) -> Drawn:
    """A joint move, and a line after it."""
    corner = start + draw.uniform(-0.2, 0.2, len(start))
    (second,), (move,) = drawn("lin", _pose(own, corner), draw)
    names = (joint.name for joint in own.joints)
    joints = dict(zip(names, map(float, corner), strict=True))
    return (None, second), (JointMove("PTP", "moves[0]", joints, zone=ZONE), move), corner


def _pose(own: OwnArm, joints: np.ndarray) -> Pose:
    turn, origin = own.poses(joints[None].astype(LONG))
    return turn[0], origin[0]


KINDS: dict[str, Callable[[OwnArm, np.ndarray, np.random.Generator], Drawn]] = {
    "lin lin": lines,
    "lin circ": line_and_arc,
    "ptp lin": joints_and_line,
}


def random_corners(kind: str, file: ArmFile, draw: np.random.Generator) -> Iterator[Corner]:
    """Motions of a kind that the arm can follow."""
    robot, own = cl.load_robot(file.path), OwnArm.read(file.path, file.link, TOOL)
    names = [joint.name for joint in own.joints]
    while True:
        start = np.array(file.posture)[: len(names)] + draw.uniform(-0.2, 0.2, len(names))
        legs, moves, corner = KINDS[kind](own, start, draw)
        joints = dict(zip(names, map(float, start), strict=True))
        try:
            made = motion_of(robot, Program(file.link, TOOL, moves, joints)).trajectory
        except cl.ClearanceError:
            continue
        if len(made.corners) == 1:
            columns = [made.joint_names.index(name) for name in names]
            yield Corner(file, own, made.of_columns(columns), legs, corner)


def zones(asked) -> Iterator[Row]:
    """Of each arm and kind a corner zone near three boxes: the least clearance proven, and that of paths."""
    for name, file in arm_files(asked.arms).items():
        for kind in KINDS:
            draw = np.random.default_rng(1)
            corners = random_corners(kind, file, draw)
            case, proven, corner = next(
                one for one in _among_boxes(corners, draw) if one[1] > 0.005
            )
            asks = cl.Checker(case)
            found = asks.distances(corner.admissible(asked.paths, draw)).distances
            yield {
                "arm": name, "kind": kind, "paths": asked.paths, "nearer": int((found < proven).sum()),
                "nominal_mm": 1e3 * asks.distances(corner.nominal(200)).distances.min(),
                "found_mm": 1e3 * found.min(), "proven_mm": 1e3 * proven,
            }  # fmt: skip


def _among_boxes(
    corners: Iterator[Corner], draw: np.random.Generator
) -> Iterator[tuple[cl.Case, float, Corner]]:
    """Motions among three boxes about the corner, 0.15 m from it, and what is proven in the zone [m]."""
    for corner in corners:
        middle = corner.own.poses(corner.nominal(3).astype(LONG))[1][1].astype(float)
        boxes = []
        for i in range(3):
            away, pose = draw.normal(size=3), np.eye(4)
            pose[:3, 3] = middle + 0.15 * away / np.linalg.norm(away)
            boxes.append(cl.Obstacle(cl.Body(f"box {i}", cl.box([0.06, 0.06, 0.06])), pose))
        placed = cl.PlacedRobot(cl.load_robot(corner.file.path), trajectory=corner.made)
        case = cl.Case("zone", (placed,), tuple(boxes))
        yield case, _proven_in_zone(case), corner


def _proven_in_zone(case: cl.Case) -> float:
    """[m] The least clearance that is proven while the corner zone is passed."""
    (zone,) = case.robots[0].trajectory.corners
    record = cl.check(case, contact="none", accept=["limits", "units"]).record
    times, bounds = record.motions[0].times, record.certificate.lower_bound
    within = (times >= zone.start - 1e-12) & (times < zone.end - 1e-12)
    return float(bounds[within[: len(bounds)]].min())
