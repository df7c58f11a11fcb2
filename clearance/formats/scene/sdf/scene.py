"""SDF worlds and models, Gazebo's files, to a scene: one obstacle for each collision, where it is placed.

Visuals, lights, sensors and plugins are left out and counted. Not for: robots, which are URDF.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from clearance.errors import BadScene, at
from clearance.formats.files.found_files import FoundFiles
from clearance.formats.plausibility import angle_notices, odd_angles
from clearance.formats.robot.shape_kinds import without_shape
from clearance.formats.scene.request import SceneContent, SceneRequest, pose_row
from clearance.formats.scene.sdf.document import angles_of, n_rounded
from clearance.formats.scene.sdf.geometry import has_no_size
from clearance.formats.scene.sdf.include import IncludeReader
from clearance.formats.scene.sdf.scope import Scope, SdfShape, require_state_as_placed
from clearance.formats.text.notes import note_on_rounded
from clearance.formats.text.unread import notes_on as notes_on_unread
from clearance.formats.text.unread import notices_on
from clearance.world.extents import PLANE_SIZE
from clearance.world.notice import Notice, naming, warnings_naming

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
        obstacles = [_row(shape, asked, reader.found) for shape in shapes]
        renamed, said = _make_unique(obstacles), reader.notices()
    notes = [*notes_on(reader.documents, reader.missing_suns, shapes), *renamed]
    notes += notes_on_unread(reader.unread)
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
            *notices_on(reader.unread),
        ),
    )


def _places(root: Element) -> Iterator[tuple[str, Element]]:
    """The world, or the file itself with its models, and what each calls its own frame."""
    worlds = root.findall("world")
    if len(worlds) > 1:
        raise BadScene(f"{len(worlds)} worlds are given", valid="a file with one world")
    yield from (("world", world) for world in worlds)
    yield "__root__", root


def _shapes(place: tuple[str, Element], scope: Scope) -> list[SdfShape]:
    root, element = place
    frames, shapes = scope.read(element, root)
    require_state_as_placed(element, frames)
    return shapes


def _row(shape: SdfShape, asked: SceneRequest, known: FoundFiles) -> dict[str, Any]:
    """The row of a YAML scene for a collision."""
    row = {"name": shape.name, **shape.row, "pose": pose_row(shape.pose)}
    if "mesh" in row:
        with at(shape.name):
            uri = row["mesh"]["file"]
            path = known.mesh(uri, shape.folder)
            row["mesh"] = row["mesh"] | {"file": os.path.relpath(path, asked.path.parent)}
    return row


def _make_unique(obstacles: list[dict[str, Any]]) -> list[str]:
    """Gives obstacles of one name names of their own, and a note on them."""
    n_of = Counter(row["name"] for row in obstacles)
    seen: set[str] = set()
    renamed = []
    for row in obstacles:
        name, n = row["name"], 1
        while row["name"] in seen:
            n += 1
            row["name"] = f"{name}_{n}" if f"{name}_{n}" not in n_of else row["name"]
        if row["name"] != name:
            renamed.append(repr(row["name"]))
        seen.add(row["name"])
    return naming("names that are there twice are numbered", renamed, 3)


def _odd(document: Element) -> Iterator[str]:
    for tag in ("model", "link", "collision"):
        for element in document.iter(tag):
            yield from odd_angles(f"{tag} {element.get('name')!r}", angles_of(element))


_LEFT_OUT = (
    "visual",
    "light",
    "sensor",
    "plugin",
    "road",
    "gripper",
    "projector",
    "particle_emitter",
    "empty",
)


def notes_on(
    documents: Sequence[Element], missing_suns: int, shapes: Sequence[SdfShape]
) -> Iterator[str]:
    """The notes on a file and those that it includes, without its name.

    Args:
        missing_suns: how many includes of the usual light were not found.
    """
    counted = Counter(str(element.tag) for document in documents for element in document.iter())
    left_out = [f"{counted[tag]} <{tag}>" for tag in _LEFT_OUT if counted[tag]]
    if left_out:
        yield f"left out: {', '.join(left_out)}"
    joints = [joint for document in documents for joint in document.iter("joint")]
    n_moving = sum((joint.get("type") or "") not in ("", "fixed") for joint in joints)
    if n_moving:
        yield f"joints stand at zero, as the links are placed: {n_moving} that could move"
    if counted["plane"] and any(shape.row.get("box", {}).get("size") == _PLANE for shape in shapes):
        yield (
            f"a plane, which has no end, is a box {PLANE_SIZE[2]:g} m deep below it, which ends "
            f"{PLANE_SIZE[0] / 2:g} m from its origin"
        )
    yield from note_on_rounded(sum(map(n_rounded, documents)))
    if missing_suns:
        yield "model://sun is not there: taken for the usual light and left out"


_PLANE = list(PLANE_SIZE)


def unseen(documents: Sequence[Element]) -> list[Notice]:
    """Warnings on what is seen and not measured: links with a visual but no collision shape, and actors."""
    links = [link for document in documents for link in document.iter("link")]
    names = [
        repr(_path(link))
        for link in links
        if link.find("visual") is not None and link.find("collision") is None
    ]
    actors = [repr(one.get("name")) for document in documents for one in document.iter("actor")]
    return [
        *warnings_naming(without_shape(len(names), "visual", "collision"), names),
        *warnings_naming("actors move and are not measured", actors),
    ]


def empty(documents: Sequence[Element]) -> list[Notice]:
    """A warning on collisions that have no size and are left out."""
    links = [link for document in documents for link in document.iter("link")]
    names = [
        repr(f"{_path(link)}/{collision.get('name')}")
        for link in links
        for collision in link.iterfind("collision")
        if has_no_size(collision)
    ]
    return warnings_naming("collisions without a size, not measured", names)


def _path(link: Element) -> str:
    owner = link.getparent()
    model = "" if owner is None else owner.get("name") or ""
    return f"{model}/{link.get('name')}"
