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
from clearance.formats.files.place import environment, here

_PACKAGE_SCHEMES = ("package", "model")

VARIABLES = {
    "ROS_PACKAGE_PATH": "",
    "AMENT_PREFIX_PATH": "share",
    "GZ_SIM_RESOURCE_PATH": "",
    "IGN_GAZEBO_RESOURCE_PATH": "",
    "GAZEBO_MODEL_PATH": "",
    "SDF_PATH": "",
}
"""Variables that list folders with packages, and the folder in each of these in which the packages are."""


_BUILT = ("build", "log")
"""What colcon and catkin leave in a workspace beside the packages."""

MOST_FOLDERS = 20_000
"""Below a folder that is given; some 0.3 s."""


class MeshPath(NamedTuple):
    """A mesh file.

    Attributes:
        package: the package that the file was asked of and is not in; empty where it is.
        variable: the variable of the environment that led to it, if one did.
        elsewhere: it was asked of a path on another machine, and is in the same package here.
    """

    path: Path
    package: str = ""
    variable: str = ""
    elsewhere: bool = False


def mesh_path(given: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The file that `given` means.

    `package://x/y` is y in the package x, which is looked for in each of the package folders and all below them,
    in the file's folder and those above it, and where the variables of ROS and Gazebo say. An absolute path that
    is not there is looked for in the same way, by each of its folders as the package. Without the package, y and
    then y without its leading parts is looked for in the package folders and the file's folder: the longest match
    stands in.

    Raises:
        MissingFile: no such file, with the places tried. BadSyntax: a scheme that is not known.
    """
    scheme, separator, rest = given.partition("://")
    if separator and scheme in _PACKAGE_SCHEMES:
        return _in_package(given, rest, urdf_folder, package_dirs)
    if separator and scheme != "file":
        raise BadSyntax(f"{given!r} is given", valid="package://, file:// or a path is needed")
    if not separator:
        places = [(here(urdf_folder / given.replace("\\", "/")), "")]
    else:
        places = [*_file_places(given, urdf_folder, package_dirs)]
    for place, variable in places:
        if os.path.isfile(place):
            return MeshPath(place, variable=variable)
    return _on_another_machine(given, _file_path(given), urdf_folder, package_dirs)


def _file_path(given: str) -> str:
    """The path in `file://…`, which has no host of its own, or the path that is given."""
    if "://" not in given:
        return given.replace("\\", "/")
    parts = urlsplit(given)
    return unquote(parts.path if parts.netloc in ("", "localhost") else parts.netloc + parts.path)


def _file_places(
    given: str, folder: Path, package_dirs: Sequence[Path]
) -> Iterator[tuple[Path, str]]:
    """Where `file://…` may lie, and the variable that names each: a path that does not begin with / is of a
    resource, as Gazebo has it.
    """
    path = _file_path(given)
    if path.startswith("/"):
        yield here(path), ""
    near = [(one, "") for one in (folder, *package_dirs)]
    for place, variable in (*near, *_from_variables()):
        yield place / path.lstrip("/"), variable


def _on_another_machine(
    given: str, path: str, folder: Path, package_dirs: Sequence[Path]
) -> MeshPath:
    """The file of the same package, for an absolute path that is of another machine.

    Raises:
        MissingFile: no folder of the path is a package that is here.
    """
    parts = PurePosixPath(path).parts[1:] if path.startswith("/") else ()
    remedy = "give the folder of its package in robot.package_dirs" if parts else ""
    for i, package in enumerate(parts[:-1]):
        for place, variable in _package_folders(package, folder, package_dirs):
            found = place.joinpath(*parts[i + 1 :])
            if os.path.isfile(found):
                chosen = not {place, place.parent}.isdisjoint(package_dirs)
                proven = chosen or _has_manifest(found, place)
                return MeshPath(found, "" if proven else package, variable, elsewhere=True)
            if os.path.isfile(place / "package.xml"):
                remedy = _other_version(package, parts[i + 1 :])
    raise MissingFile(f"there is no mesh {given!r}", valid=remedy)


def _has_manifest(file: Path, place: Path) -> bool:
    """True for a file in a package, which begins at a place or below it."""
    folders = (folder for folder in file.parents if folder.is_relative_to(place))
    return any((folder / "package.xml").is_file() for folder in folders)


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
            if _is_model(place.joinpath(*parts)):
                return MeshPath(place.joinpath(*parts), variable=variable)
        raise MissingFile(
            f"there is no model {given!r}; looked for it {_places(folder, package_dirs)}",
            valid="give the folder that it is in as robot.package_dirs",
        )
    if separator and scheme != "file":
        raise BadSyntax(
            f"{given!r} is given", valid="model://, file:// or a path; nothing is fetched"
        )
    places = [(here(folder / given), "")]
    if separator:
        places = [*_file_places(given, folder, package_dirs)]
    for place, variable in places:
        if _is_model(place):
            return MeshPath(place, variable=variable)
    raise MissingFile(f"there is no model {given!r}")


def package_folder(package: str, folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    """The folder of a package.

    Args:
        folder: of the file that names it.

    Raises:
        MissingFile: no such folder, with the places tried.
    """
    found = [
        (place, variable)
        for place, variable in _package_folders(package or " ", folder, package_dirs)
        if os.path.isdir(place)
    ]
    with_manifest = [one for one in found if (one[0] / "package.xml").is_file()]
    for place, variable in (*with_manifest, *found):
        return MeshPath(place, variable=variable)
    raise MissingFile(
        f"there is no package {package!r}; looked for it {_places(folder, package_dirs)}",
        valid="give its folder in robot.package_dirs",
    )


def _in_package(given: str, rest: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> MeshPath:
    package, *parts = _parts(rest)
    remedy = "give its package's folder in robot.package_dirs"
    for folder, variable in _package_folders(package, urdf_folder, package_dirs):
        if os.path.isfile(folder.joinpath(*parts)):
            return MeshPath(folder.joinpath(*parts), variable=variable)
        if os.path.isfile(folder / "package.xml"):
            remedy = _other_version(package, parts)
    for n_dropped in range(len(parts)):
        for folder in (*package_dirs, urdf_folder):
            if os.path.isfile(folder.joinpath(*parts[n_dropped:])):
                return MeshPath(folder.joinpath(*parts[n_dropped:]), package)
    raise MissingFile(
        f"there is no mesh {given!r}; looked for it {_places(urdf_folder, package_dirs)}",
        valid=remedy,
    )


def _other_version(package: str, parts: Sequence[str]) -> str:
    """The remedy for a file that is not in its package."""
    return f"package {package!r} is here, without {'/'.join(parts)}: is it of another version?"


def _is_model(path: Path) -> bool:
    """True for a file, and for the folder of a model: `model://bin` is not /bin."""
    return os.path.isfile(path) or any(
        os.path.isfile(path / name) for name in ("model.config", "model.sdf")
    )


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
        if is_package(folder, package):
            yield folder, variable
        if folder in package_dirs:
            yield from ((below, "") for below in _below(folder) if is_package(below, package))


def _below(folder: Path) -> Iterator[Path]:
    """The folders below one, the highest first, at most `MOST_FOLDERS`: of a workspace, its `src` or `install`."""
    level, n_left = [folder], MOST_FOLDERS
    while level and n_left > 0:
        level = [below for place in level for below in _folders_in(place)][:n_left]
        n_left -= len(level)
        yield from level


def _folders_in(folder: Path) -> list[Path]:
    """What may hold packages: nothing that is hidden, or that building leaves behind."""
    try:
        return sorted(
            below
            for below in folder.iterdir()
            if below.is_dir() and not below.name.startswith(".") and below.name not in _BUILT
        )
    except OSError:
        return []


def is_package(folder: Path, package: str) -> bool:
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
    for name, below in VARIABLES.items():
        for part in environment().get(name, "").split(os.pathsep):
            if part:
                yield Path(part, below), name


def variables_of(paths: Iterable[str]) -> dict[str, list[str]]:
    """The variables that name a folder in which one of some files lies, with these parts of them; all absolute."""
    named = [(Path(os.path.abspath(folder)), name) for folder, name in _from_variables()]
    files = [Path(path) for path in paths] if named else []
    found: dict[str, list[str]] = {}
    for folder, name in named:
        if any(file.is_relative_to(folder) for file in files):
            part = folder.parent if VARIABLES[name] else folder
            found.setdefault(name, []).append(str(part))
    return found


def _places(urdf_folder: Path, package_dirs: Sequence[Path]) -> str:
    n_above = len(Path(os.path.abspath(urdf_folder)).parents)
    dirs = ", ".join(repr(path.name or str(path)) for path in package_dirs) or "none are given"
    ros = [f"${name} ({environment().get(name) or 'not set'})" for name in list(VARIABLES)[:2]]
    others = [f"${name}" for name in list(VARIABLES)[2:] if environment().get(name)]
    return (
        f"in robot.package_dirs ({dirs}), in the file's folder and the {n_above} above it, "
        f"in {' and '.join([*ros, *others])}"
    )
