"""SRDF, MoveIt's file of which links of a robot may touch, to a `CollisionMatrix`; and its named states, or
those of the robot's own file, to positions of its joints.

A planar or floating virtual joint is the place of the base. Groups and end effectors are passed over. Not for:
what an excuse is worth.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clearance.errors import (
    BadRobot,
    BadSyntax,
    DuplicateName,
    MissingKey,
    UnknownState,
    at,
    nearest_name,
)
from clearance.formats.files.input_files import InputFiles
from clearance.formats.text.notes import counted
from clearance.formats.text.numbers import finite_numbers
from clearance.formats.text.unread import Format, Row, unread
from clearance.formats.text.xml_document import robot_element
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import of_unit_length
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.names import checked_name
from clearance.world.notice import listed, naming
from clearance.world.robot import Robot

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

REASONS = ("Adjacent", "Default", "Always", "Never", "User")
"""A text that begins with one of these, in any letters, stands for it; any other for `User`, as in MoveIt."""

_ENDS = {
    "disable_default_collisions": ("link",),
    "enable_collisions": ("link1", "link2"),
    "disable_collisions": ("link1", "link2"),
}
"""The rows that are read, and the attributes that name their links."""


_PAIR = Row("", "link1 link2 reason", closed=True)

_SRDF = Format(
    {
        "robot": Row(
            "disable_default_collisions enable_collisions disable_collisions group_state",
            "name version",
            "group end_effector virtual_joint passive_joint joint_property link_sphere_approximation "
            "gripper handle contact rotor_params",
        ),
        "disable_default_collisions": Row("", "link", closed=True),
        "enable_collisions": _PAIR,
        "disable_collisions": _PAIR,
        "group_state": Row("joint", "name group"),
        "joint": Row("", "name value", closed=True),
    },
    fault=BadRobot,
)
"""Names that are passed over: MoveIt's, pinocchio's and hpp's."""


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
        unknown = frozenset(link for row in rows for link in row.links) - {*robot.link_names}
        known = [row for row in rows if unknown.isdisjoint(row.links)]
        if rows and not known:
            raise BadRobot(
                f"none of its {len(rows)} rows speaks of links of robot {robot.name!r}: "
                f"it is the SRDF of {root.get('name') or 'another robot'!r}",
                valid=nearest_name(sorted(unknown)[0], robot.link_names),
            )
    said = [row for row in known if not row.is_of_one]
    of = root.get("name") or robot.name
    return CollisionMatrix(
        tuple(row.links[0] for row in said if row.tag == "disable_default_collisions"),
        tuple(_pair(row) for row in said if row.tag == "enable_collisions"),
        tuple((*_pair(row), row.reason) for row in said if row.tag == "disable_collisions"),
        tuple(f"{shown}: {note}" for note in _notes(len(rows) - len(known), unknown, known)),
        "" if of == robot.name else of,
    )


def srdf_root(path: Path, files: InputFiles) -> Element:
    """The root element of an SRDF file.

    Raises:
        BadSyntax: no SRDF. BadRobot: a name that resembles one that is read; an attribute that rows do not have.
    """
    root = robot_element(files.read(path), "an SRDF file")
    if root.find("link") is not None and root.find("joint/parent") is not None:
        raise BadSyntax("this is a URDF file", valid="an SRDF file is needed")
    list(unread(root, _SRDF))  # raises; other names are for other programs
    return root


class _Row:
    """One element that speaks of links."""

    def __init__(self, element: Element) -> None:
        self.tag = str(element.tag)
        self.links = [_named(element, attribute) for attribute in _ENDS[self.tag]]
        self.given = (element.get("reason") or "").strip()
        meant = [one for one in REASONS if self.given.casefold().startswith(one.casefold())]
        self.is_known = bool(meant) or not self.given
        self.reason = meant[0] if meant else "User"

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


def _pair(row: _Row) -> tuple[str, str]:
    return row.links[0], row.links[1]


def _notes(n_left_out: int, unknown: frozenset[str], known: Sequence[_Row]) -> Iterator[str]:
    """On rows that are left out, and on reasons of pairs that MoveIt does not have."""
    n_of_one = sum(row.is_of_one for row in known)
    if n_of_one:
        several = "rows pair links with themselves and are"
        yield f"{counted(n_of_one, 'row pairs a link with itself and is', several)} left out"
    if n_left_out:
        text = f"{n_left_out} rows name links that the robot does not have and are left out"
        yield from naming(text, sorted(unknown))
    odd = [repr(row.given) for row in known if not row.is_known and not row.is_of_one]
    one = "reason is none of MoveIt's and counts as User"
    several = "reasons are none of MoveIt's and count as User"
    yield from naming(counted(len(odd), one, several), dict.fromkeys(odd))


class GroupState(NamedTuple):
    """Positions [rad] or [m] that a group of joints has by name; a joint of several freedoms has several.

    Attributes:
        group: empty where the file names none, as files that are not for MoveIt do.
    """

    group: str
    name: str
    positions: dict[str, tuple[float, ...]]

    @property
    def full_name(self) -> str:
        """Its name with that of the group."""
        return f"{self.group}/{self.name}" if self.group else self.name


class StatePositions(NamedTuple):
    """Positions by moving joint of a robot, and a line each on what was left out."""

    positions: dict[str, float]
    notes: tuple[str, ...]


class NamedStates(NamedTuple):
    """The states that a file names, and how that file is shown."""

    shown: str
    states: list[GroupState]


