"""A robot file to a robot, by the reader of its suffix: a further format is a file and a row here.

Not for: where the robot stands, or how it moves (`robots`).
"""

from __future__ import annotations

from collections.abc import Callable

from clearance.load.mesh_store import MeshStore
from clearance.load.robot_request import RobotRequest
from clearance.load.urdf import read_urdf
from clearance.world.robot import Robot

READERS: dict[str, Callable[[RobotRequest, MeshStore], Robot]] = {
    ".urdf": read_urdf,
}
"""By suffix in small letters; a file of another suffix is read as URDF."""


def read_robot(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a file.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    suffix = ".urdf" if request.xacro else request.path.suffix.lower()
    return READERS.get(suffix, read_urdf)(request, meshes)
