"""The case file's schema: which keys there are, and what each may hold; how close what may come to what, and when.
Lengths in metres, angles in radians.

Every model refuses keys it does not have and names the nearest valid one; numbers are numbers (no text, no `true`,
no NaN). Not for: reading files, or names that must exist in the robot (`case_file`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import (
    AfterValidator,
    Field,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from clearance.errors import BadInput, BadShape, Contradiction, MissingKey, nearest_name
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.pose import Base, WindowedEntry
from clearance.formats.schema.strict_model import Level, Name, StrictModel
from clearance.formats.schema.timed import TrajectoryFile
from clearance.formats.schema.tolerance import Tolerance
from clearance.world.names import checked_name
from clearance.world.notice import accepted_kind

TwoPatterns = Annotated[list[Name], Field(min_length=2, max_length=2)]


class PairRow(WindowedEntry):
    """Pairs of bodies by two patterns, and when they are meant."""

    between: TwoPatterns
    while_carried: Name | None = None

    @property
    def patterns(self) -> tuple[str, str]:
        """The two patterns."""
        one, other = self.between
        return one, other


class AllowedPair(PairRow):
    """Pairs that are not measured: two patterns, or a mapping that says when as well."""

    @model_validator(mode="before")
    @classmethod
    def _patterns_alone(cls, data: Any) -> Any:
        if isinstance(data, str):
            raise BadShape(
                f"{data!r:.60} is given", valid="rows of two patterns: [[link, obstacle]]"
            )
        if not isinstance(data, list):
            return data
        if len(data) != 2:
            raise BadShape(f"{data!r:.60} is given", valid="2 values are needed")
        return {"between": data}


class Rule(PairRow):
    """Limits of some pairs [m]; of several rules for a pair the last counts."""

    name: Name | None = None
    fail: Level | None = None
    warn: Level | None = None

    @model_validator(mode="after")
    def _says_something(self) -> Rule:
        if self.fail is None and self.warn is None:
            raise BadInput("neither fail nor warn is given", valid="one of them, or both")
        return self


class Limits(StrictModel):
    """Least clearances [m]: below `fail` the case is violated, below `warn` it is a near miss; and what a
    joint beyond its limits is.
    """

    fail: Level = 0.0
    warn: Level | None = None
    joints: Literal["warn", "fail"] = "warn"
    rules: list[Rule] = []


def _without_stroke(name: str) -> str:
    if "/" in name:
        raise BadInput(
            f"{name!r:.60} is given", valid="no '/', since links of several robots are robot/link"
        )
    return name


STATE = "state"
"""The key of the names of states; a joint may be called so too, and then has a number."""


class RestingJoints(dict[str, float]):
    """Positions by joint [rad] or [m].

    Attributes:
        states: of an SRDF, which give the positions of others.
    """

    def __init__(self, positions: dict[str, float], states: Iterable[str] = ()) -> None:
        super().__init__(positions)
        self.states = tuple(states)


def states_of(joints: dict[str, float]) -> tuple[str, ...]:
    """The states that a case file names among its joints."""
    return joints.states if isinstance(joints, RestingJoints) else ()


def _with_states(data: Any, positions: ValidatorFunctionWrapHandler) -> RestingJoints:
    given = data.get(STATE) if isinstance(data, dict) else None
    if not isinstance(given, str | list):
        return RestingJoints(positions(data))
    names = [given] if isinstance(given, str) else given
    if not names or not all(isinstance(name, str) and name for name in names):
        raise BadInput(f"{given!r:.60} is given", where=STATE, valid="names of states")
    others = {name: value for name, value in data.items() if name != STATE}
    return RestingJoints(positions(others), map(checked_name, names))


Joints = Annotated[dict[str, float], WrapValidator(_with_states)]


class Robot(StrictModel):
    """A robot, where it stands, what it does, and what of it is measured."""

    name: Annotated[Name, AfterValidator(_without_stroke)] | None = None
    urdf: Name
    xacro: bool = False
    xacro_args: dict[str, str | bool | int | float] = {}
    package_dirs: list[Name] = []
    base: Base = Base()
    trajectory: TrajectoryFile | None = None
    exclude_links: list[Name] = []
    joints: Joints = {}
    geometry: Literal["collision", "visual", "collision_or_visual"] = "collision"
    collada_up_axis: Literal["ros", "file"] = "ros"
    self_clearance: bool = False
    srdf: Name | None = None
    trust_never: bool = False
    joint_limits: Name | None = None
    controllers: Name | None = None
    padding: dict[str, Level] = {}


class Carry(WindowedEntry):
    """A part that a link or an obstacle carries from a time until a time [s]; meanwhile it may touch some.

    `grasp: exact` says that the gripper itself positions the part. With tolerances, errors of the carrier at the
    grasp then do not count.
    """

    part: Name
    by: Name
    from_: Annotated[float, Field(alias="from")]
    touch: list[Name] = []
    grasp: Literal["exact"] | None = None


CLOCKS = {"common": 0.0, "unsynchronised": math.inf}
"""[s] How far the clocks of actors may be apart, by word."""


class Clock(StrictModel):
    """How far the clocks of robots may be apart: `common`, `unsynchronised`, or `{slack: seconds}`."""

    slack: Annotated[float, Field(ge=0, allow_inf_nan=True)]

    @model_validator(mode="before")
    @classmethod
    def _word_or_slack(cls, data: Any) -> Any:
        if isinstance(data, str):
            if data not in CLOCKS:
                raise BadInput(f"{data!r:.60} is given", valid=nearest_name(data, CLOCKS))
            return {"slack": CLOCKS[data]}
        if not isinstance(data, dict) or not data:
            given = "nothing is given" if not data else f"{data!r:.60} is given"
            raise BadInput(given, valid=f"{', '.join(CLOCKS)} or {{slack: seconds}}")
        return data


class Profile(StrictModel):
    """A sketched outline that what the robot sweeps in a plane must keep to; lengths in metres."""

    name: Name
    sketch: Name
    plane: Name = "xy"
    section: float | None = None
    mode: Literal["outside", "inside", "nearest"] = "outside"
    limit: Annotated[float, Field(ge=0)] = 0.0
    links: list[Name] = []


Kind = Annotated[str, AfterValidator(accepted_kind)]


class Report(StrictModel):
    """What the report is signed with."""

    author: Name | None = None
    revision: Name | None = None


class RobotEntry(NamedTuple):
    """A robot of a case file.

    Attributes:
        field: where it is written. trajectory, trajectory_field: what it does, and where that is written.
    """

    field: str
    robot: Robot
    trajectory: TrajectoryFile | None
    trajectory_field: str


class Case(StrictModel):
    """A whole case file; `scene` may be a path, which is followed before this is checked."""

    MOVES: ClassVar[bool] = True
    """Something must move."""

    name: Name | None = None
    robot: Robot | None = None
    robots: Annotated[list[Robot], Field(min_length=1)] | None = None
    scene: Scene
    includes: dict[Name, Name] = {}
    trajectory: TrajectoryFile | None = None
    carry: list[Carry] = []
    limits: Limits = Limits()
    allow: list[AllowedPair] = []
    clock: Clock = Clock(slack=0.0)
    contact_response: bool = False
    profiles: list[Profile] = []
    accept: list[Kind] = []
    waivers: list[Name] = []
    tolerance: Tolerance | None = None
    report: Report | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_of_robot_and_robots(cls, data: Any) -> Any:
        if isinstance(data, dict) and set(data) <= set(cls.keys()):
            if "robot" in data and "robots" in data:
                raise Contradiction("both robot and robots are given", valid="one of them")
            if "robot" not in data and "robots" not in data:
                raise MissingKey("'robot' is missing", valid="robot, or robots for several")
        return data

    @model_validator(mode="after")
    def _one_trajectory_each(self) -> Case:
        entries = self.entries()
        if self.trajectory is not None:
            if len(entries) > 1:
                raise Contradiction(
                    f"a trajectory beside {len(entries)} robots",
                    where="trajectory",
                    valid="trajectory in each robot",
                )
            if entries[0].robot.trajectory is not None:
                raise Contradiction(
                    f"a trajectory is given here and in {entries[0].field}",
                    where="trajectory",
                    valid="one of them",
                )
        moving = any(obstacle.moves is not None for obstacle in self.scene.obstacles)
        if self.MOVES and not moving and all(entry.trajectory is None for entry in entries):
            raise MissingKey("'trajectory' is missing", valid="nothing moves without one")
        return self

    def entries(self) -> list[RobotEntry]:
        """The robots in the file's order."""
        if self.robot is not None:
            return [self._entry("robot", self.robot)]
        robots = self.robots or []
        return [self._entry(f"robots[{i}]", robot) for i, robot in enumerate(robots)]

    def _entry(self, field: str, robot: Robot) -> RobotEntry:
        if self.trajectory is not None:
            return RobotEntry(field, robot, self.trajectory, "trajectory")
        return RobotEntry(field, robot, robot.trajectory, f"{field}.trajectory")


class Cell(Case):
    """A case file that may leave out what moves: trajectories are given to it one after another."""

    MOVES = False
