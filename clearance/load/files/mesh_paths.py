"""Where a mesh named in a URDF or SDF file lies, a model, and a package: `package://…`, `model://…`, `file://…`,
absolute, or relative.

Source: resolve-robotics-uri-py 0.6 (BSD), for what the variables of ROS and Gazebo mean. Not for: reading.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

from clearance.errors import BadSyntax, MissingFile

_PACKAGE_SCHEMES = ("package", "model")

_VARIABLES = {
    "ROS_PACKAGE_PATH": "",
    "AMENT_PREFIX_PATH": "share",
    "GZ_SIM_RESOURCE_PATH": "",
    "IGN_GAZEBO_RESOURCE_PATH": "",
    "GAZEBO_MODEL_PATH": "",
    "SDF_PATH": "",
}
"""Variables that list folders with packages, and the folder in each of these in which the packages are."""


class MeshPath(NamedTuple):
    """A mesh file.

    Attributes:
        package: the package that the file was asked of and is not in; empty where it is.
        variable: the variable of the environment that led to it, if one did.
    """

    path: Path
    package: str = ""
    variable: str = ""


def mesh_path(given: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The file that `given` means.

    `package://x/y` is y in the package x, which is looked for in each of the package folders, in the file's
    folder and those above it, and where the variables of ROS and Gazebo say. Without the package, y and then y
    without its leading parts is looked for in the package folders and the file's folder: the longest match stands
    in.

    Raises:
        MissingFile: no such file, with the places tried. BadSyntax: a scheme that is not known.
    """
    scheme, separator, rest = given.partition("://")
    if not separator:
        return _existing(given, [urdf_folder / given.replace("\\", "/")])
    if scheme in _PACKAGE_SCHEMES:
        return _in_package(given, rest, urdf_folder, package_dirs)
    if scheme == "file":
        path = unquote(urlsplit(given).path)
        return _existing(given, [Path(path), urdf_folder / path.lstrip("/")])
    raise BadSyntax(f"{given!r} is given", valid="package://, file:// or a path is needed")


def model_path(given: str, folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The folder or file of a model that `given` means: `model://x`, `package://x`, `file://…` or a path.

    Args:
        folder: of the file that names it.

    Raises:
        MissingFile: no such folder or file, with the places tried. BadSyntax: a scheme that is not known.
    """
    scheme, separator, rest = given.partition("://")
    if separator and scheme in _PACKAGE_SCHEMES:
        package, *parts = _parts(rest)
        for place, variable in _package_folders(package, folder, package_dirs):
            if _is_there(place.joinpath(*parts)):
                return MeshPath(place.joinpath(*parts), variable=variable)
        raise MissingFile(
            f"there is no model {given!r}; looked for it {_places(folder, package_dirs)}",
            valid="give the folder that it is in as robot.package_dirs",
        )
    if separator and scheme != "file":
        raise BadSyntax(
            f"{given!r} is given", valid="model://, file:// or a path; nothing is fetched"
        )
    path = Path(unquote(urlsplit(given).path)) if separator else folder / given
    if not _is_there(path):
        raise MissingFile(f"there is no model {given!r}")
    return MeshPath(path)


def package_folder(package: str, folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The folder of a package.

    Args:
        folder: of the file that names it.

    Raises:
        MissingFile: no such folder, with the places tried.
    """
    for place, variable in _package_folders(package or " ", folder, package_dirs):
        if _is_there(place) and place.is_dir():
            return MeshPath(place, variable=variable)
    raise MissingFile(
        f"there is no package {package!r}; looked for it {_places(folder, package_dirs)}",
        valid="give its folder in robot.package_dirs",
    )


def _in_package(given: str, rest: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    package, *parts = _parts(rest)
    for folder, variable in _package_folders(package, urdf_folder, package_dirs):
        if _is_file(folder.joinpath(*parts)):
            return MeshPath(folder.joinpath(*parts), variable=variable)
    for n_dropped in range(len(parts)):
        for folder in (*package_dirs, urdf_folder):
            if _is_file(folder.joinpath(*parts[n_dropped:])):
                return MeshPath(folder.joinpath(*parts[n_dropped:]), package)
    raise MissingFile(
        f"there is no mesh {given!r}; looked for it {_places(urdf_folder, package_dirs)}",
        valid="give its package's folder in robot.package_dirs",
    )


def _is_file(path: Path) -> bool:
    return _is_there(path) and path.is_file()


def _is_there(path: Path) -> bool:
    """True for a file or folder; False also for a path that no file can have."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def _parts(rest: str) -> tuple[str, ...]:
    """The package and the parts of the path in it."""
    return PurePosixPath(rest.replace("\\", "/").lstrip("/")).parts or ("",)


def _package_folders(
    package: str, urdf_folder: Path, package_dirs: Sequence[Path]
) -> Iterator[tuple[Path, str]]:
    """Folders that are the package, if they are there, the nearest first; and the variable that names each."""
    above = Path(os.path.abspath(urdf_folder))
    near = [(folder, "") for folder in (urdf_folder, *above.parents)]
    for folder, variable in (*((one, "") for one in package_dirs), *near, *_from_variables()):
        yield folder / package, variable
        if _is_package(folder, package):
            yield folder, variable
        if folder in package_dirs:
            yield from (
                (below, "") for below in _packages_in(folder) if _is_package(below, package)
            )


def _packages_in(folder: Path) -> list[Path]:
    """The packages in a folder, as a workspace has them, whatever their folders are called."""
    try:
        return sorted(below for below in folder.iterdir() if (below / "package.xml").is_file())
    except OSError:
        return []


def _is_package(folder: Path, package: str) -> bool:
    """True for a folder of that name, and for one whose manifest has it."""
    if Path(os.path.abspath(folder)).name == package:
        return True
    try:
        manifest = (folder / "package.xml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    name = re.search(r"<name>\s*([^<\s]+)\s*</name>", manifest)
    return name is not None and name[1] == package


def _from_variables() -> Iterator[tuple[Path, str]]:
    """The folders with packages that the environment names, and the variable of each."""
    for name, below in _VARIABLES.items():
        for part in os.environ.get(name, "").split(os.pathsep):
            if part:
                yield Path(part, below), name


def variables_of(paths: Iterable[str]) -> list[str]:
    """The variables that name a folder which one of some files, by absolute path, lies in."""
    named = [(Path(os.path.abspath(folder)), name) for folder, name in _from_variables()]
    files = [Path(path) for path in paths] if named else []
    below = [name for folder, name in named if any(file.is_relative_to(folder) for file in files)]
    return list(dict.fromkeys(below))


def _places(urdf_folder: Path, package_dirs: Sequence[Path]) -> str:
    n_above = len(Path(os.path.abspath(urdf_folder)).parents)
    dirs = ", ".join(repr(path.name or str(path)) for path in package_dirs) or "none are given"
    ros = [f"${name} ({os.environ.get(name) or 'not set'})" for name in list(_VARIABLES)[:2]]
    others = [f"${name}" for name in list(_VARIABLES)[2:] if os.environ.get(name)]
    return (
        f"in robot.package_dirs ({dirs}), in the file's folder and the {n_above} above it, "
        f"in {' and '.join([*ros, *others])}"
    )


def _existing(given: str, candidates: list[Path]) -> MeshPath:
    for candidate in candidates:
        if _is_file(candidate):
            return MeshPath(candidate)
    raise MissingFile(f"there is no mesh {given!r}")
