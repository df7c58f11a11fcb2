"""A robot program in a case: its frames are found in the cell, and its moves become a trajectory.

Not for: how joints follow (room `programs`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from clearance.case.driven_robots import ProgramCell, ProgrammedMotion, Surroundings
from clearance.case.places import IN_WORLD, NOT_PLACED, NotThere, Place, Places
from clearance.errors import BadProgram, ClearanceError, UnknownPlace, at, nearest_name
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Format, Kind, format_of, function_at, suffixes_read
from clearance.formats.plausibility import odd_in_program
from clearance.formats.program.controller_program import ProgramRequest
from clearance.formats.program.conversion import ConvertedProgram, converted
from clearance.formats.program.given import used
from clearance.formats.schema import program as schema
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.timed import TrajectoryFile
from clearance.geometry.pose import inverse
from clearance.programs.carriage import Carriage
from clearance.programs.joint_way import unknown_speeds
from clearance.programs.motion import motion_of
from clearance.programs.moves import JointMove, Move, PathMove, Program, ToolChange, Wait
from clearance.programs.time_law import Limits
from clearance.world.notice import listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import Timing


def program_motion(
    asked: TrajectoryFile,
    start: Mapping[str, float],
    placed: PlacedRobot,
    files: InputFiles,
    around: Surroundings,
) -> ProgrammedMotion:
    """The motion of a program that a case names or holds.

    Args:
        start: joints at its beginning that the case gives [rad or m]. around: all but the robot.

    Raises:
        BadInput: with the place in the file.
    """
    cell = ProgramCell(placed, around)
    if asked.program_file is None:
        assert isinstance(asked.program, schema.Program)
        shown, read = "program", _of_schema(asked.program)
    else:
        shown, read = _read(asked.program_file, cell, start, files)
    given = read.program
    odd = odd_in_program(asked.program_file, read.own)
    with at(shown), _suspecting(odd):
        driven = cell.driven(given)
        own = {**cell.start(driven), **given.start, **start}
        frames = _Frames(given, cell, cell.places(driven))
        moves = tuple(_moves(read, frames))
        carriages = frames.carriages(asked.timing)
        program = Program(
            *(given.tool.link, given.tool.matrix(), moves, own, given.step),
            carriages=carriages,
            skips_overlaps=read.skips_overlaps,
        )
        found = motion_of(cell.robot, program)
    unknown = unknown_speeds(cell.robot, program)
    lacking = [f"the greatest speed of {listed(unknown)}, which no file says"] * bool(unknown)
    made = replace(
        found.trajectory,
        rides=tuple(carriages),
        frames=tuple(sorted(frames.used | (cell.mounts(driven) if driven else set()))),
        has_way_in=read.starts_anywhere,
        is_rough=read.is_rough,
        left_out=(*read.left_out, *lacking),
        contradicted=tuple(f"{shown}: {one}" for one in read.contradicted),
        assumed=tuple(f"{shown}: {one}" for one in (*read.assumed, *found.doubtful)),
        odd=tuple(f"{shown}: {one}" for one in odd),
    )
    moved = (f"it moves robot {name!r} too" for name in driven)
    notes = tuple(f"{shown}: {note}" for note in (*read.notes, *moved, *found.notes))
    trajectory, others = cell.parted(made, driven, given)
    return ProgrammedMotion(trajectory, notes, others)


@contextmanager
def _suspecting(odd: Sequence[str]) -> Iterator[None]:
    """Adds to an error values that look like another unit, which may be its cause."""
    try:
        yield
    except ClearanceError as fault:
        fault.valid = "; ".join((fault.valid, *odd)).lstrip("; ")
        raise


def _read(
    asked: ProgramFile, cell: ProgramCell, start: Mapping[str, float], files: InputFiles
) -> tuple[str, ConvertedProgram]:
    """The program in a file, and how the file is called in messages.

    Raises:
        BadInput: as its reader says; a file that is called like no program.
    """
    path = files.resolved(asked.file)
    shown, data = files.shown(path), files.read(path)
    row = format_of(Kind.PROGRAM, shown, data)
    if row is None:
        valid = f"one of {', '.join(suffixes_read(Kind.PROGRAM))}"
        raise BadProgram(f"{shown!r} has no suffix of a robot program", valid=valid)
    others = [*_along(path, row), *map(files.resolved, asked.beside)]
    beside = {files.shown(one): files.read(one) for one in others}
    request = ProgramRequest(data, shown, asked, beside)
    read = function_at(row.read)(request)
    if isinstance(read, schema.Program):
        return shown, _of_schema(read)
    with at(shown), _suspecting(odd_in_program(asked)):
        read = used(request, function_at(row.read), read)
        root = None if cell.own.mount else inverse(cell.own.world_from_base)
        return shown, converted(read, asked, cell.robot, start, root)


def _along(path: Path, row: Format) -> list[Path]:
    """The files of a program's own name that are read along, where they are there."""
    own = [path.with_suffix(suffix) for suffix in row.along]
    return [one for one in own if one.is_file()]


def _of_schema(program: schema.Program) -> ConvertedProgram:
    """A program of ours, its moves by their number."""
    places, names = [], []
    for i, move in enumerate(program.moves):
        (key,) = (key for key in move.keys() if getattr(move, key) is not None)
        places.append(f"moves[{i}]" if key in ("wait", "tool") else f"moves[{i}].{key}")
        path = move.ptp or move.lin or move.circ
        to = None if path is None or path.to is None else path.to.name
        names.append(f"{key.upper()} {i + 1}" + (f" → {to}" if to else ""))
    return ConvertedProgram(program, tuple(places), tuple(names), own=program)


