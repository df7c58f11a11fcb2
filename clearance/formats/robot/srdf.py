"""SRDF, MoveIt's file of which links of a robot may touch, to a `CollisionMatrix`.

Groups, end effectors and virtual joints are passed over. Not for: named states (`srdf_states`), nor what an excuse
is worth.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import BadInput, BadSyntax, MissingKey, at, nearest_name
from clearance.formats.files.input_files import InputFiles
from clearance.formats.robot.robot_element import robot_element
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.names import checked_name
from clearance.world.robot import Robot

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

REASONS = ("Adjacent", "Default", "Always", "Never", "User")
"""Any other text stands for `User`, as in MoveIt."""

_ENDS = {
    "disable_default_collisions": ("link",),
    "enable_collisions": ("link1", "link2"),
    "disable_collisions": ("link1", "link2"),
}
"""The rows that are read, and the attributes that name their links."""


def load_srdf(path: str | Path, robot: Robot) -> CollisionMatrix:
    """The allowed collision matrix in an SRDF file.

    Args:
        robot: whose links it speaks of.

    Raises:
        BadInput: with the file and the element.
    """
    path = Path(path)
    return read_srdf(path, robot, InputFiles(path.parent))


def read_srdf(path: Path, robot: Robot, files: InputFiles) -> CollisionMatrix:
    """The allowed collision matrix in an SRDF file, which is read through `files`.

    Rows of a link that the robot does not have are left out with a note, as MoveIt does; so are those that pair a
    link with itself.

    Raises:
        BadSyntax: no SRDF. MissingKey: a row without a link. BadInput: the file of another robot: none of its rows
            speaks of links of this one.
    """
    shown = files.shown(path)
    with at(shown):
        root = srdf_root(path, files)
        rows = list(_rows(root))
        unknown = _unknown_links(rows, robot)
        known = [row for row in rows if unknown.isdisjoint(row.links)]
        if rows and not known:
            raise BadInput(
                f"none of its {len(rows)} rows speaks of links of robot {robot.name!r}: "
                f"it is the SRDF of {root.get('name') or 'another robot'!r}",
                valid=nearest_name(sorted(unknown)[0], robot.link_names),
            )
    said = [row for row in known if not row.is_of_one]
    return CollisionMatrix(
        tuple(row.links[0] for row in said if row.tag == "disable_default_collisions"),
        tuple(_pair(row) for row in said if row.tag == "enable_collisions"),
        tuple((*_pair(row), row.reason) for row in said if row.tag == "disable_collisions"),
        tuple(_notes(shown, len(rows) - len(known), unknown, len(known) - len(said))),
    )


def srdf_root(path: Path, files: InputFiles) -> Element:
    """The root element of an SRDF file.

    Raises:
        BadSyntax: no SRDF.
    """
    root = robot_element(files.read(path), "an SRDF file")
    if root.find("link") is not None and root.find("joint/parent") is not None:
        raise BadSyntax("this is a URDF file", valid="an SRDF file is needed")
    return root


class _Row:
    """One element that speaks of links."""

    def __init__(self, element: Element) -> None:
        self.tag = str(element.tag)
        self.links = [_link(element, attribute) for attribute in _ENDS[self.tag]]
        given = element.get("reason") or ""
        self.reason = given if given in REASONS else "User"

    @property
    def is_of_one(self) -> bool:
        """True if it pairs a link with itself, which no two links are excused by."""
        return len(self.links) == 2 and self.links[0] == self.links[1]


def _rows(root: Element) -> Iterator[_Row]:
    counted: dict[str, int] = {}
    for element in root:
        tag = str(element.tag)
        if tag not in _ENDS:
            continue
        i = counted[tag] = counted.get(tag, -1) + 1
        with at(f"{tag}[{i}]"):
            yield _Row(element)


def _link(element: Element, attribute: str) -> str:
    name = element.get(attribute)
    if not name:
        raise MissingKey(f"<{element.tag}> has no {attribute}", valid=f'{attribute}="a link"')
    return checked_name(name)


def _pair(row: _Row) -> tuple[str, str]:
    return row.links[0], row.links[1]


def _unknown_links(rows: list[_Row], robot: Robot) -> frozenset[str]:
    return frozenset(link for row in rows for link in row.links) - frozenset(robot.link_names)


def _notes(shown: str, n_left_out: int, unknown: frozenset[str], n_of_one: int) -> Iterator[str]:
    if n_of_one:
        rows = (
            "1 row pairs a link with itself"
            if n_of_one == 1
            else f"{n_of_one} rows pair links with themselves"
        )
        yield f"{shown}: {rows} and {'is' if n_of_one == 1 else 'are'} left out"
    if n_left_out:
        names = sorted(unknown)
        listed = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        yield (
            f"{shown}: {n_left_out} rows name links that the robot does not have and are left out: {listed}"
        )
