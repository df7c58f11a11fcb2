"""Files that an installed package brings, by the package's name: `pybullet_data:kuka_iiwa/model.urdf`, or
`example-robot-data:ur5` for the one robot of that name.

A further package is one row of `PROVIDERS`. No package is imported and nothing is fetched. Not for: files of ROS
packages (`mesh_paths`), nor what is in a robot's file (`robot.listing`).
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from clearance.errors import MissingFile, Unavailable, nearest_name
from clearance.extras import install
from clearance.formats.files.place import current_place


@dataclass(frozen=True)
class Provider:
    """A package that brings robots.

    Attributes:
        name: what stands before the colon. installs: the command that installs it.
        place: the folder of its files on this machine, which need not be there; None where it is not installed.
        fetches: the command of a package that brings no files until it is asked to.
    """

    name: str
    installs: str
    place: Callable[[], Path | None]
    fetches: str = ""

    @property
    def folder(self) -> Path | None:
        """Where its files are; None where it is not installed, or has none here."""
        place = current_place()
        found = self.place() if place is None else place.packages / self.name
        return None if found is None or not found.is_dir() else found

    @property
    def remedy(self) -> str:
        """What to do where it has no folder."""
        if not self.fetches or self.place() is None:
            return self.installs
        return f"it has fetched no robot yet: {self.fetches}"


def _package(name: str) -> Path | None:
    """The folder of a package of Python, found without importing it (pybullet_data takes 0.1 s)."""
    found = importlib.util.find_spec(name)
    return None if found is None or found.origin is None else Path(found.origin).parent


def _shared(name: str) -> Path | None:
    """The folder of a package that brings files only, as packages of C++ do."""
    places = (Path(entry, "cmeel.prefix", "share", name) for entry in sys.path)
    return next((place for place in places if place.is_dir()), None)


def _clones(package: str, variable: str, cache: str) -> Path | None:
    """The folder that a package clones repositories into."""
    if _package(package) is None:
        return None
    return Path(os.path.expanduser(os.environ.get(variable, cache)))


PROVIDERS = (
    Provider("pybullet_data", install("simulate"), lambda: _package("pybullet_data")),
    Provider(
        "example-robot-data",
        "pip install example-robot-data",
        lambda: _shared("example-robot-data"),
    ),
    Provider(
        "robot_descriptions",
        "pip install robot_descriptions",
        lambda: _clones(
            "robot_descriptions", "ROBOT_DESCRIPTIONS_CACHE", "~/.cache/robot_descriptions"
        ),
        "robot_descriptions pull NAME",
    ),
)  # fmt: skip
"""By the names of their packages; that of the last one has what its own loader has cloned before."""


_OF_ANY = ("model", "robot")
"""How the name of a file begins that any robot may have."""


def is_brought(given: str | Path) -> bool:
    """True for the name of what a package brings."""
    return _split(str(given)) is not None


def _split(given: str) -> tuple[Provider, str] | None:
    name, colon, rest = given.partition(":")
    found = next((one for one in PROVIDERS if one.name == name), None)
    return (found, rest) if found and colon else None


def brought_path(given: str) -> Path | None:
    """The file that a name means: a path below the folder of the package, or a robot of it; None where no package
    is named.

    Raises:
        Unavailable: the package is not installed, or has no files here. MissingFile: no robot, or several, have
            that name.
    """
    named = _split(given)
    if named is None:
        return None
    provider, rest = named
    folder = provider.folder
    if folder is None:
        raise Unavailable(f"{given!r} needs the package {provider.name}", valid=provider.remedy)
    path = folder / rest.lstrip("/")
    if path.is_file():
        return path
    if "/" in rest or Path(rest).suffix:
        if path.exists():
            return path
        raise _missing(provider, f"file {rest!r}", rest, _files(folder, Path(rest).suffix))
    known = robot_names(folder)
    found = known.get(rest) or known.get(rest.removesuffix("_description"), [])
    if len(found) == 1:
        return folder / found[0]
    if found:
        raise MissingFile(f"{given!r} may be any of several", valid=f"one of {', '.join(found)}")
    if path.exists():
        return path
    raise _missing(provider, f"robot {rest!r}", rest, known)


def _missing(provider: Provider, what: str, given: str, known: Iterable[str]) -> MissingFile:
    """What a package does not bring, with the nearest name of what it does."""
    lists = f"`clearance robots {provider.name}` lists its robots"
    fetches = f", `{provider.fetches}` fetches another" if provider.fetches else ""
    valid = f"{nearest_name(given, known)} ({lists}{fetches})"
    return MissingFile(f"{provider.name} brings no {what}", valid=valid)


def robot_names(folder: Path) -> dict[str, list[str]]:
    """The paths of the URDF files below a folder, by the names that they go by: that of the file, if it says which
    robot it is; also without `_robot` at its end where no file has that name."""
    paths = sorted(_files(folder, ".urdf"))
    names: dict[str, list[str]] = {}
    for path in paths:
        stem = Path(path).stem
        names.setdefault(path if stem.startswith(_OF_ANY) else stem, []).append(path)
    for name in [one for one in names if one.endswith("_robot")]:
        names.setdefault(name.removesuffix("_robot"), names[name])
    return names


def _files(folder: Path, suffix: str) -> Iterator[str]:
    """The files below a folder that end so, as seen from it, with `/`."""
    for place, folders, files in os.walk(folder):
        folders[:] = [one for one in folders if one != ".git"]
        own = Path(place).relative_to(folder)
        yield from ((own / file).as_posix() for file in files if file.endswith(suffix))


def brought_folders() -> dict[str, str]:
    """What stands before the colon, by the folder of each package whose files are here; absolute."""
    found = ((one.folder, one.name) for one in PROVIDERS)
    return {os.path.abspath(folder): name for folder, name in found if folder is not None}
