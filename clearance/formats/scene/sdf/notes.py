"""What is told of an SDF file: what was left out, and how the rest was taken. Not for: reading it (`scene`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from clearance.formats.robot.plane_box import PLANE_DEPTH, PLANE_SIDE
from clearance.formats.scene.sdf.document import n_rounded
from clearance.formats.scene.sdf.geometry import has_no_size
from clearance.formats.scene.sdf.scope import SdfShape
from clearance.formats.text.notes import note_on_rounded
from clearance.world.notice import Notice, Severity, listed

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_LEFT_OUT = (
    "visual",
    "light",
    "sensor",
    "plugin",
    "actor",
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
            f"a plane, which has no end, is a box {PLANE_DEPTH:g} m deep below it, which ends "
            f"{PLANE_SIDE / 2:g} m from its origin"
        )
    yield from note_on_rounded(sum(map(n_rounded, documents)))
    if missing_suns:
        yield "model://sun is not there: taken for the usual light and left out"


_PLANE = [PLANE_SIDE, PLANE_SIDE, PLANE_DEPTH]


def unseen(documents: Sequence[Element]) -> list[Notice]:
    """A warning on links that have a visual but no collision shape and are not measured."""
    links = [link for document in documents for link in document.iter("link")]
    names = [
        repr(_path(link))
        for link in links
        if link.find("visual") is not None and link.find("collision") is None
    ]
    if not names:
        return []
    have, are = ("1 link has", "is") if len(names) == 1 else (f"{len(names)} links have", "are")
    text = f"{have} a visual but no collision shape and {are} not measured: {listed(names, 6)}"
    return [Notice(Severity.WARNING, "geometry", text)]


def empty(documents: Sequence[Element]) -> list[Notice]:
    """A warning on collisions that have no size and are left out."""
    links = [link for document in documents for link in document.iter("link")]
    names = [
        repr(f"{_path(link)}/{collision.get('name')}")
        for link in links
        for collision in link.iterfind("collision")
        if has_no_size(collision)
    ]
    if not names:
        return []
    text = f"collisions without a size, not measured: {listed(names, 6)}"
    return [Notice(Severity.WARNING, "geometry", text)]


def _path(link: Element) -> str:
    owner = link.getparent()
    model = "" if owner is None else owner.get("name") or ""
    return f"{model}/{link.get('name')}"