def states_known(
    srdf: Path | None, robot: Robot, robot_file: Path, files: InputFiles
) -> NamedStates:
    """The states of an SRDF file; without one, those that the robot's own file names.

    Raises:
        BadInput: with the file and the element.
    """
    if srdf is None:
        states = [
            GroupState("", name, {joint: (value,) for joint, value in positions.items()})
            for name, positions in robot.states.items()
        ]
        return NamedStates(files.shown(robot_file), states)
    shown = files.shown(srdf)
    with at(shown):
        return NamedStates(shown, read_states(srdf, files))


def positions_in_states(known: NamedStates, names: Sequence[str], robot: Robot) -> StatePositions:
    """The positions that states give to joints of the robot; those it cannot set are left out.

    Args:
        names: of states, or group/state.

    Raises:
        UnknownState: no such state, or of several groups. BadInput: two that give one joint another position, or
        one that speaks of no joint of the robot; with the file.
    """
    shown = known.shown
    with at(shown):
        asked = [_chosen(name, known.states) for name in names]
        positions: dict[str, float] = {}
        for state in asked:
            _take(positions, state, robot)
    states_text = [state.full_name for state in asked]
    unsettable = [name for state in asked for name in state.positions if name not in positions]
    text = f"{shown}: of state {listed(states_text)}, joints that cannot be set are left out"
    return StatePositions(positions, tuple(naming(text, unsettable, 8)))


def bases_in_states(
    known: NamedStates, names: Sequence[str], robot: Robot
) -> dict[str, np.ndarray]:
    """(4, 4) [m] where states put the robot's base, by the virtual joint that does.

    Raises:
        UnknownState: as `positions_in_states`. BadInput: two that put it at different places, or no pose.
    """
    own = {joint.name.partition("/")[0] for joint in robot.joints}
    bases: dict[str, np.ndarray] = {}
    with at(known.shown):
        for state in (_chosen(name, known.states) for name in names):
            for joint, values in state.positions.items():
                if joint in own or len(values) not in (3, 7):
                    continue
                with at(f"state {state.full_name!r}: joint {joint!r}"):
                    pose = _base(values)
                    if not np.array_equal(bases.setdefault(joint, pose), pose):
                        raise BadRobot(
                            "it puts the robot's base elsewhere than a state before",
                            valid="one place; a base that moves is a planar or floating joint of the URDF",
                        )
    return bases


def _base(values: Sequence[float]) -> np.ndarray:
    """(4, 4) [m] of a planar joint (x, y, theta) or a floating one (x, y, z and a quaternion xyzw).

    Source: MoveIt 2, planar_joint_model and floating_joint_model.
    """
    if len(values) == 3:
        return pose_from_rpy([*values[:2], 0.0], [0.0, 0.0, values[2]])
    return pose_from_quaternion(values[:3], of_unit_length(np.array([values[3:]]))[0][0])


def virtual_joints(path: Path, files: InputFiles) -> list[str]:
    """The planar and floating virtual joints of an SRDF file: they say that the robot's base moves.

    Raises:
        BadInput: as `srdf_root`.
    """
    with at(files.shown(path)):
        found = srdf_root(path, files).iterfind("virtual_joint")
        return [_named(one, "name") for one in found if one.get("type") in ("planar", "floating")]


def read_states(path: Path, files: InputFiles) -> list[GroupState]:
    """All states in an SRDF file, in its order.

    Raises:
        BadInput: with the element.
    """
    states = []
    for i, element in enumerate(srdf_root(path, files).iterfind("group_state")):
        with at(f"group_state[{i}]"):
            states.append(_state(element))
    return states


def _state(element: Element) -> GroupState:
    positions: dict[str, tuple[float, ...]] = {}
    for joint in element.iterfind("joint"):
        name = _named(joint, "name")
        if name in positions:
            raise DuplicateName(f"joint {name!r} is there twice", valid="each joint once")
        with at(f"joint {name!r}"):
            given = joint.get("value")
            positions[name] = finite_numbers(given or "", f"value={given!r:.60} is given")
    group = checked_name(element.get("group") or "")
    return GroupState(group, _named(element, "name"), positions)


def _named(element: Element, attribute: str) -> str:
    name = element.get(attribute)
    if not name:
        raise MissingKey(f"<{element.tag}> has no {attribute}", valid=f'{attribute}="…"')
    return checked_name(name)


def _chosen(name: str, states: Sequence[GroupState]) -> GroupState:
    found = [state for state in states if name in (state.full_name, state.name)]
    exact = [state for state in found if state.full_name == name] or found
    if len(exact) == 1:
        return exact[0]
    if not exact:
        raise UnknownState(
            f"unknown state {name!r}",
            valid=nearest_name(name, names_of(states)) if states else "it has none",
        )
    groups = [state.full_name for state in exact]
    raise UnknownState(
        f"there are {len(exact)} states {name!r}", valid=f"one of {listed(groups, 8)}"
    )


def names_of(states: Sequence[GroupState]) -> list[str]:
    """As each can be asked for; without the group where no other has the name."""
    alone = [state.name for state in states]
    return [state.name if alone.count(state.name) == 1 else state.full_name for state in states]


def _take(positions: dict[str, float], state: GroupState, robot: Robot) -> None:
    """Adds what a state gives to joints that can be set."""
    moving = {joint.name for joint in robot.moving_joints}
    own = {
        name: values[0]
        for name, values in state.positions.items()
        if name in moving and len(values) == 1
    }
    if not own:
        raise BadRobot(
            f"state {state.full_name!r} speaks of no joint that robot {robot.name!r} can move",
            valid=nearest_name(next(iter(state.positions), ""), moving),
        )
    for name, position in own.items():
        if positions.setdefault(name, position) != position:
            raise BadRobot(
                f"joint {name!r} is at {positions[name]:g} in a state before "
                f"and at {position:g} in {state.full_name!r}",
                valid="states of other groups",
            )
