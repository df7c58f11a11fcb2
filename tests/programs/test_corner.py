"""Corner zones: no admissible path takes a link farther from the nominal motion than is proven.

Kinds are two letters, one a side: L for a line, C for an arc, J for a joint move.
"""

from __future__ import annotations

import numpy as np
import pytest

from clearance.programs.moves import JointMove, Move, PathMove
from clearance.world.cubic import positions_along
from clearance.world.trajectory import Trajectory
from tests.programs.arms import arm, motion, posture, shifted
from tests.programs.exact_arm import Pose, joints_for, links_at, tool_at, turn, vector_of

RADIUS = 0.004


class Cornered:
    """A motion with a corner zone, and the poses where it begins, at the corner, and where it ends."""

    def __init__(self, name: str, kind: str, seed: int) -> None:
        self.arm, self.kind, draw = arm(name), kind, np.random.default_rng(seed)
        start = posture(self.arm, draw)
        self.poses = [self.arm.poses(start[None])[0]]
        self.vias: list[np.ndarray | None] = []
        moves: list[Move] = []
        for i, letter in enumerate(kind):
            way = draw.uniform(-0.1, 0.1, 3) + np.array([-0.05, 0.0, 0.0])
            pose = shifted(self.poses[-1], way, draw.uniform(-0.1, 0.1, 3))
            middle = 0.5 * (pose + self.poses[-1])[:3, 3] + draw.uniform(-0.02, 0.02, 3)
            self.vias.append(middle if letter == "C" else None)
            zone = RADIUS if i == 0 else 0.0
            if letter == "J":
                moves.append(JointMove(f"PTP {i}", "moves", pose=pose, zone=zone))
            else:
                moves.append(PathMove(f"MOVE {i}", "moves", pose, via=self.vias[-1], zone=zone))
            self.poses.append(pose)
        self.trajectory: Trajectory = motion(moves, name, start).trajectory
        (self.zone,) = self.trajectory.corners
        self.nominal = self.joints_at(np.linspace(self.zone.start, self.zone.end, 65))

    def joints_at(self, times: np.ndarray) -> np.ndarray:
        """(n, k) the arm's joints."""
        columns = [self.trajectory.joint_names.index(joint.name) for joint in self.arm.joints]
        return positions_along(self.trajectory, times)[:, columns]

    def piece(self, side: int, share: float) -> Pose:
        """A pose on the line or arc that the zone takes the place of, by its share of that."""
        ends = [
            tool_at(self.arm, self.nominal[0]),
            as_pose(self.poses[1]),
            tool_at(self.arm, self.nominal[-1]),
        ]
        (first, at), (last, to) = ends[side : side + 2]
        turned_by = turn(share * vector_of(last @ first.T)) @ first
        via = self.vias[side]
        if via is None:
            return turned_by, at + share * (to - at)
        centre, axis = circle(self.poses[side][:3, 3], via, self.poses[side + 1][:3, 3])
        a, b = at - centre, to - centre
        angle = np.arccos(a @ b / np.sqrt((a @ a) * (b @ b)))
        return turned_by, centre + turn(share * angle * axis) @ a


def nominal_tool(one: Cornered, i: int) -> np.ndarray:
    return tool_at(one.arm, one.nominal[i])[1]


def as_pose(pose: np.ndarray) -> Pose:
    return pose[:3, :3].astype(np.longdouble), pose[:3, 3].astype(np.longdouble)


def circle(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The centre of the circle through three points, and the axis about which it goes from a by b to c."""
    a, b, c = (one.astype(np.longdouble) for one in (a, b, c))
    axis = np.cross(b - a, c - a)
    axis = axis / np.sqrt(axis @ axis)
    rows = np.array([b - a, c - a, axis], dtype=float)
    middles = np.array([(b - a) @ (a + b) / 2, (c - a) @ (a + c) / 2, axis @ a], dtype=float)
    return np.linalg.solve(rows, middles), axis


def hull(one: Cornered) -> np.ndarray:
    """(m, 3) points of both pieces, their ends among them."""
    return np.array(
        [one.piece(side, share)[1] for side in (0, 1) for share in np.linspace(0.0, 1.0, 9)]
    )


def tool_paths(one: Cornered, draw: np.random.Generator, n: int) -> list[np.ndarray]:
    """Joints on paths of the tool through the hull, with rotations between, from the entry to the exit."""
    points, found = hull(one), []
    entry, corner, exit_ = one.piece(0, 0.0)[0], one.piece(0, 1.0)[0], one.piece(1, 1.0)[0]
    first, second = vector_of(corner @ entry.T), vector_of(exit_ @ corner.T)
    for _ in range(n):
        weights = draw.dirichlet(np.full(len(points), 0.2), size=2) @ points
        knots = np.array([points[0], *weights, points[-1]])
        turns = np.array([[0.0, 0.0], *draw.random((2, 2)), [1.0, 1.0]])
        joints = one.nominal[0]
        for share in np.linspace(0.0, 3.0, 7)[1:]:
            i = min(int(share), 2)
            at, by = (part[i] + (share - i) * (part[i + 1] - part[i]) for part in (knots, turns))
            joints = joints_for(
                one.arm, (turn(by[1] * second) @ turn(by[0] * first) @ entry, at), joints
            )
            found.append(joints)
    return found


def joint_paths(one: Cornered, draw: np.random.Generator, n: int) -> list[np.ndarray]:
    """Joints in the hull of those at entry, corner and exit, and of those along lines and arcs."""
    begins = 1 if one.kind[0] == "J" else 0
    points, joints = [*one.nominal[[0, -1]]], one.nominal[-1 if begins else 0]
    for share in np.linspace(0.0, 1.0, 9):
        joints = joints_for(one.arm, one.piece(begins, 1.0 - share if begins else share), joints)
        points.append(joints)
    return [*(draw.dirichlet(np.full(len(points), 0.2), size=6 * n) @ np.array(points))]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["heron6", "iiwa"])
@pytest.mark.parametrize("kind", ["LL", "LC", "CL", "CC", "JL", "CJ"])
def test_no_admissible_path_takes_a_link_farther_than_is_proven(name, kind):
    one, draw = Cornered(name, kind, 0), np.random.default_rng(1)
    paths = joint_paths if "J" in kind else tool_paths
    nominal = [links_at(one.arm, joints)[0] for joints in one.nominal]
    for joints in paths(one, draw, 5):
        links = links_at(one.arm, joints)[0]
        for link, off in one.zone.links.items():
            turned, at = links[link]
            assert any(
                np.linalg.norm((at - origin).astype(float)) <= off.way
                and np.linalg.norm(vector_of(turned @ rotation.T).astype(float)) <= off.turn + 1e-7
                for rotation, origin in (links_of[link] for links_of in nominal)
            ), link
    assert one.zone.links[one.arm.link].way < 5.0 * RADIUS
    for end in (0, -1):
        way = nominal_tool(one, end) - one.poses[1][:3, 3]
        assert np.sqrt(way @ way) == pytest.approx(RADIUS, rel=1e-3)
