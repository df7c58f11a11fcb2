"""A case file, and all files that it names, to a `Case`: the one entry to this room.

Everything is checked here or on the way, so that a `Case` that exists can be run: names refer to
something, numbers are finite, shapes are solids, times increase.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from os import PathLike
from pathlib import Path

from clearance.case.allow import (
    allowances_of,
    body_names,
    carries_of,
    checked_allowances,
    limits_of,
    require_patterns,
)
from clearance.case.case_document import ScenePlace, read_schema
from clearance.case.case_list import refuse_folder
from clearance.case.driven_robots import Surroundings
from clearance.case.motion_notes import note_on_joints_at_zero, notes_on_motion
from clearance.case.packed import refuse_zip, require_entry, unpacked
from clearance.case.reserved import reserved_spaces
from clearance.case.robots import RobotReader, in_motion, robots_in_motion
from clearance.case.scene_rows import with_attached_parts, with_scene_rows
from clearance.case.tolerance.block import budget_of
from clearance.errors import Contradiction, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.plausibility import (
    angle_notices,
    obstacle_notices,
    odd_angles,
    scale_notices,
)
from clearance.formats.robot.compound_joints import require_placed
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import SceneContent
from clearance.formats.schema import case as schema
from clearance.world.case import Case, Clock, SignOff, Source, index_of_robot, require_no_program_on
from clearance.world.clocks import require_clocks
from clearance.world.forest import require_known
from clearance.world.motion import kinematic_motion
from clearance.world.names import checked_name
from clearance.world.notice import Notice
from clearance.world.pairs import nothing_to_measure, selected_pairs
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_rest import notices_on_rest
from clearance.world.rules import Waiver
from clearance.world.timeline import Timeline, timeline_of
from clearance.world.used_rules import require_rules_used


def load_case(path: str | PathLike[str]) -> Case:
    """The case in a YAML file, with robots, scene and trajectories read and checked.

    Args:
        path: the case file, or the zip that it was packed into; the paths in it are relative to its folder.

    Raises:
        BadInput: what was wrong, in which file and field, and what would be valid.
    """
    path = Path(path)
    with unpacked(path) as packed:
        if packed is None:
            return read_case(path, InputFiles(path.parent))
        file = require_entry(packed, "case")
        return packed.checked(read_case(file, InputFiles(file.parent)))


def read_case(path: Path, files: InputFiles) -> Case:
    """The case in a YAML file, which is read through `files` as all that it names.

    Raises:
        BadInput: as `load_case`.
    """
    read = _read(path, schema.Case, files)
    return _finished(read, read.case, files.sources)


def load_cell(path: str | PathLike[str]) -> CellFile:
    """The cell in a case file that may leave out what moves, for `with_trajectory_file`.

    Raises:
        BadInput: as `load_case`.
    """
    path = Path(path)
    refuse_zip(path)
    return _read(path, schema.Cell, InputFiles(path.parent))


def waivers_of_cell(path: str | PathLike[str]) -> tuple[Waiver, ...]:
    """The waivers that the file of a cell names, without reading what is in the cell.

    Raises:
        BadInput: as `load_cell`, of that file and of the waivers.
    """
    path = Path(path)
    files = InputFiles(path.parent)
    if b"waivers" not in files.read(path):
        return ()
    given, _ = read_schema(path, files, schema.Cell)
    with at(path.name):
        return tuple(_waivers(given, files))


def with_trajectory_file(
    cell: CellFile, given: schema.TrajectoryFile, name: str, robot: str | None = None
) -> Case:
    """The case that the cell's file would be with this trajectory in it, under a name of its own.

    Args:
        given: its path as seen from the folder of the cell's file. robot: which moves so; needed where there are
            several.

    Raises:
        BadInput: as `load_case`, or the robot has a trajectory already.
    """
    i_robot = index_of_robot(cell.case.robots, robot)
    require_no_program_on(cell.case, i_robot)
    entry, files = cell.entries[i_robot], InputFiles(cell.files.folder)
    with at(cell.path.name):
        if entry.trajectory is not None:
            raise Contradiction(
                "the cell gives a trajectory to the robot itself",
                where=entry.trajectory_field,
                valid="no trajectory there, or another robot",
            )
        entry = entry._replace(trajectory=given, trajectory_field="trajectory")
        others = [one for i, one in enumerate(cell.case.robots) if i != i_robot]
        driven = (one.trajectory.drives for one in others if one.trajectory is not None)
        around = Surroundings(
            tuple(others),
            cell.case.obstacles,
            cell.case.carries,
            frozenset(chain.from_iterable(driven)),
        )
        moved = in_motion(entry, cell.case.robots[i_robot], files, around)
    robots = tuple(
        moved.placed if i == i_robot
        else moved.driving(one) if one.robot.name in moved.driven else one
        for i, one in enumerate(cell.case.robots)
    )  # fmt: skip
    sources = sorted((*cell.files.sources, *files.sources), key=lambda source: source.path)
    case = replace(cell.case, robots=robots, name=checked_name(name))
    motion_notes = (*cell.motion_notes[:i_robot], moved.notes, *cell.motion_notes[i_robot + 1 :])
    return _finished(replace(cell, motion_notes=motion_notes), case, sources)


@dataclass(frozen=True, eq=False)
class CellFile:
    """A case file as it was read, before anything moves.

    Attributes:
        files: all that were read. entries: the robots as they are written.
        case: without what is told of the motion. notes: on how files were taken. motion_notes: robot by robot, on
            trajectories and the joints that rest. scene_notes: on the scene. scene: what its file says.
    """

    path: Path
    files: InputFiles
    entries: tuple[schema.RobotEntry, ...]
    case: Case
    notes: tuple[str, ...]
    motion_notes: tuple[tuple[str, ...], ...]
    scene_notes: tuple[str, ...]
    scene: SceneContent


def _read(path: Path, model: type[schema.Case], files: InputFiles) -> CellFile:
    refuse_folder(path)
    meshes = MeshStore(files)
    given, scene_at = read_schema(path, files, model)
    entries = given.entries()
    reader = RobotReader(meshes)
    with at(scene_at.place):
        obstacles, scene_notes = make_obstacles(given.scene.obstacles, scene_at.folder, meshes)
    with at(path.name):
        moving = robots_in_motion(reader, entries, given, obstacles)
        case = Case(
            name=given.name or _name_of(path),
            robots=tuple(one.placed for one in moving),
            obstacles=obstacles,
            limits=limits_of(given.limits),
            allow=allowances_of(given.allow),
            contact_response=given.contact_response,
            notices=(*_notices(given), *scene_at.content.notices),
            accept=tuple(given.accept),
            waivers=tuple(_waivers(given, files)),
            sign_off=_sign_off(given.report),
            carries=carries_of(given.carry, [one.name for one in obstacles]),
            clock=Clock(given.clock.slack),
        )
        with at(scene_at.field.rstrip(".: ")):
            case, row_notes = with_scene_rows(case, scene_at.content)
        names = body_names(case)
        case = replace(case, allow=checked_allowances(case.allow, names))
        profiles = reserved_spaces(given.profiles, files, names.table_links)
        _require_mounts(case, entries, scene_at)
        for i, row in enumerate(given.carry):
            with at(f"carry[{i}].touch"):
                require_patterns(row.touch, names)
        if given.tolerance is not None:
            with at("tolerance"):
                budget = budget_of(given.tolerance, case, files)
            case = replace(case, tolerance=budget)
    of_scene = (*scene_at.content.notes, *row_notes, *scene_notes)
    case = replace(case, profiles=profiles)
    return CellFile(
        path=path,
        files=files,
        entries=tuple(entries),
        case=case,
        notes=tuple(reader.notes),
        motion_notes=tuple(one.notes for one in moving),
        scene_notes=of_scene,
        scene=scene_at.content,
    )


def _finished(read: CellFile, case: Case, sources: Sequence[Source]) -> Case:
    """The case, once all that moves is known, with all that is said of it."""
    with at(read.path.name):
        for entry, placed in zip(read.entries, case.robots, strict=True):
            require_placed(placed.robot, _placed_joints(placed), f"{entry.field}.joints")
        case, attached_notes = with_attached_parts(case, read.scene)
        timeline = _run_through(case)
    several = len(case.robots) > 1
    notes = [note for entry, placed in zip(read.entries, case.robots, strict=True)
             for note in _robot_notes(entry, placed, several)]  # fmt: skip
    start, end = timeline.times[[0, -1]].tolist()
    on_motion = notes_on_motion(case, start, end)
    on_robots = [*read.notes, *(note for robot in read.motion_notes for note in robot)]
    every_note = (*notes, *dict.fromkeys(on_robots), *attached_notes, *read.scene_notes, *on_motion)
    return replace(case, sources=tuple(sources), notes=every_note)


def _run_through(case: Case) -> Timeline:
    """The case over time, if it can be run: windows lie in it, rules are of pairs, something is measured."""
    require_clocks(case)
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    selections = [selected_pairs(phase) for phase in timeline.phases]
    if not any(one.pairs for one in selections):
        raise nothing_to_measure()
    pairs = (pair for one in selections for pair in one.pairs)
    require_rules_used(case, pairs, (out for one in selections for out in one.unmeasured))
    return timeline


def _name_of(path: Path) -> str:
    """The name of a case that gives none: its folder's where the file is called case, else the file's."""
    folder = Path(os.path.abspath(path)).parent.name
    return checked_name(folder if path.stem == "case" and folder else path.stem)


def _notices(given: schema.Case) -> list[Notice]:
    """What of the bases and obstacles only the file shows."""
    entries, obstacles = given.entries(), given.scene.obstacles
    files = [(item.name, item.mesh or item.points) for item in obstacles]
    scales = [(name, file.factors) for name, file in files if file is not None]
    bases = [
        odd
        for entry in entries
        for odd in odd_angles(
            "the robot's base" if len(entries) == 1 else f"the base of {entry.field}",
            entry.robot.base.rpy,
        )
    ]
    return [*angle_notices(bases), *obstacle_notices(obstacles), *scale_notices(scales)]


def _require_mounts(case: Case, entries: Sequence[schema.RobotEntry], scene_at: ScenePlace) -> None:
    """Nothing, if what robots and obstacles are on is there."""
    fields = [f"{entry.field}.base.on" for entry in entries]
    fields += [f"{scene_at.field}obstacles[{i}].on" for i in range(len(case.obstacles))]
    mounts = [*(one.mount for one in case.robots), *(one.mount for one in case.obstacles)]
    for field, mount in zip(fields, mounts, strict=True):
        if mount is not None:
            with at(field):
                require_known(case, mount.on)


def _robot_notes(entry: schema.RobotEntry, placed: PlacedRobot, several: bool) -> list[str]:
    """What the file leaves open of a robot, and what was left out of it."""
    notes = []
    if not notices_on_rest(placed):  # which says the same
        given, field = _placed_joints(placed), f"{entry.field}.joints"
        notes = note_on_joints_at_zero(placed.robot, given, field)
    if several:
        notes = [f"robot {placed.robot.name!r}: {note}" for note in notes]
    matrix = placed.self_clearance and placed.self_clearance.matrix
    return [*notes, *(matrix.notes if matrix else ())]


def _placed_joints(placed: PlacedRobot) -> list[str]:
    """The joints that the trajectory moves or the case sets."""
    moved = placed.trajectory.joint_names if placed.trajectory else ()
    return [*moved, *placed.fixed_positions]


def _waivers(given: schema.Case, files: InputFiles) -> Iterator[Waiver]:
    if not given.waivers:
        return
    from clearance.case.waiver_file import waivers_of

    for i, name in enumerate(given.waivers):
        with at(f"waivers[{i}]"):
            yield from waivers_of(files, files.resolved(name))


def _sign_off(given: schema.Report | None) -> SignOff | None:
    return None if given is None else SignOff(given.author or "", given.revision or "")
