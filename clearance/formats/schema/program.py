"""The schema of a robot program: a tool, frames, and moves one after another. Lengths in metres, angles in
radians.

Not for: how joints follow (room `programs`), where frames are (`case.program`), languages of controllers
(`formats.program`).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from clearance.errors import BadProgram, MissingKey, nearest_name
from clearance.formats.schema.pose import Pose
from clearance.formats.schema.strict_model import Name, StrictModel, Triple

WORLD, BASE = "world", "base"
"""Frames that every program has: the world's, and the robot's root link."""

Above0 = Annotated[float, Field(ge=1e-6, le=1e6)]
Zone = Annotated[float, Field(ge=0)]
"""[m] The radius of the corner at a move's end."""

Time = Annotated[float | None, Field(ge=1e-6, le=1e6)]
"""[s] That a move takes from standstill to standstill; None if its speed says it."""

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]


class Tool(Pose):
    """A tool: the link that it is fixed to, and its pose on it."""

    link: Name


class Frame(Pose):
    """A work frame: its pose on `world`, `base`, another frame, an obstacle, or a link. These stand, move by
    tables of their own, or are moved by the program. Lines and arcs are seen from the frame, and go with it."""

    on: Name = WORLD


class Point(StrictModel):
    """A point in a frame."""

    frame: Name = WORLD
    xyz: Triple
    name: Name | None = None


class Target(Pose):
    """A pose of the tool in a frame; without a rotation a line or an arc leaves the orientation as it is."""

    frame: Name = WORLD
    xyz: Triple
    name: Name | None = None

    @property
    def turns(self) -> bool:
        """True if it says an orientation."""
        return self.quat_xyzw is not None or self.rpy is not None


class JointMove(StrictModel):
    """`ptp`: all joints go straight to their targets, begin together and end together; `speed` is a share of their
    greatest, and `zone` the radius of the corner at its end [m]. In place of `speed`, `time` is what it takes from
    standstill to standstill [s], or `joint_speed` and `joint_acceleration` are of the joint that goes farthest.
    For the pose `to` the joints are those nearest to `near` (default: to where they are), `within` ranges,
    of a joint one or several.
    """

    joints: dict[Name, float] | None = None
    to: Target | None = None
    speed: Annotated[float, Field(gt=0, le=1)] = 1.0
    time: Time = None
    joint_speed: Above0 | None = None
    joint_acceleration: Above0 = 1.4
    zone: Zone = 0.0
    near: dict[Name, float] = {}
    within: dict[Name, Pair | list[Pair]] = {}

    @model_validator(mode="after")
    def _one_target(self) -> JointMove:
        if (self.joints is None) == (self.to is None):
            raise BadProgram(
                "joints and to are given" if self.to else "no target is given",
                valid="joints, or to",
            )
        if self.joints is not None and (self.near or self.within):
            raise BadProgram("joints are given", where="near", valid="no such key, or a pose to")
        if self.to is not None and not self.to.turns:
            raise MissingKey("no orientation is given", where="to", valid="quat_xyzw or rpy")
        _require_one(self, "time", "joint_speed", "speed")
        if self.joint_speed is None and "joint_acceleration" in self.model_fields_set:
            raise MissingKey("joint_acceleration is given alone", valid="joint_speed beside it")
        return self


class PathMove(StrictModel):
    """What `lin` and `circ` share: speed of the tool's point [m/s], its acceleration [m/s^2], speed of a turn
    [rad/s], radius of the corner at its end [m], and joints that go straight to values meanwhile (`hold`). Joints
    beside the arm, as `turntable/turn` of another robot, stay unless `hold` says where they go, or `free` that
    they follow too. `time` in place of speeds is what it takes from standstill to standstill [s].
    """

    to: Target
    speed: Above0 = 0.25
    acceleration: Above0 = 1.0
    turn_speed: Above0 = 1.0
    time: Time = None
    zone: Zone = 0.0
    hold: dict[Name, float] = {}
    free: list[Name] = []

    @model_validator(mode="after")
    def _one_law(self) -> PathMove:
        _require_one(self, "time", "speed")
        _require_one(self, "time", "turn_speed")
        return self


def _require_one(move: StrictModel, *keys: str) -> None:
    """Checks that a move says at most one of some keys.

    Raises:
        BadProgram: it says two.
    """
    given = [key for key in keys if key in move.model_fields_set]
    if len(given) > 1:
        raise BadProgram(f"{' and '.join(given)} are given", valid="one of them")


class LinearMove(PathMove):
    """`lin`: the tool's point goes along a straight line."""


class ArcMove(PathMove):
    """`circ`: the tool's point goes along the arc through `via`; its orientation goes to that of `to`, or stays
    the same to the path (`tangent`), or in the world (`constant`).
    """

    via: Point
    orientation: Literal["to", "constant", "tangent"] = "to"


class Move(StrictModel):
    """One move: one of `ptp`, `lin`, `circ`, `wait` [s], and `tool`: another on the same link from here on."""

    ptp: JointMove | None = None
    lin: LinearMove | None = None
    circ: ArcMove | None = None
    wait: Annotated[float | None, Field(gt=0)] = None
    tool: Pose | None = None

    @model_validator(mode="after")
    def _one(self) -> Move:
        given = [name for name in self.keys() if getattr(self, name) is not None]
        if len(given) != 1:
            fault = f"{' and '.join(given)} are given" if given else "nothing is given"
            raise BadProgram(fault, valid=f"one of {', '.join(self.keys())}")
        return self


class Program(StrictModel):
    """A whole program. `start` are the joints at its beginning; `step` is the most that the tool moves between
    samples [m].
    """

    tool: Tool
    frames: dict[Name, Frame] = {}
    start: dict[Name, float] = {}
    step: Annotated[float, Field(gt=0)] = 0.002
    moves: Annotated[list[Move], Field(min_length=1)]

    @property
    def joints_named(self) -> frozenset[str]:
        """The joints that its moves name."""
        found = set[str]()
        for move in self.moves:
            if move.ptp is not None:
                found |= {*(move.ptp.joints or {}), *move.ptp.near, *move.ptp.within}
            elif (path := move.lin or move.circ) is not None:
                found |= {*path.hold, *path.free}
        return frozenset(found)

    @model_validator(mode="after")
    def _frames_known(self) -> Program:
        known = (*self.frames, WORLD, BASE)
        for name in (WORLD, BASE):
            if name in self.frames:
                raise BadProgram(
                    "a frame of this name is there always",
                    where=f"frames.{name}",
                    valid="another name",
                )
        for i, move in enumerate(self.moves):
            for key, place in _places(move):
                if place.frame not in known:
                    raise BadProgram(
                        f"unknown frame {place.frame!r}",
                        where=f"moves[{i}].{key}.frame",
                        valid=nearest_name(place.frame, known),
                    )
        return self


def _places(move: Move) -> list[tuple[str, Point | Target]]:
    """The poses and points of a move, and where they are written."""
    found: list[tuple[str, Point | Target]] = []
    if move.ptp is not None and move.ptp.to is not None:
        found.append(("ptp.to", move.ptp.to))
    if move.lin is not None:
        found.append(("lin.to", move.lin.to))
    if move.circ is not None:
        found += [("circ.to", move.circ.to), ("circ.via", move.circ.via)]
    return found
