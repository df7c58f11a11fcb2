"""What a program asks of a tool: moves one after another, their targets seen from links of the robot.

Not for: files (`formats`), how joints follow (`motion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest

import numpy as np

from clearance.errors import BadProgram, at
from clearance.programs.carriage import Carriage
from clearance.programs.time_law import Limits


@dataclass(frozen=True, eq=False)
class JointMove:
    """All joints go straight to their targets, begin together and end together (PTP, movej, MoveJ).

    Attributes:
        name: what the report calls it. where: in which file and field.
        joints: targets by name [rad or m]; None where `pose` is given. pose: (4, 4) of the tool [m].
        speed: share of the joints' greatest speeds. zone: [m] radius of the corner zone at its end.
        time: [s] from standstill to standstill, whatever the speed; None if no time is asked for.
        leading: the speed of the joint that goes farthest, and its acceleration [rad/s] and [rad/s^2]; None if
            `speed` says it.
        seen_from: the link, or the carriage, that the pose is seen from; the root if empty. By a carriage it is
            where that is when the joints arrive.
        near: joints to which those for the pose are nearest; those that are not named are where they are.
        within: from where to where joints for the pose may be, by name: one range or several.
    """

    name: str
    where: str
    joints: dict[str, float] | None = None
    pose: np.ndarray | None = None
    speed: float = 1.0
    time: float | None = None
    leading: Limits | None = None
    zone: float = 0.0
    near: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, Sequence[float] | Sequence[Sequence[float]]] = field(default_factory=dict)
    seen_from: str = ""


@dataclass(frozen=True, eq=False)
class PathMove:
    """The tool's point goes along a straight line, or an arc, to a pose.

    Attributes:
        name: what the report calls it. where: in which file and field. pose: (4, 4) [m].
        via: (3,) a point of the arc [m]; None for a line. along: on an arc, the orientation stays the same to the
            path.
        keeps_orientation: the tool is not turned, whatever the pose says.
        speed: [m/s]. acceleration: [m/s^2]. turn_speed: [rad/s]. zone: [m] radius of the corner zone at its end.
        time: as of a joint move, whatever the speeds.
        hold: joints that go straight to these values meanwhile [rad or m], by name.
        free: joints beside the arm that follow the path too.
        seen_from: the link, or the carriage, that the pose and the point are seen from; the root if empty.
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
    time: float | None = None
    zone: float = 0.0
    hold: dict[str, float] | None = None
    free: Sequence[str] = ()
    seen_from: str = ""


@dataclass(frozen=True, eq=False)
class Wait:
    """Nothing moves for some time [s]; seen from a carriage, where the tool stays on it."""

    name: str
    where: str
    seconds: float
    seen_from: str = ""


@dataclass(frozen=True, eq=False)
class ToolChange:
    """Another tool from here on: (4, 4) `link_from_tool` [m]."""

    name: str
    where: str
    link_from_tool: np.ndarray


Move = JointMove | PathMove | Wait | ToolChange

Run = list[Move]
"""Moves that follow one another without a stop."""


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of one tool.

    Attributes:
        link: the tool is fixed to. link_from_tool: (4, 4) [m]. moves: in order.
        start: the joints at its beginning by name [rad or m]; joints that are not named stay where the case has
            them.
        step: [m] the most that the tool moves from sample to sample; it turns by at most `STEP_TURN`.
        seen_from: the link, or the carriage, that its targets are seen from, which may differ from move to move
            until `parts` are taken; the root if empty.
        carriages: what moves by itself and carries frames, by name.
        skips_overlaps: its controller skips a move where two corner zones overlap, and cuts none to half.
    """

    link: str
    link_from_tool: np.ndarray
    moves: tuple[Move, ...]
    start: dict[str, float]
    step: float = 0.002
    seen_from: str = ""
    carriages: Mapping[str, Carriage] = field(default_factory=dict)
    skips_overlaps: bool = False

    @property
    def named(self) -> frozenset[str]:
        """The joints that its moves name."""
        named = set[str]()
        for one in self.moves:
            if isinstance(one, JointMove):
                named |= {*(one.joints or {}), *one.near, *one.within}
            elif isinstance(one, PathMove):
                named |= {*(one.hold or {}), *one.free}
        return frozenset(named)

    def carriage_of(self, run: Run) -> Carriage | None:
        """What carries the targets of a run by itself."""
        targets = (one.seen_from for one in run if isinstance(one, JointMove | PathMove))
        return next((self.carriages[one] for one in targets if one in self.carriages), None)

    @property
    def parts(self) -> Iterator[Program]:
        """Its moves with one tool, and seen from one link, after the other.

        Raises:
            BadInput: a corner zone between moves that are seen from different links.
        """
        part = replace(self, moves=())
        for run in self.runs:
            if isinstance(run[0], ToolChange):
                yield part
                part = replace(part, link_from_tool=run[0].link_from_tool, moves=())
                continue
            seen_from = _seen_from(run, part.seen_from)
            if seen_from != part.seen_from:
                yield part
                part = replace(part, seen_from=seen_from, moves=())
            part = replace(part, moves=(*part.moves, *run))
        yield part

    @property
    def runs(self) -> Iterator[Run]:
        """Its moves, in rows that follow one another without a stop.

        Raises:
            BadInput: a corner zone without a next move; with the move.
        """
        run: Run = []
        for one, following in zip_longest(self.moves, self.moves[1:]):
            run.append(one)
            if not has_zone(one):
                yield run
                run = []
            elif not isinstance(following, JointMove | PathMove):
                with at(one.where):
                    fault = "a corner zone without a move after it"
                    raise BadProgram(fault, where="zone", valid="write zone: 0, or a move after it")


SHORTEST = 1e-9
"""[m], [rad] and [s] A zone that is smaller is none, and a move that goes, turns and takes less."""


def has_zone(move: Move) -> bool:
    """True where it is not to stop at its end."""
    return isinstance(move, JointMove | PathMove) and move.zone > SHORTEST


def _seen_from(run: Run, before: str) -> str:
    """What the targets of a run are seen from; the one before where it has none.

    Raises:
        BadInput: there are two.
    """
    found: str | None = None
    for i, one in enumerate(run):
        if not (isinstance(one, PathMove) or (isinstance(one, JointMove) and one.pose is not None)):
            continue
        if found not in (None, one.seen_from):
            with at(run[i - 1].where):
                fault = (
                    f"the next target is on {one.seen_from or 'what stands'}, which moves otherwise"
                )
                valid = "write zone: 0 (the tool stops), or targets on one and the same link on both sides"
                raise BadProgram(fault, where="zone", valid=valid)
        found = one.seen_from
    return before if found is None else found


SHARE_OF_WAY = 0.5
"""Of a move that a corner zone may take at either end."""

STEP_TURN = np.radians(1.0)
"""[rad] The most that a tool turns from sample to sample."""
