"""A case file, and all files that it names, to a `Case`: the one entry to this room.

Everything is checked here or on the way, so that a `Case` that exists can be run: names refer to
something, numbers are finite, shapes are solids, times increase.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from clearance.errors import at
from clearance.load import schema
from clearance.load.allow import body_names, require_allowances, require_patterns
from clearance.load.case_schema import ScenePlace, read_schema
from clearance.load.input_files import InputFiles
from clearance.load.mesh_store import MeshStore
from clearance.load.motion_names import note_on_joints_at_zero
from clearance.load.motion_notes import notes_on_motion
from clearance.load.plausibility import angle_notices, obstacle_notices, odd_angles, scale_notices
from clearance.load.reserved import reserved_spaces
from clearance.load.robots import RobotReader
from clearance.load.rows import allowances_of, carries_of, limits_of
from clearance.load.scene_file import make_obstacles
from clearance.load.scene_rows import with_scene_rows
from clearance.world.case import Case, Clock, PlacedRobot, SignOff
from clearance.world.clocks import require_clocks
from clearance.world.forest import require_known
from clearance.world.motion import kinematic_motion
from clearance.world.names import checked_name
from clearance.world.notice import Notice
from clearance.world.pairs import nothing_to_measure, selected_pairs
from clearance.world.timeline import Timeline, timeline_of
from clearance.world.used_rules import require_rules_used


def load_case(path: str | PathLike[str]) -> Case:
    """The case in a YAML file, with robots, scene and trajectories read and checked.

    Args:
        path: the case file; the paths in it are relative to its folder.

    Raises:
        BadInput: what was wrong, in which file and field, and what would be valid.
    """
    path = Path(path)
    files = InputFiles(path.parent)
    meshes = MeshStore(files)
    given, scene_at = read_schema(path, files)
    entries = given.entries()
    reader = RobotReader(path.parent, meshes)
    with at(path.name):
        robots = tuple(reader.placed(entry) for entry in entries)
    with at(scene_at.place):
        obstacles, scene_notes = make_obstacles(given.scene.obstacles, scene_at.folder, meshes)
    with at(path.name):
        limits = limits_of(given.limits)
        case = Case(
            name=given.name or _name_of(path),
            robots=robots,
            obstacles=obstacles,
            limits=limits,
            allow=allowances_of(given.allow),
            contact_response=given.contact_response,
            notices=(*_notices(given), *scene_at.content.notices),
            accept=tuple(given.accept),
            sign_off=_sign_off(given.report),
            carries=carries_of(given.carry),
            clock=Clock(given.clock.slack),
        )
        case, row_notes = with_scene_rows(case, scene_at.content)
        names = body_names(case)
        require_allowances(case.allow, names)
        profiles = reserved_spaces(given.profiles, path.parent, files, names.table_links)
        _require_mounts(case, entries, scene_at)
        for i, carry in enumerate(case.carries):
            with at(f"carry[{i}].touch"):
                require_patterns(carry.touch, names)
        timeline = _run_through(case)
    notes = [note for entry, placed in zip(entries, robots, strict=True)
             for note in _robot_notes(entry, placed, len(robots) > 1)]  # fmt: skip
    start, end = timeline.times[[0, -1]].tolist()
    return replace(
        case,
        sources=files.sources,
        notes=(
            *notes,
            *dict.fromkeys(reader.notes),
            *scene_at.content.notes,
            *row_notes,
            *scene_notes,
            *notes_on_motion(case, start, end),
        ),
        profiles=profiles,
    )


def _run_through(case: Case) -> Timeline:
    """The case over time, if it can be run: windows lie in it, rules are of pairs, something is measured."""
    require_clocks(case)
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    selections = [selected_pairs(phase) for phase in timeline.phases]
    pairs = dict.fromkeys(pair for one in selections for pair in one.pairs)
    if not pairs:
        raise nothing_to_measure()
    require_rules_used(case, pairs, [out for one in selections for out in one.unmeasured])
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
    for entry, placed in zip(entries, case.robots, strict=True):
        if placed.mount is not None:
            with at(f"{entry.field}.base.on"):
                require_known(case, placed.mount.on)
    for i, obstacle in enumerate(case.obstacles):
        if obstacle.mount is not None:
            with at(f"{scene_at.field}obstacles[{i}].on"):
                require_known(case, obstacle.mount.on)


def _robot_notes(entry: schema.RobotEntry, placed: PlacedRobot, several: bool) -> list[str]:
    """What the file leaves open of a robot, and what was left out of it."""
    asked = placed.trajectory
    given = [*(asked.joint_names if asked else ()), *placed.fixed_positions]
    notes = note_on_joints_at_zero(placed.robot, given, f"{entry.field}.joints")
    if several:
        notes = [f"robot {placed.robot.name!r}: {note}" for note in notes]
    matrix = placed.self_clearance and placed.self_clearance.matrix
    return [*notes, *(matrix.notes if matrix else ())]


def _sign_off(given: schema.Report | None) -> SignOff | None:
    return None if given is None else SignOff(given.author or "", given.revision or "")
