"""The legs of a program: each move, lines cut where corner zones begin, and the corners between; how fast each
begins and ends. Not for: joints (`motion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import BadProgram, UnknownJoint, at, nearest_name
from clearance.programs.arm import Arm
from clearance.programs.moves import JointMove, Move, PathMove, Program, Wait
from clearance.programs.time_law import Piece, trapezoid
from clearance.programs.tool_path import Stretch, arc, line

SHARE_OF_LINE = 0.5
"""Of a line that a corner zone may take at either end."""

RUN_UP = 0.25
"""[s] In which a tool that turns on the spot reaches its speed."""

LONGEST = 100.0
"""[m] A longer way is a mistake."""

SHORTEST = 1e-9
"""[m] and [rad] A line that is shorter, and turns less, is none."""


@dataclass(frozen=True, eq=False)
class Leg:
    """A move, or a part of one, or the corner after it.

    Attributes:
        stretch: what the tool follows; None where joints are told. pieces: how fast.
        radius: [m] of the corner zone that it is; 0 where it is none.
    """

    move: Move
    stretch: Stretch | None = None
    pieces: tuple[Piece, ...] = ()
    radius: float = 0.0


def legs_of(arm: Arm, program: Program, start: np.ndarray) -> list[Leg]:
    """All legs in order.

    Args:
        start: (k,) the joints at the beginning [rad or m].

    Raises:
        BadInput: an arc that is none, a zone without a next line; with the move.
    """
    stretches = _stretches(arm, program, start)
    radii = _radii(program.moves, stretches)
    found: list[Leg] = []
    run: list[Leg] = []
    for i, (move, stretch) in enumerate(zip(program.moves, stretches, strict=True)):
        if stretch is None:
            found.append(Leg(move))
            continue
        if _is_none(stretch):
            continue
        before = radii[i - 1] / stretch.length if i and radii[i - 1] else 0.0
        after = radii[i] / stretch.length if radii[i] else 0.0
        run.append(Leg(move, _part(stretch, before, 1.0 - after)))
        if radii[i]:
            following = stretches[i + 1]
            assert following is not None
            run.append(Leg(move, _corner(stretch, following, radii[i]), radius=radii[i]))
            continue
        found += _with_speeds(run)
        run = []
    return found


def _stretches(arm: Arm, program: Program, start: np.ndarray) -> list[Stretch | None]:
    """What the tool follows in each move; None where joints are told or nothing moves."""
    pose, found = arm.poses(start[None])[0], list[Stretch | None]()
    for move in program.moves:
        with at(move.where):
            if isinstance(move, PathMove):
                found.append(own := _stretch(pose, move))
                if not own.length <= LONGEST:
                    raise BadProgram(f"a way of {own.length:.3g} m", valid=f"{LONGEST:g} m or less")
                if not _is_none(own):
                    pose = own.poses(np.array([[1.0, 0.0]]))[0]
                continue
            found.append(None)
            if isinstance(move, JointMove):
                pose = (
                    move.pose
                    if move.pose is not None
                    else arm.poses(targets_of(arm, move)[None])[0]
                )
    return found


def _is_none(stretch: Stretch) -> bool:
    """True where the tool stays: the next stretch begins where this one does."""
    return stretch.length < SHORTEST and stretch.turned < SHORTEST


def targets_of(arm: Arm, move: JointMove) -> np.ndarray:
    """(k,) the joints that a move names.

    Raises:
        BadInput: not each joint of the arm, or another.
    """
    names, given = [joint.name for joint in arm.joints], move.joints or {}
    for name in given:
        if name not in names:
            raise UnknownJoint(
                f"unknown joint {name!r}", where="joints", valid=nearest_name(name, names)
            )
    missing = [name for name in names if name not in given]
    if missing:
        told = f"no target of {', '.join(missing)}"
        raise BadProgram(told, where="joints", valid="one for each joint of the arm")
    return np.array([given[name] for name in names])


def _stretch(start: np.ndarray, move: PathMove) -> Stretch:
    end = move.pose
    if move.keeps_orientation:
        end = end.copy()
        end[:3, :3] = start[:3, :3]
    if move.via is None:
        return line(start, end)
    return arc(start, move.via, end, move.along)


def _radii(moves: Sequence[Move], stretches: Sequence[Stretch | None]) -> list[float]:
    """[m] The radius of the corner zone at the end of each move: 0 where it stops there."""
    found = []
    for i, (move, own) in enumerate(zip(moves, stretches, strict=True)):
        radius = 0.0 if isinstance(move, Wait) else move.zone
        if radius:
            other = stretches[i + 1] if i + 1 < len(moves) else None
            if other is None or other.arc is not None or own is None or own.arc is not None:
                with at(move.where):
                    raise BadProgram(
                        "a corner zone that is not between two lines",
                        where="zone",
                        valid="0, or a lin move before and after it",
                    )
            if min(own.length, other.length) < SHORTEST:
                with at(move.where):
                    raise BadProgram(
                        "a corner zone beside a line of no length",
                        where="zone",
                        valid="0, or lines that the tool's point goes along",
                    )
            radius = min(radius, SHARE_OF_LINE * own.length, SHARE_OF_LINE * other.length)
        found.append(radius if radius > SHORTEST else 0.0)
    return found


def _part(stretch: Stretch, start: float, end: float) -> Stretch:
    """A part of a line or an arc, by shares; the whole of it as it is."""
    if (start, end) == (0.0, 1.0):
        return stretch
    first = stretch.poses(np.array([[start, 0.0]]))[0]
    return replace(
        stretch, start=first, ways=(end - start) * stretch.ways, turns=(end - start) * stretch.turns
    )


def _corner(before: Stretch, after: Stretch, radius: float) -> Stretch:
    """The parabola of a corner zone between two lines."""
    into, out = radius / before.length, radius / after.length
    entry = before.poses(np.array([[1.0 - into, 0.0]]))[0]
    ways = np.array([into * before.ways[0], out * after.ways[0]])
    return Stretch(
        entry, ways, np.array([into * before.turns[0], out * after.turns[0]]), is_corner=True
    )


def _with_speeds(run: list[Leg]) -> Iterator[Leg]:
    """Legs that follow one another without a stop, with the pieces of their speed."""
    speeds = _speeds_at_ends(run)
    for leg, first, last in zip(run, speeds, speeds[1:], strict=False):
        move, stretch = leg.move, leg.stretch
        assert isinstance(move, PathMove) and stretch is not None
        if _is_none(stretch):
            continue
        if leg.radius:
            rate = first / (2.0 * leg.radius)
            yield replace(leg, pieces=(Piece(1.0 / rate, 0.0, rate, 0.0),))
            continue
        size, most, change = _size_of(move, stretch)
        yield replace(
            leg, pieces=tuple(trapezoid(most / size, change / size, first / size, last / size))
        )


def _size_of(move: PathMove, stretch: Stretch) -> tuple[float, float, float]:
    """The length of a stretch [m], its greatest speed [m/s], and acceleration [m/s^2]; of a turn on the spot in
    rad."""
    if stretch.length < SHORTEST:
        return stretch.turned, move.turn_speed, move.turn_speed / RUN_UP
    return stretch.length, _speed(move, stretch.length, stretch.turned), move.acceleration


def _speed(move: PathMove, length: float, turned: float) -> float:
    """[m/s] The greatest speed on a way of a length [m] with a turn [rad]."""
    return min(move.speed, move.turn_speed * length / max(turned, 1e-300))


def _speeds_at_ends(run: Sequence[Leg]) -> list[float]:
    """[m/s] The tool's speed at the beginning of each leg and at the end of the last: 0 where it stops."""
    most = [0.0] * (len(run) + 1)
    for i, leg in enumerate(run):
        if leg.radius:
            most[i] = most[i + 1] = _speed_in_corner(run[i - 1], leg, run[i + 1])
    for i in (*range(len(run)), *reversed(range(len(run)))):
        leg, stretch = run[i], run[i].stretch
        assert stretch is not None
        if leg.radius:
            most[i] = most[i + 1] = min(most[i], most[i + 1])
            continue
        assert isinstance(leg.move, PathMove)
        gained = 2.0 * leg.move.acceleration * stretch.length
        most[i + 1] = min(most[i + 1], float(np.sqrt(most[i] ** 2 + gained)))
        most[i] = min(most[i], float(np.sqrt(most[i + 1] ** 2 + gained)))
    return most


def _speed_in_corner(before: Leg, corner: Leg, after: Leg) -> float:
    """[m/s] The lesser of both lines' speeds, and less where the parabola would take more than the
    acceleration."""
    assert isinstance(before.move, PathMove) and isinstance(after.move, PathMove)
    assert corner.stretch is not None
    turned = np.linalg.norm(corner.stretch.turns, axis=1)
    bend = float(np.linalg.norm(corner.stretch.ways[1] - corner.stretch.ways[0]))
    acceleration = min(before.move.acceleration, after.move.acceleration)
    bent = corner.radius * float(np.sqrt(2.0 * acceleration / max(bend, 1e-12)))
    moves = before.move, after.move
    speeds = (_speed(move, corner.radius, by) for move, by in zip(moves, turned, strict=True))
    return float(min(*speeds, bent))