class _Frames:
    """The frames of a program, seen from links of the robot, or from what moves by itself."""

    def __init__(self, given: schema.Program, cell: ProgramCell, places: Places) -> None:
        self._given, self._cell, self._places = given, cell, places
        self._links = {*cell.robot.link_names}
        self._movers = set[str]()
        self.used = set[str]()

    def place(self, name: str, within: tuple[str, ...] = ()) -> Place:
        """Where a frame is: on a link of the robot, its root if that is empty, or on what moves by itself.

        Raises:
            BadInput: a frame on what is not there, moves as no program can follow, or is on itself.
        """
        if name == schema.BASE:
            return Place("", np.eye(4))
        if name in self._given.frames:
            if name in within:
                raise BadProgram(
                    f"{' on '.join((*within, name))}: a ring",
                    where="frames",
                    valid="a frame on the world",
                )
            frame = self._given.frames[name]
            with at(f"frames.{name}"):
                return self.place(frame.on, (*within, name)).on_it(frame.matrix())
        found = IN_WORLD if name == schema.WORLD else self._given_place(name)
        if found.on in self._links:
            return found
        world_from_own = self._cell.world_from_own
        if world_from_own is None:
            mount = self._cell.own.mount
            assert mount is not None
            raise BadProgram(
                f"the robot stands on {mount.on!r}, so the place of {name!r} seen from it may change",
                valid="put frames on base",
            )
        self.used |= self._cell.mounts(())
        if found.on:
            self._movers.add(found.on)
            return found
        return Place("", inverse(world_from_own) @ found.pose)

    def carriages(self, timing: Timing) -> dict[str, Carriage]:
        """The motion of all that moves by itself and carries a frame, by the time of a program with a timing.

        Raises:
            BadInput: the program is gone through again and again.
        """
        if self._movers and timing.after == "loop":
            raise BadProgram(
                f"the program begins again (after: loop), and {min(self._movers)!r} is elsewhere then",
                valid="after: hold, and all rounds in the program",
            )
        root = self._cell.world_from_own
        if root is None:  # then no frame is on what moves
            return {}
        return {
            name: self._places.carriage(name, root).in_time_of(timing)
            for name in sorted(self._movers)
        }

    def _given_place(self, name: str) -> Place:
        """Where something of the case is: in the world, on a link, or on what moves by itself.

        Raises:
            BadInput: it is not there, or moves as no program can follow.
        """
        if name not in self._places.names:
            known = (*self._given.frames, schema.WORLD, schema.BASE, *self._places.names)
            robots = {one.robot.name for one in (self._cell.own, *self._cell.around.robots)}
            fault = f"{name!r} is not there"
            if "/" in name and name.partition("/")[0] not in robots:
                fault += ", or on a robot whose program has a frame on this one"
            raise UnknownPlace(fault, valid=nearest_name(name, known))
        found = self._places.of(name)
        if isinstance(found, str):
            kind = UnknownPlace if isinstance(found, NotThere) else BadProgram
            raise kind(f"no frame can be on {name!r}: it {found}", valid=NOT_PLACED)
        own = name.removeprefix(f"{self._cell.own.robot.name}/")
        if found.on != own or found.on not in self._links:
            self.used.add(name)
        return found

    def target(self, target: schema.Target) -> Place:
        """Where the tool is to be."""
        return self.place(target.frame).on_it(target.matrix())

    def via(self, move: schema.ArcMove) -> np.ndarray:
        """(3,) [m] the point of an arc, on what its end is on.

        Raises:
            BadInput: it is on something else.
        """
        to, via = self.place(move.to.frame), self.place(move.via.frame)
        if to.on != via.on:
            fault = (
                f"frame {move.via.frame!r} does not move as frame {move.to.frame!r} of its end does"
            )
            raise BadProgram(fault, where="via.frame", valid="one and the same frame")
        return np.asarray(via.pose @ np.array([*move.via.xyz, 1.0]))[:3]


def _moves(read: ConvertedProgram, frames: _Frames) -> Iterator[Move]:
    """The moves of a program, each under a name: "LIN 14 → P23"."""
    for move, where, name in zip(read.program.moves, read.places, read.names, strict=True):
        with at(where):
            yield _move(move, frames, where, name)


def _move(move: schema.Move, frames: _Frames, where: str, name: str) -> Move:
    if move.wait is not None:
        return Wait(name, where, move.wait)
    if move.tool is not None:
        return ToolChange(name, where, move.tool.matrix())
    if move.ptp is not None:
        given, to = move.ptp, move.ptp.to
        link, pose = ("", None) if to is None else frames.target(to)
        speed = given.joint_speed
        leading = None if speed is None else Limits(speed, given.joint_acceleration)
        return JointMove(
            *(name, where, given.joints, pose, given.speed, given.time, leading, given.zone),
            *(given.near, given.within, link),
        )
    path = move.circ or move.lin
    assert path is not None
    turns = path.to.turns and not (move.circ is not None and move.circ.orientation == "constant")
    link, pose = frames.target(path.to)
    return PathMove(
        name=name,
        where=where,
        pose=pose,
        keeps_orientation=not turns,
        via=None if move.circ is None else frames.via(move.circ),
        along=move.circ is not None and move.circ.orientation == "tangent",
        speed=path.speed,
        acceleration=path.acceleration,
        turn_speed=path.turn_speed,
        time=path.time,
        zone=path.zone,
        hold=dict(path.hold),
        free=path.free,
        seen_from=link,
    )
