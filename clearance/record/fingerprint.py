"""What decides every row of a run, as one fingerprint: two runs that agree in it give the same bytes."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence

import numpy as np

from clearance.compile.library import processor
from clearance.geometry.polyhedron import Polyhedron
from clearance.package_digest import package_digest
from clearance.world.body import Mount
from clearance.world.case import Case
from clearance.world.kinematics import kinematic_tree_arrays
from clearance.world.motion import Motion
from clearance.world.pairs import Pair
from clearance.world.robot import Robot


def fingerprint(
    case: Case, motions: Sequence[Motion], pairs: Sequence[Pair], options: tuple[object, ...]
) -> str:
    """sha256 of bodies and where they stand, kinematic trees and their motion, limits, options, and the program.

    Args:
        options: what else was asked for; distinguished by their `repr`.
    """
    digest = hashlib.sha256()
    digest.update(_program().encode())
    values = (case.limits, case.allow, case.carries, case.clock, tuple(pairs), options)
    digest.update(repr(values).encode())
    if case.tolerance is not None:
        digest.update(repr(case.tolerance).encode())
    for motion in motions:
        digest.update(robot_digest(motion.placed.robot).encode())
        arrays = (motion.times, motion.positions, motion.tracking_error)
        _add(digest, motion.placed.world_from_base, *arrays)
        _add(digest, np.empty(0) if motion.velocities is None else motion.velocities)
        digest.update(repr(motion.placed.timing).encode())
        asked = motion.placed.trajectory
        off = 0.0 if asked is None else asked.path_error
        digest.update(repr((sorted(motion.placed.padding.items()), off)).encode())
        if asked is not None and asked.corners:
            digest.update(
                repr(
                    [(one.start, one.end, sorted(one.links.items())) for one in asked.corners]
                ).encode()
            )
        _add_mount(digest, motion.placed.mount)
    for obstacle in case.obstacles:
        digest.update(obstacle.name.encode())
        _add_shape(digest, obstacle.body.shape)
        _add(digest, obstacle.world_from_body)
        _add_mount(digest, obstacle.mount)
        digest.update(repr(obstacle.padding).encode())
        if obstacle.moves is not None:
            _add(digest, obstacle.moves.times, obstacle.moves.columns)
            digest.update(repr(obstacle.moves.timing).encode())
    return digest.hexdigest()


def robot_digest(robot: Robot) -> str:
    """sha256 of a robot's joints and of the shapes of its links."""
    digest = hashlib.sha256()
    for body in robot.bodies:
        digest.update(body.name.encode())
        _add_shape(digest, body.shape)
    digest.update(repr((robot.link_names, robot.joints)).encode())
    _add(digest, *kinematic_tree_arrays(robot))
    return digest.hexdigest()


def _add_mount(digest: hashlib._Hash, mount: Mount | None) -> None:
    if mount is not None:
        digest.update(mount.on.encode())
        _add(digest, mount.pose)


def _add_shape(digest: hashlib._Hash, shape: Polyhedron) -> None:
    _add(digest, shape.vertices, shape.face_starts, shape.face_vertices)
    digest.update(repr(shape.shortfall).encode())
    if shape.ball_radius:
        digest.update(repr(shape.ball_radius).encode())


def _add(digest: hashlib._Hash, *arrays: np.ndarray) -> None:
    for array in arrays:
        digest.update(repr((array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).data)


def _program() -> str:
    """Sources, versions and machine: on another processor the last bits may differ."""
    versions = (np.__version__, platform.python_version(), platform.machine())
    return f"{package_digest()} {versions} {processor()}"
