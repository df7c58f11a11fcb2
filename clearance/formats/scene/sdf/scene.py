"""SDF worlds and models, Gazebo's files, to a scene: one obstacle for each collision, where it is placed.

Visuals, lights, sensors and plugins are left out and counted. Not for: robots, which are URDF.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clearance.errors import BadInput, at
from clearance.formats.files.found_files import FoundFiles
from clearance.formats.files.lookups import MESH, note_lookup
from clearance.formats.files.mesh_paths import mesh_path
from clearance.formats.plausibility import angle_notices, odd_angles
from clearance.formats.scene.pose_row import pose_row
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.formats.scene.sdf.document import angles_of
from clearance.formats.scene.sdf.include import IncludeReader
from clearance.formats.scene.sdf.notes import empty, notes_on, unseen
from clearance.formats.scene.sdf.scope import Scope, SdfShape
from clearance.formats.scene.sdf.state import require_state_as_placed

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


def read_sdf(asked: SceneRequest) -> SceneContent:
    """The obstacles in an SDF file, called model/link/collision.

    Raises:
        BadInput: with the file and the element: what is not SDF, what is not read, and why.
    """
    with at(asked.shown):
        reader = IncludeReader(asked)
        root = reader.root(asked.path)
        scope = Scope(asked.path.parent, reader.include, (asked.shown,))
        shapes = [shape for place in _places(root) for shape in _shapes(place, scope)]
        files = _Files(asked, reader.found)
        obstacles = [files.obstacle(shape) for shape in shapes]
        renamed, said = _make_unique(obstacles), reader.notices()
    notes = [*notes_on(reader.documents, reader.missing_suns, shapes), *renamed]
    odd = [text for document in reader.documents for text in _odd(document)]
    return SceneContent(
        {"obstacles": obstacles},
        (*(f"{asked.shown}: {note}" for note in notes), *reader.found.notes()),
        (
            *said,
            *angle_notices(odd),
            *reader.found.notices(),
            *unseen(reader.documents),
            *empty(reader.documents),
        ),
    )


def _places(root: Element) -> Iterator[tuple[str, Element]]:
    """The world, or the file itself with its models, and what each calls its own frame."""
    worlds = root.findall("world")
    if len(worlds) > 1:
        raise BadInput(f"{len(worlds)} worlds are given", valid="a file with one world")
    yield from (("world", world) for world in worlds)
    yield "__root__", root


def _shapes(place: tuple[str, Element], scope: Scope) -> list[SdfShape]:
    root, element = place
    frames, shapes = scope.read(element, root)
    require_state_as_placed(element, frames)
    return shapes


class _Files:
    """Finds meshes, and keeps what is to be reported of them."""

    def __init__(self, asked: SceneRequest, known: FoundFiles) -> None:
        self._asked, self._known = asked, known

    def obstacle(self, shape: SdfShape) -> dict[str, Any]:
        """The row of a YAML scene for a collision."""
        row = {"name": shape.name, **shape.row, "pose": pose_row(shape.pose)}
        if "mesh" in row:
            with at(shape.name):
                row["mesh"] = row["mesh"] | {"file": self._file(row["mesh"]["file"], shape.folder)}
        return row

    def _file(self, uri: str, folder: Path) -> str:
        found = mesh_path(uri, folder, self._asked.package_dirs)
        note_lookup(self._asked.files, MESH, uri, folder, self._asked.package_dirs, found.path)
        shown = self._asked.files.shown(found.path)
        self._known.add(uri, found, shown)
        return os.path.relpath(found.path, self._asked.path.parent)


def _make_unique(obstacles: list[dict[str, Any]]) -> list[str]:
    """Gives obstacles of one name names of their own, and a note on them."""
    taken = Counter(row["name"] for row in obstacles)
    seen: set[str] = set()
    renamed = []
    for row in obstacles:
        name, n = row["name"], 1
        while row["name"] in seen:
            n += 1
            row["name"] = f"{name}_{n}" if f"{name}_{n}" not in taken else row["name"]
        if row["name"] != name:
            renamed.append(repr(row["name"]))
        seen.add(row["name"])
    if not renamed:
        return []
    more = "" if len(renamed) <= 3 else f" and {len(renamed) - 3} more"
    return [f"names that are there twice are numbered: {', '.join(renamed[:3])}{more}"]


def _odd(document: Element) -> Iterator[str]:
    for tag in ("model", "link", "collision"):
        for element in document.iter(tag):
            yield from odd_angles(f"{tag} {element.get('name')!r}", angles_of(element))
