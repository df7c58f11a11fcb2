"""A question, complete: which robot moves how through which scene, and how close it may come."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, overload

import numpy as np

from clearance.errors import (
    BadInput,
    BadTime,
    Contradiction,
    NothingToMeasure,
    UnknownRobot,
    at,
)
from clearance.world.body import Obstacle
from clearance.world.budget import Budget
from clearance.world.carry import Carry, require_one_carrier
from clearance.world.cell import Cell, cell_of, once_a_cell
from clearance.world.field_types import require_two_patterns, require_types
from clearance.world.names import (
    checked_name,
    require_distinct_names,
    require_other_names,
    require_own_names,
    require_surfaces,
)
from clearance.world.notice import Notice, accepted_kind
from clearance.world.placed_robot import PlacedRobot
from clearance.world.rules import DEFAULT, Allowance, Rule, Waiver, checked_level, ordered_warn
from clearance.world.trajectory import Trajectory

if TYPE_CHECKING:
    from clearance.sketch.sketch import Sketch


JOINT_RULES = ("warn", "fail")
"""What a joint beyond its limits is."""


@dataclass(frozen=True)
class Limits:
    """Two levels of clearance [m]: below `fail` the case is violated, below `warn` it is a near miss.

    Args:
        warn: as `fail` if not given.
        joints: what a joint beyond its limits is: "warn" for a warning, "fail" for a violation.
        rules: limits of some pairs; the last that matches a pair applies; without one, these limits.
        rounding: [m] a clearance that is less than a level by no more is at the level; a run knows it.

    Raises:
        BadDimension: a level that is below 0 or not finite, or `warn` below `fail`. DuplicateName: two rules of
            one name.
    """

    fail: float = 0.0
    warn: float = None  # type: ignore[assignment]  # always a number once it is made
    joints: str = "warn"
    rules: tuple[Rule, ...] = ()
    rounding: float = field(default=0.0, compare=False, repr=False)

    def __post_init__(self) -> None:
        require_types(self, rules=[Rule])
        if self.joints not in JOINT_RULES:
            where, valid = "Limits.joints", f"one of {', '.join(JOINT_RULES)}"
            raise BadInput(f"{self.joints!r:.60} is given", where=where, valid=valid)
        fail = checked_level(self.fail, "fail")
        warn = None if self.warn is None else checked_level(self.warn, "warn")
        object.__setattr__(self, "fail", fail)
        object.__setattr__(self, "warn", ordered_warn(fail, warn))
        require_own_names("rule", [rule.name for rule in self.rules])
        for rule in self.rules:
            rule.levels(self.fail)

    @overload
    def below(self, clearance: float, level: float) -> bool: ...
    @overload
    def below(self, clearance: np.ndarray, level: float | np.ndarray) -> np.ndarray: ...

    def below(self, clearance: float | np.ndarray, level: float | np.ndarray) -> bool | np.ndarray:
        """True where a clearance [m] is below a level [m] by more than rounding."""
        return clearance < level - self.rounding

    @property
    def least_kept(self) -> float:
        """[m] The least clearance that keeps the fail limit."""
        return self.fail - self.rounding

    @property
    def rule_names(self) -> tuple[str, ...]:
        """The names of what can judge a pair: the limits by themselves, then the rules."""
        return (DEFAULT, *(rule.name for rule in self.rules))

    def of_rule(self, i_rule: int) -> Limits:
        """The limits by themselves (0), or those of a rule (from 1), as `rule_names` counts."""
        if i_rule == 0:
            return self if not self.rules else replace(self, rules=())
        return Limits(*self.rules[i_rule - 1].levels(self.fail), self.joints)


LOOKUP = "(lookup) "
"""Beginning of the path of a source that is no file: a name that was searched for in several places."""


@dataclass(frozen=True)
class Source:
    """A file that the case was made from, or a search that led to one.

    Attributes:
        path: as it is shown, the same on every machine; for a search `LOOKUP` and the name.
        sha256: of its content; of a search that of where it led.
        read_from: where it was found, for nobody but who must not overwrite it; of a search what repeats it.
    """

    path: str
    sha256: str
    n_bytes: int
    read_from: str = field(default="", compare=False, repr=False)

    @property
    def is_file(self) -> bool:
        """False for a search."""
        return not self.path.startswith(LOOKUP)


@dataclass(frozen=True)
class Omission:
    """A link or a pair that is left out, and why (`obstacle` is "*" for a whole link)."""

    link: str
    obstacle: str
    reason: str


@dataclass(frozen=True, eq=False)
class ReservedSpace:
    """An outline in a plane with which the robot's sweep is compared.

    Attributes:
        plane: "xy", "xz", "yz" or a point and a normal; `section` cuts there [m] instead of projecting.
        sketch: its closed contours, in the plane's coordinates [m].
        mode: "outside": the sketch contains the sweep; "inside": it stays clear of it; "nearest": the outlines
            differ by no more than the limit.
        limit: [m] the least gap (outside, inside) or the greatest distance (nearest).
        links: names; empty for all.
        drift: [m] how far points of a sketch without a fixed entity moved when its file was solved.
    """

    name: str
    sketch: Sketch
    plane: str = "xy"
    section: float | None = None
    mode: str = "outside"
    limit: float = 0.0
    links: tuple[str, ...] = ()
    drift: float = 0.0


@dataclass(frozen=True)
class SignOff:
    """Who answers for a case, in which revision, for the report; empty where that is not given."""

    author: str = ""
    revision: str = ""


@dataclass(frozen=True)
class Clock:
    """The greatest difference of the actors' clocks [s]: 0 for one clock, infinite where they are not tied.

    Raises:
        BadTime: a slack below 0 or NaN.
    """

    slack: float = 0.0

    def __post_init__(self) -> None:
        require_types(self, slack=Real)
        if not self.slack >= 0.0:
            raise BadTime(f"the slack of the clock is {self.slack} s", valid="0 or more")


COMMON = Clock()
"""One clock for all."""


@dataclass(frozen=True, eq=False)
class Case:
    """Robots, obstacles, trajectories, limits: as they are when it is made; `dataclasses.replace` makes another.

    Attributes:
        robots: at least one.
        obstacles: unique names.
        allow: pairs that are not measured; two patterns of names (`fnmatch`) become an `Allowance`.
        carries: which parts are carried, by what and when.
        clock: the greatest difference of the actors' clocks.
        tolerance: what the real machine may differ by; None where nothing is given.
        contact_response: in simulated motion, obstacles push back.
        sources: every file read, for the summary.
        notes: what loading had to mend or assume, one line each.
        notices: suspect input and warnings that only loading can find; `plausibility.notices_of` adds the rest.
        accept: kinds of suspect input that do not make the verdict suspect, and of warnings that are known.
        fail_on_warning: a warning that is not accepted fails the run.
        waivers: which bodies may come nearer than their rule says; of several for a pair the last counts.
        profiles: outlines with which the sweep is compared.
        sign_off: for the report; None where it has no such fields.
        path_error: [m] by how much less clearances may be since paths are off their samples' motion; in phases.
    """

    name: str
    robots: tuple[PlacedRobot, ...]
    obstacles: tuple[Obstacle, ...]
    limits: Limits = Limits()
    allow: tuple[Allowance, ...] = ()
    contact_response: bool = False
    sources: tuple[Source, ...] = ()
    notes: tuple[str, ...] = ()
    profiles: tuple[ReservedSpace, ...] = ()
    notices: tuple[Notice, ...] = ()
    accept: tuple[str, ...] = ()
    waivers: tuple[Waiver, ...] = ()
    sign_off: SignOff | None = None
    carries: tuple[Carry, ...] = ()
    clock: Clock = COMMON
    tolerance: Budget | None = None
    path_error: float = 0.0
    fail_on_warning: bool = False

    def __post_init__(self) -> None:
        if not self.robots:
            raise NothingToMeasure(f"case {self.name!r} has no robot", valid="at least one")
        require_types(
            self, name=str, robots=[PlacedRobot], obstacles=[Obstacle], limits=Limits, carries=[Carry],
            clock=Clock, tolerance=(Budget, None), waivers=[Waiver], profiles=[ReservedSpace],
            accept=[str], allow=[object], sources=[Source], notes=[str], notices=[Notice],
        )  # fmt: skip
        checked_name(self.name)
        allow = (
            row
            if isinstance(row, Allowance)
            else Allowance(require_two_patterns(self, "allow", row))
            for row in self.allow
        )
        object.__setattr__(self, "allow", tuple(allow))
        with at("accept"):
            object.__setattr__(self, "accept", tuple(map(accepted_kind, self.accept)))
        _require_bodies(self)

    def __repr__(self) -> str:
        robots = ", ".join(repr(placed.robot) for placed in self.robots)
        return f"<Case {self.name!r}: {robots}, obstacles {len(self.obstacles)}>"

    @property
    def files_read(self) -> tuple[str, ...]:
        """Where the files were found that it was made from."""
        return tuple(one.read_from for one in self.sources if one.is_file)

    @cached_property
    def cell(self) -> Cell:
        """The part of it that no trajectory changes, as a key."""
        objects: list[object] = [*self.obstacles]
        values: list[Hashable] = [
            self.allow,
            self.limits,
            self.carries,
            self.clock,
            self.path_error,
        ]
        for placed in self.robots:
            objects += [placed.robot, placed.mount, placed.self_clearance]
            values += [placed.world_from_base.tobytes(), placed.exclude_links]
            values.append(tuple(sorted(placed.padding.items())))
        return cell_of(objects, tuple(values))

    def prefix_of(self, placed: PlacedRobot) -> str:
        """The prefix of a robot's links in tables: empty where there is one robot."""
        return "" if len(self.robots) == 1 else f"{placed.robot.name}/"

    @property
    def _stand_on_others(self) -> bool:
        """True if something is on a body that it gives by name."""
        mounts = [*(one.mount for one in self.robots), *(one.mount for one in self.obstacles)]
        return bool(self.carries) or any(mount is not None for mount in mounts)

    def with_trajectory(
        self,
        times: np.ndarray,
        positions: np.ndarray,
        *,
        velocities: np.ndarray | None = None,
        joint_names: Sequence[str] | None = None,
        robot: str | None = None,
        wrap: str | None = None,
    ) -> Case:
        """The same case with another trajectory for one robot.

        Args:
            times: (n,) [s]. positions, velocities: (n, k) of `joint_names` [rad] or [m], and per second.
            joint_names: those of the trajectory that it has, in its order, else all its moving joints that are not
                fixed. A note says where that order is not the one of the robot's file.
            robot: its name; needed only where there are several. wrap: as in `Trajectory`.

        Raises:
            BadInput: no such robot or joint, numbers that are no trajectory, or a robot that the program of
                another one counts on.
        """
        i_robot = index_of_robot(self.robots, robot)
        require_no_program_on(self, i_robot)
        placed = self.robots[i_robot]
        names = placed.joints_given if joint_names is None else tuple(joint_names)
        trajectory = Trajectory(times, names, positions, velocities, wrap=wrap)
        moved = placed.moved_by(trajectory, trajectory_path="")
        robots = (*self.robots[:i_robot], moved, *self.robots[i_robot + 1 :])
        in_file = [joint.name for joint in placed.robot.moving_joints if joint.name in names]
        if joint_names is not None or in_file == list(names):
            return replace(self, robots=robots)
        order = f"columns are taken in the order of the trajectory before: {', '.join(names)}"
        note = f"{order}; the robot's file has another, and `joint_names` says which is meant"
        return replace(self, robots=robots, notes=tuple(dict.fromkeys((*self.notes, note))))


