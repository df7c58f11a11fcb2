"""Forward kinematics: joint positions to the poses of all links. Not for: what the positions should be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from clearance.errors import UnknownJoint, nearest_name
from clearance.kernels.motion.kinematics import (
    BALL,
    FIXED,
    NO_COLUMN,
    NO_PARENT,
    SLIDING,
    TURNING,
    Links,
    place_each,
)
from clearance.ordered import parents_first
from clearance.world.mimics import followers
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind, Robot

_KERNEL_KIND = {
    JointKind.FIXED: FIXED,
    JointKind.REVOLUTE: TURNING,
    JointKind.CONTINUOUS: TURNING,
    JointKind.PRISMATIC: SLIDING,
}


def link_poses(placed: PlacedRobot, positions: np.ndarray) -> np.ndarray:
    """The pose of every link at every step.

    Args:
        positions: (n, k) [rad] or [m], columns as `placed.robot.moving_joints`.

    Returns:
        (n, n_links, 4, 4) `world_from_link` [m], links as in `Robot.link_names`.
    """
    return poses_by_link(links_from(placed.world_from_base, placed.robot), positions)


@lru_cache(maxsize=8)  # asked for again for every part of a motion
def kinematic_tree_arrays(robot: Robot) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Parents, kinds, parent_from_joint and axes of all links."""
    n_links = len(robot.link_names)
    index = {name: i for i, name in enumerate(robot.link_names)}
    parents = np.zeros(n_links, dtype=np.int64)
    kinds = np.zeros(n_links, dtype=np.int64)
    fixed_parts = np.tile(np.eye(4), (n_links, 1, 1))
    axes = np.zeros((n_links, 3))
    for joint in robot.joints:
        i = index[joint.child]
        parents[i], kinds[i] = index[joint.parent], _KERNEL_KIND[joint.kind]
        fixed_parts[i], axes[i] = joint.parent_from_joint, joint.axis
    return parents, kinds, fixed_parts, axes


def seen_from(
    links: Links, wanted: Sequence[tuple[int, int]]
) -> tuple[Links, dict[tuple[int, int], int]]:
    """The links and, behind them, links as they are seen from others above them.

    The observing link stands at the origin there, so that only the joints between move the other one.

    Args:
        wanted: (the observing link, the observed link) each.

    Returns:
        all links, and the place of each that is wanted.
    """
    origins: list[int] = []  # the index of each added link
    parents: list[int] = []
    places: dict[tuple[int, int], int] = {}
    for reference, link in wanted:
        path = [link]
        while path[-1] != reference:
            path.append(int(links.parents[path[-1]]))
        for here in reversed(path):
            if (reference, here) not in places:
                above = (
                    NO_PARENT if here == reference else places[reference, int(links.parents[here])]
                )
                places[reference, here] = len(links.parents) + len(origins)
                origins.append(here)
                parents.append(above)
    if not origins:
        return links, places
    added = Links(*(column[origins] for column in links))
    roots = np.array(parents) == NO_PARENT
    fixed = added.parent_from_joint.copy()
    fixed[roots] = np.eye(4)
    kinds, columns = np.where(roots, FIXED, added.kinds), np.where(roots, NO_COLUMN, added.columns)
    added = added._replace(
        parents=np.array(parents), parent_from_joint=fixed, kinds=kinds, columns=columns
    )
    return all_links(links, added), places


def all_links(*forests: Links) -> Links:
    """The links of several forests behind one another, whose parents and columns count over all of them."""
    links = Links(*(np.concatenate(arrays) for arrays in zip(*forests, strict=True)))
    parents_first(links.parents)
    return links


def standing_link(world_from_link: np.ndarray) -> Links:
    """One link that stands at a pose (4, 4) [m]: a root for others to hang on."""
    return Links(
        np.array([NO_PARENT]), np.array([FIXED]), np.zeros((1, 3)), world_from_link[None].astype(float),
        np.array([NO_COLUMN]), np.ones(1), np.zeros(1),
    )  # fmt: skip


def floating_links(
    first: int, columns_from: int, parent: int, parent_from_base: np.ndarray
) -> Links:
    """Four links that carry a body anywhere, seen from a base: three slides, and a ball joint that carries it.

    They follow seven columns of the positions, x, y, z [m] and the quaternion x, y, z, w. To be put behind other
    links by `all_links`; the body hangs on the last.

    Args:
        first: the place of the first of them among all links. columns_from: that of the first column.
        parent: the link that they hang on; a root that stands can be had by `standing_link`.
        parent_from_base: (4, 4) [m].
    """
    fixed = np.tile(np.eye(4), (4, 1, 1))
    fixed[0] = parent_from_base
    return Links(
        np.array([parent, first, first + 1, first + 2]), np.array([SLIDING, SLIDING, SLIDING, BALL]),
        np.eye(4)[:, :3].copy(), fixed, columns_from + np.arange(4), np.ones(4), np.zeros(4),
    )  # fmt: skip


