"""Where a mesh named in a URDF lies: `package://…`, `file://…`, absolute, or relative."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

from clearance.errors import BadSyntax, MissingFile

_PACKAGE_SCHEMES = ("package", "model")

_VARIABLES = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")


class MeshPath(NamedTuple):
    """A mesh file.

    Attributes:
        package: the package that the file was asked of and is not in; empty where it is.
    """

    path: Path
    package: str = ""


def mesh_path(given: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The file that `given` means.

    `package://x/y` is y in the package x, which is looked for in each of the package folders, in the URDF's
    folder and those above it, and where ROS's variables say. Without the package, y and then y without its
    leading parts is looked for in the package folders and the URDF's folder: the longest match stands in.

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


def _in_package(given: str, rest: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    package, *parts = PurePosixPath(rest.replace("\\", "/").lstrip("/")).parts or ("",)
    for folder in _package_folders(package, urdf_folder, package_dirs):
        if folder.joinpath(*parts).is_file():
            return MeshPath(folder.joinpath(*parts))
    for n_dropped in range(len(parts)):
        for folder in (*package_dirs, urdf_folder):
            if folder.joinpath(*parts[n_dropped:]).is_file():
                return MeshPath(folder.joinpath(*parts[n_dropped:]), package)
    raise MissingFile(
        f"there is no mesh {given!r}; looked for it {_places(urdf_folder, package_dirs)}",
        valid="give its package's folder in robot.package_dirs",
    )


def _package_folders(
    package: str, urdf_folder: Path, package_dirs: Sequence[Path]
) -> Iterator[Path]:
    """Folders that are the package, if they are there; the nearest first."""
    above = Path(os.path.abspath(urdf_folder))
    ros = [*_from_variable("ROS_PACKAGE_PATH")]
    for folder in (*package_dirs, urdf_folder, *above.parents, *ros):
        yield folder / package
        if _is_package(folder, package):
            yield folder
    for prefix in _from_variable("AMENT_PREFIX_PATH"):
        yield prefix / "share" / package


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


def _from_variable(name: str) -> list[Path]:
    return [Path(part) for part in os.environ.get(name, "").split(os.pathsep) if part]


def _places(urdf_folder: Path, package_dirs: Sequence[Path]) -> str:
    n_above = len(Path(os.path.abspath(urdf_folder)).parents)
    dirs = ", ".join(repr(path.name or str(path)) for path in package_dirs) or "none are given"
    variables = [f"${name} ({os.environ.get(name) or 'not set'})" for name in _VARIABLES]
    return (
        f"in robot.package_dirs ({dirs}), in the URDF's folder and the {n_above} above it, "
        f"in {' and '.join(variables)}"
    )


def _existing(given: str, candidates: list[Path]) -> MeshPath:
    for candidate in candidates:
        if candidate.is_file():
            return MeshPath(candidate)
    raise MissingFile(f"there is no mesh {given!r}")