@once_a_cell(16)
def _require_bodies(case: Case) -> None:
    """Nothing, if all names are different, and links have surfaces."""
    require_own_names("robot", [placed.robot.name for placed in case.robots])
    require_own_names("obstacle", [obstacle.name for obstacle in case.obstacles])
    for placed in case.robots:
        require_own_names("link", list(placed.robot.link_names))
        require_surfaces(placed.robot)
    if len(case.robots) > 1:
        require_distinct_names([placed.robot for placed in case.robots], case.obstacles)
    elif case.robots[0].self_clearance or case._stand_on_others:
        require_other_names(case.robots[0].robot, case.obstacles)
    require_one_carrier(case.carries)


def require_no_program_on(case: Case, i_robot: int) -> None:
    """Nothing, if no program of another robot was followed as a robot moves, or stands, that is to move otherwise.

    Raises:
        BadInput: a program moves it, or has frames on it or on what is there.
    """
    name = case.robots[i_robot].robot.name
    for i, placed in enumerate(case.robots):
        asked = placed.trajectory
        if i == i_robot or asked is None:
            continue
        frames = {
            one.partition("/")[0]
            for on in (*asked.frames, *asked.rides)
            for one in _below(case, on)
        }
        if name in frames or name in asked.drives:
            raise Contradiction(
                f"the program of robot {placed.robot.name!r} was followed with robot {name!r} as it is",
                where="trajectory",
                valid=f"the motion of {name!r} in the case file, or a program that does not count on it",
            )