def poses_by_link(links: Links, positions: np.ndarray) -> np.ndarray:
    """(n, links, 4, 4) `world_from_link` [m] of all links, of positions (n, columns)."""
    poses = np.empty((len(positions), len(links.parents), 4, 4))
    place_each(links, np.ascontiguousarray(positions, dtype=np.float64), poses)
    return poses


def links_alone(links: Links, wanted: np.ndarray) -> tuple[Links, np.ndarray]:
    """Some links (k,) and what they hang on, without all others, and the place (k,) of each among these."""
    is_above = np.zeros(len(links.parents), dtype=bool)
    here = wanted
    while len(here):
        is_above[here] = True
        here = links.parents[here]
        here = here[here != NO_PARENT]
    above = np.flatnonzero(is_above)
    places = np.full(len(is_above) + 1, NO_PARENT)  # the last stands for `NO_PARENT`
    places[above] = np.arange(len(above))
    alone = Links(*(column[above] for column in links))
    return alone._replace(parents=places[alone.parents]), places[wanted]


@lru_cache(maxsize=8)
def links_of_robot(robot: Robot) -> Links:
    """The links of one robot, standing at the origin."""
    parents, kinds, fixed_parts, axes = kinematic_tree_arrays(robot)
    parents = parents.copy()
    parents[0] = NO_PARENT
    columns = np.full(len(parents), NO_COLUMN)
    factors, offsets = np.ones(len(parents)), np.zeros(len(parents))
    index = {name: i for i, name in enumerate(robot.link_names)}
    column_of = {joint.name: i for i, joint in enumerate(robot.moving_joints)}
    for joint, master, factor, offset in followers(robot):
        link = index[joint.child]
        columns[link], factors[link], offsets[link] = column_of[master], factor, offset
    return Links(parents, kinds, axes, fixed_parts, columns, factors, offsets)


def links_from(base: np.ndarray, robot: Robot) -> Links:
    """The links of one robot whose root stands at a pose (4, 4) [m]."""
    links = links_of_robot(robot)
    fixed = links.parent_from_joint.copy()
    fixed[0] = base
    return links._replace(parent_from_joint=fixed)


def moving_positions(
    placed: PlacedRobot, joint_names: tuple[str, ...], given: np.ndarray
) -> np.ndarray:
    """(n, k) positions of all moving joints from the (n, len(joint_names)) that are given by name.

    Joints that are not named take their value in `placed.fixed_positions`, else 0.

    Raises:
        UnknownJoint: a name that is not a moving joint of the robot.
    """
    columns = {joint.name: i for i, joint in enumerate(placed.robot.moving_joints)}
    if tuple(columns) == tuple(joint_names) and not placed.fixed_positions:
        return np.ascontiguousarray(given, dtype=np.float64)
    positions = np.zeros((len(given), len(columns)))
    for name, value in placed.fixed_positions.items():
        positions[:, _column(columns, name)] = value
    for i_given, name in enumerate(joint_names):
        positions[:, _column(columns, name)] = given[:, i_given]
    return positions


def moving_velocities(
    placed: PlacedRobot, joint_names: tuple[str, ...], given: np.ndarray
) -> np.ndarray:
    """(n, k) velocities of all moving joints from those given by name; joints that are not named rest."""
    return moving_positions(replace(placed, fixed_positions={}), joint_names, given)


def values_by_link(links: Links, positions: np.ndarray) -> np.ndarray:
    """(n, links) the position of the joint above each link, of (n, columns); 0 of roots, fixed and ball joints."""
    return rates_by_link(links, positions) + np.where(_follows(links), links.offsets, 0.0)


def rates_by_link(links: Links, rates: np.ndarray) -> np.ndarray:
    """(n, links) the same of velocities (n, columns), of which offsets are no part."""
    moving = np.where(_follows(links), links.factors, 0.0)
    if rates.shape[1] == 0:
        return np.zeros((len(rates), len(moving)))
    return rates[:, np.maximum(links.columns, 0)] * moving


def _follows(links: Links) -> np.ndarray:
    """(links,) True where the position of the joint above is one number, made of a column."""
    return (links.columns != NO_COLUMN) & (links.kinds != BALL)


def _column(columns: dict[str, int], name: str) -> int:
    if name not in columns:
        raise UnknownJoint(f"unknown joint {name!r}", valid=nearest_name(name, columns))
    return columns[name]
