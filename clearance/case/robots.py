"""The robots of a case file, read and placed: URDF, SRDF, trajectory, joints, padding, base; and all as they move:
those with programs are read when what their frames are on is read.

Not for: obstacles (`scene.obstacles`), what a program may move (`driven_robots`), names that only the whole
case can know (`case_file`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from clearance.case.allow import carries_of
from clearance.case.driven_robots import ProgrammedMotion, Surroundings, require_as_read
from clearance.case.resting import bases_asked, positions_asked, resting_positions, with_start
from clearance.errors import Contradiction, MissingFile, UnknownLink, UnknownPlace, at, nearest_name
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.limit_files import limited, note_on_accelerations
from clearance.formats.robot.request import RobotRequest, checked_args, read_robot
from clearance.formats.robot.srdf import read_srdf, virtual_joints
from clearance.formats.schema import case as schema
from clearance.formats.schema.case import states_of
from clearance.formats.text.notes import note_on_rounded
from clearance.formats.text.xml_document import XACRO
from clearance.formats.timed_files import trajectory_of
from clearance.world.body import Mount, Obstacle
from clearance.world.names import checked_links
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.robot import Robot
from clearance.world.rules import matches
from clearance.world.trajectory import Trajectory


class RobotReader:
    """Reads the robots of one case; those of one file share its bodies.

    Args:
        meshes: reads and keeps mesh files, and all others.

    Attributes:
        notes: a line each on how what was read so far was taken.
    """

    def __init__(self, meshes: MeshStore) -> None:
        self._meshes, self._files = meshes, meshes.files
        self._read: dict[RobotRequest, Robot] = {}
        self.notes: list[str] = []

    def moving(self, entry: schema.RobotEntry, around: Surroundings) -> InMotion:
        """The robot of an entry as `in_motion` gives it.

        Raises:
            BadInput: with the field and the file.
        """
        return in_motion(entry, self._standing(entry), self._files, around)

    def _standing(self, entry: schema.RobotEntry) -> PlacedRobot:
        """The robot of an entry, without what it does.

        Raises:
            BadInput: with the field and the file.
        """
        given, field = entry.robot, entry.field
        request = self._request(given, field)
        self._expand_srdf(given, field, request)
        limits = limited(entry, self._robot(request, given.name, field), self._files)
        robot = limits.robot
        self.notes += limits.notes
        with at(f"{field}.exclude_links"):
            exclude_links = checked_links(given.exclude_links, robot.link_names)
        with at(f"{field}.padding"):
            padding = _padding(given.padding, robot.link_names)
        placed = PlacedRobot(
            robot=robot,
            exclude_links=exclude_links,
            urdf_path=str(request.path),
            package_dirs=tuple(map(str, request.package_dirs)),
            self_clearance=self._self_clearance(entry, robot, self._read[request].name),
            padding=padding,
            motion_limits=limits.motion_limits,
            path_tolerances=limits.path_tolerances,
            bases=dict.fromkeys(self._unplaced(given, field)),
        )
        if given.base.is_rounded:
            self.notes.append(f"{field}.base: {note_on_rounded(1)[0]}")
        if given.base.on is not None:
            return replace(placed, mount=Mount(given.base.on, given.base.matrix()))
        return replace(placed, world_from_base=given.base.matrix())

    def _unplaced(self, given: schema.Robot, field: str) -> list[str]:
        """The virtual joints that move a base which the case does not place."""
        if given.srdf is None or "base" in given.model_fields_set:
            return []
        with at(f"{field}.srdf"):
            return virtual_joints(self._files.resolved(given.srdf), self._files)

    def _request(self, given: schema.Robot, field: str) -> RobotRequest:
        package_dirs = tuple(map(self._files.resolved, given.package_dirs))
        for i, path in enumerate(package_dirs):
            if not path.is_dir():
                where = f"{field}.package_dirs: [{i}]"
                raise MissingFile(f"there is no folder {given.package_dirs[i]!r}", where=where)
        if given.xacro_args and not given.xacro:
            raise Contradiction(
                "arguments of xacro, which is not used",
                where=f"{field}.xacro_args",
                valid="xacro: true",
            )
        with at(f"{field}.xacro_args"):
            args = checked_args(given.xacro_args)
        return RobotRequest(
            self._files.resolved(given.urdf),
            package_dirs,
            given.geometry,
            given.collada_up_axis,
            given.xacro,
            args,
        )

    def _expand_srdf(self, given: schema.Robot, field: str, request: RobotRequest) -> None:
        """Makes an SRDF of xacro's what it stands for, where xacro is allowed."""
        if given.srdf is None or not given.xacro or not given.srdf.endswith(XACRO):
            return
        path = self._files.resolved(given.srdf)
        if not self._files.is_in_memory(path):
            from clearance.formats.robot.urdf.xacro_file import expand_xacro

            with at(f"{field}.srdf"):
                self.notes += expand_xacro(path, request.package_dirs, self._files)

    def _robot(self, request: RobotRequest, name: str | None, field: str) -> Robot:
        if request not in self._read:
            with at(f"{field}.urdf"):
                self._read[request] = read_robot(request, self._meshes)
        robot = self._read[request]
        return robot if name is None else replace(robot, name=name)

    def _self_clearance(
        self, entry: schema.RobotEntry, robot: Robot, own_name: str
    ) -> SelfClearance | None:
        """Whether the robot's links are measured against one another, and which pairs an SRDF file excuses.

        Args:
            own_name: of the robot in its own file.
        """
        given, field = entry.robot, entry.field
        _refuse_idle_excuses(entry)
        if not given.self_clearance:
            return None
        if given.srdf is None:
            return SelfClearance()
        with at(f"{field}.srdf"):
            own = replace(robot, name=own_name)
            matrix = read_srdf(self._files.resolved(given.srdf), own, self._files)
        return SelfClearance(matrix, given.trust_never, given.geometry)


