"""All that moves in a case, as one forest of links: robots, obstacles with a motion of their own, what rides on
them.

Links of robots come first, robot by robot where none stands on a later one; then those of obstacles. Columns are
those of the robots' moving joints, robot by robot, then seven of each obstacle that moves (position and
quaternion). Not for: when a part changes hands (`timeline`); a forest is of a case in which nothing does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from clearance.errors import Contradiction, UnknownLink, at, nearest_name
from clearance.kernels.motion.kinematics import FIXED, NO_COLUMN, NO_PARENT, Links
from clearance.world.body import Mount, Obstacle
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.kinematics import (
    all_links,
    floating_links,
    links_from,
    poses_by_link,
    standing_link,
)
from clearance.world.motion import Motion

WORLD = -1
"""The link of what stands in the world."""


@dataclass(frozen=True, eq=False)
class Forest:
    """The links of a case and where in them its bodies are.

    Attributes:
        links: of all that moves.
        robot_starts: (robots,) the first link of each robot.
        obstacle_links: (obstacles,) the link that an obstacle is fixed to, at the link's own pose, or `WORLD`.
    """

    links: Links
    robot_starts: tuple[int, ...]
    obstacle_links: tuple[int, ...]

    def poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, links, 4, 4) `world_from_link` [m] with the columns at `positions` (n, columns) [rad or m]."""
        return poses_by_link(self.links, positions)

    def link_called(self, case: Case, name: str) -> int:
        """The link of an obstacle or of a robot's link by its name as in tables, or `WORLD` for what stands."""
        for i, obstacle in enumerate(case.obstacles):
            if obstacle.name == name:
                return self.obstacle_links[i]
        i_robot, link = links_by_name(case)[name]
        return self.robot_starts[i_robot] + link

    def rigid_part(self, link: int) -> int:
        """The topmost link that `link` is joined to by fixed joints, or `WORLD` if that stands in the world."""
        while self.links.parents[link] != NO_PARENT and self.links.kinds[link] == FIXED:
            link = int(self.links.parents[link])
        return WORLD if self.links.parents[link] == NO_PARENT else link


@once_a_cell(16)
def forest_of(case: Case) -> Forest:
    """The forest of a case in which nothing changes hands.

    Raises:
        UnknownLink: a mount on what is not there. BadInput: actors that stand on each other in a ring.
    """
    return _Planter(case).forest()


def joined_positions(
    case: Case, motions: Sequence[Motion], steps: slice | np.ndarray
) -> np.ndarray:
    """(k, columns) the positions of all columns of the case's forest at some steps; a copy."""
    moving = [o.moves.columns[steps] for o in case.obstacles if o.moves is not None]
    if len(motions) == 1 and not moving:
        return np.array(motions[0].positions[steps], dtype=np.float64, order="C")
    return np.concatenate([*(motion.positions[steps] for motion in motions), *moving], axis=1)


def link_poses_at(case: Case, motions: Sequence[Motion], steps: slice | np.ndarray) -> np.ndarray:
    """(k, links, 4, 4) `world_from_link` [m] of the case's forest at some steps."""
    return forest_of(case).poses(joined_positions(case, motions, steps))


def positions_between(case: Case, motions: Sequence[Motion], step: int, share: float) -> np.ndarray:
    """(columns,) the positions of all columns when a share (0 to 1) of the interval after a step has passed."""
    moving = [o.moves.after(step, share) for o in case.obstacles if o.moves is not None]
    return np.concatenate([*(motion.positions_after(step, share) for motion in motions), *moving])


def positions_along(
    case: Case, motions: Sequence[Motion], step: int, shares: np.ndarray
) -> np.ndarray:
    """(k, columns) the same for several shares (k,)."""
    moving = [o.moves.after(step, shares[:, None]) for o in case.obstacles if o.moves is not None]
    own = [
        np.array([motion.positions_after(step, share) for share in shares]) for motion in motions
    ]
    return np.concatenate([*own, *moving], axis=1)


def resolved_mount(case: Case, mount: Mount) -> Mount:
    """A mount that names what it is on by what moves that: a link, or an obstacle with a motion of its own.

    A body on an obstacle that rides on something is on that thing. On an obstacle that stands the name stays.

    Raises:
        UnknownLink: nothing is called so. BadInput: obstacles that ride on each other in a ring.
    """
    obstacles = {obstacle.name: obstacle for obstacle in case.obstacles}
    seen = [mount.on]
    while mount.on in obstacles and obstacles[mount.on].mount and not obstacles[mount.on].moves:
        below = obstacles[mount.on].mount
        assert below is not None
        if below.on in seen:
            raise Contradiction(
                f"{' on '.join([*seen, below.on])}: a ring",
                valid="something that stands in the world",
            )
        seen.append(below.on)
        mount = Mount(below.on, below.pose @ mount.pose)
    require_known(case, mount.on)
    return mount


def require_known(case: Case, name: str) -> None:
    """Nothing, if something that can carry is called so.

    Raises:
        UnknownLink: with the nearest name.
    """
    known = [*(obstacle.name for obstacle in case.obstacles), *links_by_name(case)]
    if name not in known:
        raise UnknownLink(f"nothing is called {name!r}", valid=nearest_name(name, known))


