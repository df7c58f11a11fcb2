"""What a program asks of a tool: moves one after another, their targets seen from the robot's root.

Not for: files (`formats`), how joints follow (`motion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class JointMove:
    """All joints go straight to their targets, begin together and end together (PTP, movej, MoveJ).

    Attributes:
        name: what the report calls it. where: in which file and field.
        joints: targets by name [rad or m]; None where `pose` is given. pose: (4, 4) of the tool [m].
        speed: share of the joints' greatest speeds. acceleration: [1/s^2] of the share of the way; None for the
            default. zone: [m] radius of the corner zone at its end.
        near: joints to which those for the pose are nearest; those that are not named are where they are.
        within: from where to where joints for the pose may be, by name.
    """

    name: str
    where: str
    joints: dict[str, float] | None = None
    pose: np.ndarray | None = None
    speed: float = 1.0
    zone: float = 0.0
    near: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, Sequence[float]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PathMove:
    """The tool's point goes along a straight line, or an arc, to a pose.

    Attributes:
        name: what the report calls it. where: in which file and field. pose: (4, 4) [m].
        via: (3,) a point of the arc [m]; None for a line. along: on an arc, the orientation stays the same to the
            path.
        keeps_orientation: the tool is not turned, whatever the pose says.
        speed: [m/s]. acceleration: [m/s^2]. turn_speed: [rad/s]. zone: [m] radius of the corner zone at its end.
        hold: joints that go straight to these values meanwhile [rad or m], by name.
    """

    name: str
    where: str
    pose: np.ndarray
    via: np.ndarray | None = None
    keeps_orientation: bool = False
    along: bool = False
    speed: float = 0.25
    acceleration: float = 1.0
    turn_speed: float = 1.0
    zone: float = 0.0
    hold: dict[str, float] | None = None


@dataclass(frozen=True, eq=False)
class Wait:
    """Nothing moves for some time [s]."""

    name: str
    where: str
    seconds: float


@dataclass(frozen=True, eq=False)
class ToolChange:
    """Another tool from here on: (4, 4) `link_from_tool` [m]."""

    name: str
    where: str
    link_from_tool: np.ndarray


Move = JointMove | PathMove | Wait | ToolChange


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of one tool.

    Attributes:
        link: the tool is fixed to. link_from_tool: (4, 4) [m]. moves: in order.
        start: the joints at its beginning by name [rad or m]; joints that are not named stay where the case has
            them.
        step: [m] the most that the tool moves from sample to sample; it turns by at most `STEP_TURN`.
    """

    link: str
    link_from_tool: np.ndarray
    moves: tuple[Move, ...]
    start: dict[str, float]
    step: float = 0.002

    @property
    def parts(self) -> Iterator[Program]:
        """Its moves with one tool after the other."""
        tool, moves = self.link_from_tool, list[Move]()
        for one in self.moves:
            if isinstance(one, ToolChange):
                yield replace(self, link_from_tool=tool, moves=tuple(moves))
                tool, moves = one.link_from_tool, []
            else:
                moves.append(one)
        yield replace(self, link_from_tool=tool, moves=tuple(moves))


SHARE_OF_WAY = 0.5
"""Of a move that a corner zone may take at either end."""

STEP_TURN = np.radians(1.0)
"""[rad] The most that a tool turns from sample to sample."""