class InMotion(NamedTuple):
    """A robot as it moves, a line each on how, and the motion of other robots that its program drives, by name."""

    placed: PlacedRobot
    notes: tuple[str, ...]
    driven: Mapping[str, Trajectory] = {}

    def driving(self, other: PlacedRobot) -> PlacedRobot:
        """Another robot as the program of this one moves it, in time with it."""
        made, timing = self.driven[other.robot.name], self.placed.timing
        if timing.after == "absent":  # the other robot is there all the time
            timing = replace(timing, after="hold")
        return other.moved_by(made, timing=timing)


def in_motion(
    entry: schema.RobotEntry, placed: PlacedRobot, files: InputFiles, around: Surroundings
) -> InMotion:
    """The robot of an entry with its trajectory, the others of its joints at rest.

    Args:
        placed: as it stands. around: all else, for a program.

    Raises:
        BadInput: with the field and the file.
    """
    asked, trajectory = entry.trajectory, None
    notes: tuple[str, ...] = ()
    moves: dict[str, Any] = {}
    driven: Mapping[str, Trajectory] = {}
    if asked is not None:
        field = entry.trajectory_field
        if asked.program is not None:
            trajectory, notes, driven = _programmed(entry, placed, files, around)
            file = asked.program_file
            path = "" if file is None else str(files.resolved(file.file))
        else:
            trajectory, notes = trajectory_of(asked, field, placed.robot, files)
            trajectory, on_start = with_start(entry, trajectory, placed.robot, files)
            notes = (*notes, *on_start)
            path = str(files.resolved(asked.file))
        moves = {"trajectory": trajectory, "timing": asked.timing, "trajectory_path": path}
    moved = trajectory.joint_names if trajectory else ()
    resting = resting_positions(entry, placed.robot, moved, files)
    on_limits = note_on_accelerations(placed.motion_limits, trajectory)
    moves["fixed_positions"] = resting.positions
    moves["bases"] = {**placed.bases, **bases_asked(entry, placed.robot, files)}
    return InMotion(replace(placed, **moves), (*notes, *resting.notes, *on_limits), driven)