def owner_of(case: Case, mount: Mount) -> tuple[bool, int]:
    """What a mount is on in the end: an obstacle (True, i) or a robot (False, i).

    Raises:
        UnknownLink, BadInput: as `resolved_mount`.
    """
    on = resolved_mount(case, mount).on
    for i, obstacle in enumerate(case.obstacles):
        if obstacle.name == on:
            return True, i
    return False, links_by_name(case)[on][0]


def links_by_name(case: Case) -> dict[str, tuple[int, int]]:
    """Robot and link by `robot/link`, and by the link alone where there is one robot."""
    names = {
        f"{placed.robot.name}/{link}": (i, k)
        for i, placed in enumerate(case.robots)
        for k, link in enumerate(placed.robot.link_names)
    }
    if len(case.robots) == 1:
        names |= {link: (0, k) for k, link in enumerate(case.robots[0].robot.link_names)}
    return names


class _Planter:
    """Lays the trees of a case behind one another, what carries before what is carried."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.names = links_by_name(case)
        self.obstacles = {obstacle.name: i for i, obstacle in enumerate(case.obstacles)}
        self.parts: list[Links] = []
        self.n_links = 0
        self.robot_starts: dict[int, int] = {}
        self.obstacle_links = dict.fromkeys(range(len(case.obstacles)), WORLD)
        self.under_way: list[str] = []
        widths = [len(placed.robot.moving_joints) for placed in case.robots]
        self.robot_columns = np.cumsum([0, *widths]).tolist()
        moving = [i for i, obstacle in enumerate(case.obstacles) if obstacle.moves is not None]
        self.obstacle_columns = {i: self.robot_columns[-1] + 7 * k for k, i in enumerate(moving)}

    def forest(self) -> Forest:
        for i_robot in range(len(self.case.robots)):
            self._plant_robot(i_robot)
        for i_obstacle in self.obstacle_columns:
            self._plant_moving(i_obstacle)
        for i_obstacle, obstacle in enumerate(self.case.obstacles):
            if obstacle.mount is not None and obstacle.moves is None:
                with at(f"obstacle {obstacle.name!r}: on"):
                    self._plant_riding(i_obstacle, obstacle)
        return Forest(
            all_links(*self.parts),
            tuple(self.robot_starts[i] for i in range(len(self.case.robots))),
            tuple(self.obstacle_links[i] for i in range(len(self.case.obstacles))),
        )

    def _plant_robot(self, i_robot: int) -> None:
        if i_robot in self.robot_starts:
            return
        placed = self.case.robots[i_robot]
        with at(f"robot {placed.robot.name!r}: base.on"), self._without_ring(placed.robot.name):
            parent, pose = self._stands_on(placed.mount)
        base = placed.world_from_base if placed.mount is None else pose
        links = links_from(base, placed.robot)
        self.robot_starts[i_robot] = self.n_links
        first, column = self.n_links, self.robot_columns[i_robot]
        inside = links.parents != NO_PARENT
        self._add(
            links._replace(
                parents=np.where(inside, links.parents + first, parent),
                columns=np.where(links.columns == NO_COLUMN, NO_COLUMN, links.columns + column),
            )
        )

    def _plant_moving(self, i_obstacle: int) -> None:
        if self.obstacle_links[i_obstacle] != WORLD:
            return
        obstacle = self.case.obstacles[i_obstacle]
        with at(f"obstacle {obstacle.name!r}: on"), self._without_ring(obstacle.name):
            parent, pose = self._stands_on(obstacle.mount)
        if parent == NO_PARENT:
            parent = self.n_links
            self._add(standing_link(pose))
            pose = np.eye(4)
        self._add(floating_links(self.n_links, self.obstacle_columns[i_obstacle], parent, pose))
        self.obstacle_links[i_obstacle] = self.n_links - 1

    def _plant_riding(self, i_obstacle: int, obstacle: Obstacle) -> None:
        parent, pose = self._stands_on(obstacle.mount)
        self._add(standing_link(pose)._replace(parents=np.array([parent])))
        self.obstacle_links[i_obstacle] = self.n_links - 1

    def _stands_on(self, mount: Mount | None) -> tuple[int, np.ndarray]:
        """The link below, or `NO_PARENT`, and the pose on it."""
        if mount is None:
            return NO_PARENT, np.eye(4)
        mount = resolved_mount(self.case, mount)
        if mount.on in self.obstacles:
            i_obstacle = self.obstacles[mount.on]
            obstacle = self.case.obstacles[i_obstacle]
            if obstacle.moves is None:
                return NO_PARENT, obstacle.world_from_body @ mount.pose
            self._plant_moving(i_obstacle)
            return self.obstacle_links[i_obstacle], mount.pose
        i_robot, link = self.names[mount.on]
        self._plant_robot(i_robot)
        return self.robot_starts[i_robot] + link, mount.pose

    @contextmanager
    def _without_ring(self, name: str) -> Iterator[None]:
        """Refuses a ring of bodies where what a body stands on is planted inside."""
        if name in self.under_way:
            ring = [*self.under_way[self.under_way.index(name) :], name]
            raise Contradiction(
                f"{' on '.join(ring)}: a ring", valid="something that stands in the world"
            )
        self.under_way.append(name)
        try:
            yield
        finally:
            self.under_way.remove(name)

    def _add(self, links: Links) -> None:
        self.parts.append(links)
        self.n_links += len(links.parents)


def carried_by(forest: Forest, link: int) -> Iterator[int]:
    """A link and all above it, nearest first; none for `WORLD`."""
    while link != NO_PARENT:
        yield link
        link = int(forest.links.parents[link])
