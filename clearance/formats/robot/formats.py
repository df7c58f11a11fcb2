"""A robot file to a robot, by the reader of its format.

Not for: where the robot stands, or how it moves (`robots`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.mesh.triangles import UpAxis
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import Geometry, RobotRequest, checked_args
from clearance.formats.robot.urdf.robot import read_urdf
from clearance.world.robot import Robot


def read_robot(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a file; one of a format that is not known is read as URDF.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    if request.xacro:
        return read_urdf(request, meshes)
    known = format_of(Kind.ROBOT, request.path.name, meshes.files.read(request.path))
    assert known is not None  # as any file is URDF where nothing says otherwise
    robot: Robot = function_at(known.read)(request, meshes)
    return robot


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
        path: of a URDF or MJCF file; or the name of what a package brings, as in a case file. Paths are relative
            to the current folder.
        package_dirs, geometry, collada_up_axis, xacro, xacro_args: as in `RobotRequest`.

    Raises:
        BadInput: with the file and the element.
    """
    request = RobotRequest(
        resolved(str(path), Path()),
        tuple(map(Path, package_dirs)),
        geometry,
        collada_up_axis,
        xacro,
        checked_args(xacro_args),
    )
    return read_robot(request, MeshStore(InputFiles(request.path.parent)))