def _below(case: Case, name: str) -> Iterator[str]:
    """A body, and what it is on, one after the other."""
    below = {one.name: one.mount.on for one in case.obstacles if one.mount is not None}
    below |= {one.robot.name: one.mount.on for one in case.robots if one.mount is not None}
    while name:
        yield name
        name = below.pop(name, "") or below.pop(name.partition("/")[0], "")


def index_of_robot(robots: Sequence[PlacedRobot], name: str | None) -> int:
    """The place of the one robot of a name, or of the only one.

    Raises:
        UnknownRobot: there is no such one.
    """
    names = [placed.robot.name for placed in robots]
    if name is None and len(names) == 1:
        return 0
    if name is None or names.count(name) != 1:
        raise UnknownRobot(f"there is no one robot {name!r}", valid=f"one of {', '.join(names)}")
    return names.index(name)


def uncounted_in_sweeps(cases: Sequence[Case]) -> str:
    """What cases give that widens no sweep: "tolerances", "paddings", both, or nothing."""
    paddings = (one.padding.values() for case in cases for one in case.robots)
    given = {
        "tolerances": any(case.tolerance is not None for case in cases),
        "paddings": any(padding > 0.0 for of_robot in paddings for padding in of_robot),
    }
    return " and ".join(name for name, is_given in given.items() if is_given)
