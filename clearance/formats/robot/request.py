"""What is asked of a reader of robot files. Not for: reading them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from clearance.errors import BadRobot
from clearance.formats.mesh.triangles import UpAxis

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
    return tuple((name, _as_text(value)) for name, value in given.items())


def _as_text(value: str | bool | int | float) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
