"""The robots that installed packages bring: what to call each, and what is in its file.

A robot is a URDF file with a joint that moves. Not for: reading a robot (`urdf.robot`), nor where packages are
(`files.brought`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import ClearanceError
from clearance.formats.files.brought import PROVIDERS, Provider, robot_names
from clearance.formats.files.mesh_paths import mesh_path
from clearance.formats.mesh.mesh_file import triangles_from_bytes
from clearance.formats.text.xml_document import robot_element

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


@dataclass(frozen=True)
class BroughtRobot:
    """A robot of a package.

    Attributes:
        given: what `--robot` and `urdf:` call it. n_shapes: round and box-shaped collision shapes.
        n_triangles: of its collision meshes, None where one cannot be read. n_missing: those that are not there.
    """

    given: str
    n_links: int
    n_shapes: int
    n_triangles: int | None
    n_missing: int


def brought_robots() -> Iterator[BroughtRobot]:
    """The robots of all packages that are installed, by name; a file that is no URDF is none."""
    for provider in PROVIDERS:
        if (folder := provider.folder) is not None:
            found = (_robot(given, path) for given, path in _named(provider, folder))
            yield from sorted(filter(None, found), key=lambda one: one.given)


def _named(provider: Provider, folder: Path) -> Iterator[tuple[str, Path]]:
    """Each URDF file with the shortest name that means it alone, or else its path."""
    by_path: dict[str, list[str]] = {}
    for name, paths in robot_names(folder).items():
        for path in paths:
            by_path.setdefault(path, [path]).extend([name] if len(paths) == 1 else [])
    for path, names in by_path.items():
        yield f"{provider.name}:{min(names, key=len)}", folder / path


def _robot(given: str, path: Path) -> BroughtRobot | None:
    """What a file says; None without a joint that moves."""
    try:
        root = robot_element(path.read_bytes(), "a URDF file")
    except (ClearanceError, OSError):
        return None
    if all(one.get("type", "fixed") == "fixed" for one in root.iterfind("joint")):
        return None
    shapes = root.findall("link/collision/geometry/*")
    meshes = [one for one in shapes if one.tag == "mesh"]
    files = [_mesh_file(one, path.parent) for one in meshes]
    counts = [_n_triangles(one) for one in files if one is not None]
    return BroughtRobot(
        given,
        len(root.findall("link")),
        len(shapes) - len(meshes),
        None if None in counts else sum(filter(None, counts)),
        files.count(None),
    )


def _mesh_file(mesh: Element, folder: Path) -> Path | None:
    try:
        return mesh_path(mesh.get("filename", ""), folder, ()).path
    except ClearanceError:
        return None


@cache
def _n_triangles(path: Path) -> int | None:
    try:
        return len(triangles_from_bytes(path.read_bytes(), path.name).corners)
    except (ClearanceError, OSError):
        return None
