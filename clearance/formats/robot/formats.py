"""A robot file to a robot, by the reader of its suffix: a further format is a file and a row here.

Not for: where the robot stands, or how it moves (`robots`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from clearance.formats.files.foreign_files import is_mjcf
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh.placing import UpAxis
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import Geometry, RobotRequest, request_in_memory
from clearance.formats.robot.urdf.robot import read_urdf
from clearance.world.robot import Robot


def read_robot_xml(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a file that is called XML: MJCF by its root element, else URDF."""
    data = meshes.files.read(request.path)
    return (read_robot_mjcf if is_mjcf(data) else read_urdf)(request, meshes)


def read_robot_mjcf(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in an MJCF file."""
    from clearance.formats.robot.mjcf.robot import read_mjcf

    return read_mjcf(request, meshes)


READERS: dict[str, Callable[[RobotRequest, MeshStore], Robot]] = {
    ".urdf": read_urdf,
    ".mjcf": read_robot_mjcf,
    ".xml": read_robot_xml,
}
"""By suffix in small letters; a file of another suffix is read as URDF."""


def read_robot(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a file.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    suffix = ".urdf" if request.xacro else request.path.suffix.lower()
    return READERS.get(suffix, read_urdf)(request, meshes)


def load_robot(
    path: str | Path,
    *,
    package_dirs: Sequence[str | Path] = (),
    geometry: Geometry = "collision",
    collada_up_axis: UpAxis = "ros",
    xacro: bool = False,
    xacro_args: Mapping[str, str | bool | int | float] = MappingProxyType({}),
) -> Robot:
    """The robot in a file of any format that is read, for cases that are made in memory.

    Args:
        path: of a URDF or MJCF file; or `pybullet_data:…`, as in a case file.
        package_dirs, geometry, collada_up_axis, xacro, xacro_args: as in `RobotRequest`.

    Raises:
        BadInput: with the file and the element.
    """
    request = request_in_memory(path, package_dirs, geometry, collada_up_axis, xacro, xacro_args)
    return read_robot(request, MeshStore(InputFiles(request.path.parent)))