def _programmed(
    entry: schema.RobotEntry, placed: PlacedRobot, files: InputFiles, around: Surroundings
) -> ProgrammedMotion:
    """The motion of the entry's program, from the start that the entry gives."""
    from clearance.case.program import program_motion

    asked, field = entry.trajectory, entry.trajectory_field
    assert asked is not None
    start = asked.start_state or {}
    if not isinstance(start, Mapping):
        names = [start] if isinstance(start, str) else start
        with at(f"{field}.start_state"):
            start = positions_asked(entry, names, placed.robot, files)[1].positions
    with at(f"{field}.program"):
        return program_motion(asked, start, placed, files, around)


def _refuse_idle_excuses(entry: schema.RobotEntry) -> None:
    """Refuses fields about excused pairs where they would excuse nothing."""
    given, field = entry.robot, entry.field
    starts = entry.trajectory is not None and isinstance(entry.trajectory.start_state, str | list)
    if not given.self_clearance:
        for key in ("srdf", "trust_never"):
            if getattr(given, key) and not (key == "srdf" and (states_of(given.joints) or starts)):
                raise Contradiction(
                    "it excuses pairs of links, which are not measured",
                    where=f"{field}.{key}",
                    valid="self_clearance: true, or no such field"
                    + (", or a state of it: joints: {state: …}" if key == "srdf" else ""),
                )
    elif given.srdf is None and given.trust_never:
        raise Contradiction(
            "it applies to the pairs that an SRDF file calls Never",
            where=f"{field}.trust_never",
            valid=f"{field}.srdf: the file",
        )


def _padding(given: Mapping[str, float], links: Sequence[str]) -> dict[str, float]:
    """[m] by link: its own row, else the greatest of the patterns that match it."""
    found: dict[str, float] = {}
    for pattern, padding in given.items():
        meant = [link for link in links if matches(link, pattern)]
        if not meant:
            raise UnknownLink(f"no link matches {pattern!r}", valid=nearest_name(pattern, links))
        found |= {link: max(padding, found.get(link, 0.0)) for link in meant}
    return found | {link: given[link] for link in links if link in given}


def robots_in_motion(
    reader: RobotReader,
    entries: Sequence[schema.RobotEntry],
    given: schema.Case,
    obstacles: Sequence[Obstacle],
) -> list[InMotion]:
    """The robots as they move: those without programs first, and each program after what its frames are on.

    Raises:
        BadInput: with the field and the file; programs whose frames are on each other's robots.
    """
    has_program = [
        one.trajectory is not None and one.trajectory.program is not None for one in entries
    ]
    found = {
        i: reader.moving(one, Surroundings()) for i, one in enumerate(entries) if not has_program[i]
    }
    carries, driven = carries_of(given.carry, [one.name for one in obstacles]), set[str]()

    def around(i_robot: int) -> Surroundings:
        """All but one robot, of what is read."""
        others = tuple(one.placed for i, one in found.items() if i != i_robot)
        return Surroundings(others, tuple(obstacles), carries, frozenset(driven))

    waiting = [i for i, has in enumerate(has_program) if has]
    while waiting:
        i, made = _next_read(reader, entries, waiting, around)
        waiting.remove(i)
        for j, one in found.items():
            if one.placed.robot.name in made.driven:
                found[j] = one._replace(placed=made.driving(one.placed))
        found[i] = made
        driven |= made.driven.keys()
    for i, entry in enumerate(entries):
        if not has_program[i]:
            continue
        with at(f"{entry.trajectory_field}.program"):
            require_as_read(found[i].placed, around(i))
    return [found[i] for i in range(len(entries))]


def _next_read(
    reader: RobotReader,
    entries: Sequence[schema.RobotEntry],
    waiting: Sequence[int],
    around: Callable[[int], Surroundings],
) -> tuple[int, InMotion]:
    """The first robot with a program whose frames are on what is read, and how it moves.

    Raises:
        UnknownPlace: there is none.
    """
    unknown: UnknownPlace | None = None
    for i in waiting:
        n_notes = len(reader.notes)
        try:
            return i, reader.moving(entries[i], around(i))
        except UnknownPlace as fault:
            unknown = unknown or fault
            del reader.notes[n_notes:]
    assert unknown is not None
    raise unknown
