"""Which of a link's shapes are the robot's, those to collide with or those to be seen, and what that leaves
out; and the box that stands for a plane.

Not for: the shapes themselves (`urdf.shapes`, `mjcf.shapes`), nor where a plane is (`sdf.geometry`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clearance.errors import NothingToMeasure
from clearance.formats.robot.request import Geometry
from clearance.formats.text.notes import counted
from clearance.world.extents import PLANE_SIZE
from clearance.world.notice import Notice, Severity, naming

Kinds = Mapping[str, frozenset[str]]
"""By link, in order, which of "collision" and "visual" it has shapes of."""

_OTHER = {"collision": "visual", "visual": "collision"}


def chosen_kind(has: frozenset[str], geometry: Geometry) -> str:
    """Which shapes of a link are measured, of those that it has."""
    if geometry != "collision_or_visual":
        return geometry
    return "collision" if "collision" in has else "visual"


def refuse_other_geometry(kinds: Kinds, geometry: Geometry) -> None:
    """Raises `NothingToMeasure` if all shapes are of the kind that is not asked for."""
    if geometry == "collision_or_visual" or any(geometry in has for has in kinds.values()):
        return
    other = _OTHER[geometry]
    n_other = sum(other in has for has in kinds.values())
    if n_other:
        have = counted(n_other, "link has", "links have")
        raise NothingToMeasure(
            f"no link has a {geometry} shape, {have} a {other} shape",
            valid=f"give robot: {{geometry: {other}}}",
        )


def unseen(kinds: Kinds, geometry: Geometry) -> list[Notice]:
    """A warning on links that have a shape but are not measured, since it is of the other kind."""
    if geometry == "collision_or_visual":
        return []
    other = _OTHER[geometry]
    names = [repr(name) for name, has in kinds.items() if geometry not in has and other in has]
    remedy = "; robot: {geometry: collision_or_visual} measures them" if other == "visual" else ""
    lines = naming(without_shape(len(names), other, geometry), names)
    return [Notice(Severity.WARNING, "geometry", line + remedy) for line in lines]


def without_shape(n_links: int, has: str, lacks: str) -> str:
    """What is said of links that have shapes of one kind and not of the other."""
    have, are = ("1 link has", "is") if n_links == 1 else (f"{n_links} links have", "are")
    return f"{have} a {has} but no {lacks} shape and {are} not measured"


def notes_on_bare(kinds: Kinds) -> list[str]:
    """A note on links without any shape, which are frames."""
    bare = [name for name, has in kinds.items() if not has]
    return naming(f"{counted(len(bare), 'link')} without any shape", bare)


def plane_from_box() -> np.ndarray:
    """(4, 4) [m] the pose of the box on a plane, the z axis of which is its normal."""
    pose = np.eye(4)
    pose[2, 3] = -0.5 * PLANE_SIZE[2]
    return pose


def note_on_planes(names: Sequence[str]) -> list[str]:
    """A note on the boxes that stand for planes."""
    size = f"{PLANE_SIZE[0]:g} m wide and {PLANE_SIZE[2]:g} m deep"
    return naming(f"planes are boxes {size} below them", [*map(repr, names)])
