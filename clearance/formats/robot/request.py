"""What is asked of a reader of robot files, and a file to a robot by the reader of its format.

Not for: where the robot stands, or how it moves (`robots`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from clearance.errors import BadRobot
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.mesh.triangles import UpAxis
from clearance.formats.mesh_store import MeshStore
from clearance.formats.text.xml_document import XACRO
from clearance.world.robot import Robot

Geometry = Literal["collision", "visual", "collision_or_visual"]


@dataclass(frozen=True)
class RobotRequest:
    """Which robot, and how its file is to be read.

    Attributes:
        path: the robot's file.
        package_dirs: where `package://` is looked up first.
        geometry: which shapes are the robot's; "collision_or_visual" takes the visual ones of links that have no
            others.
        collada_up_axis: "ros" leaves COLLADA and GLB files as they lie, "file" turns them to z up as they say.
        xacro: the file is made into URDF by xacro first, which evaluates Python. xacro_args: its arguments.
    """

    path: Path
    package_dirs: tuple[Path, ...] = ()
    geometry: Geometry = "collision"
    collada_up_axis: UpAxis = "ros"
    xacro: bool = False
    xacro_args: tuple[tuple[str, str], ...] = ()


def checked_args(given: Mapping[str, str | bool | int | float]) -> tuple[tuple[str, str], ...]:
    """The arguments of a case file as on xacro's command line.

    Raises:
        BadInput: a name that no argument can have.
    """
    for name in given:
        if not name or ":=" in name or name != name.strip():
            raise BadRobot(f"{name!r:.60} is given", valid="names of the file's xacro:arg elements")
    return tuple(
        (name, str(value).lower() if isinstance(value, bool) else str(value))
        for name, value in given.items()
    )


def read_robot(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a file; one of a format that is not known is read as URDF.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    path = request.path
    given = (f"robot{XACRO}", b"") if request.xacro else (path.name, meshes.files.read(path))
    known = format_of(Kind.ROBOT, *given)
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
