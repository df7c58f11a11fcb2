"""The commanded motion of a robot: joint positions over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from clearance.errors import BadDimension, BadInput, BadShape, DuplicateName, NotFinite
from clearance.tolerance import LARGEST
from clearance.world.field_types import numbers_of, owned, require_types
from clearance.world.notice import NOT_MEASURED, listed
from clearance.world.timing import Timing, Window, require_increasing, time_text

FURTHER_PASSES = "further passes of an endless loop"
"""What the motion of a program leaves out that never ends: how long they take is not the question."""


@dataclass(frozen=True)
class Hole:
    """A stretch of a recording in which a joint has no position: many times longer than usual, or said to be NaN.

    Attributes:
        joints: those without a position. start, end: [s] of the trajectory's own time.
        usual: [s] between two messages. means: one of `notice.GAPS`; None if the case does not say.
    """

    joints: tuple[str, ...]
    start: float
    end: float
    usual: float
    means: str | None = None

    @property
    def text(self) -> str:
        """When it is, how long, and of which joints."""
        return (
            f"no position of {listed([*self.joints], 4)} from {time_text(self.start)} to {time_text(self.end)} s "
            f"({self.end - self.start:.3g} s, usually {self.usual:.2g} s)"
        )


SHORTEST, AS_WRITTEN = "shortest", "as_written"
WRAPS = (SHORTEST, AS_WRITTEN)
"""How to read a step of more than half a turn of a continuous joint."""


@dataclass(frozen=True)
class MoveSpan:
    """When a move of a program is made.

    Attributes:
        name: of the move. start, end: [s] of the trajectory's own time.
        where: it stands in its program: `line 14`, with the file before it where that is another.
    """

    name: str
    start: float
    end: float
    where: str = ""


@dataclass(frozen=True)
class UnprovenSpan:
    """A stretch of a program on which joints are where it says at the samples, and are not proven to be between.

    Attributes:
        move: its name. start, end: [s] of the trajectory's own time. why: in a few words.
    """

    move: str
    start: float
    end: float
    why: str


@dataclass(frozen=True)
class Deviation:
    """How far a link may be off.

    Attributes:
        way: [m] of the origin of its frame. turn: [rad] of the link.
    """

    way: float
    turn: float

    def at(self, distance: float) -> float:
        """[m] How far a point of it may be off at a distance [m] from its origin."""
        return self.way + self.turn * distance


@dataclass(frozen=True, eq=False)
class CornerZone:
    """A stretch of a trajectory on which a controller may leave the nominal path.

    Attributes:
        name: of the move at whose end it is. start, end: [s] of the trajectory's own time. radius: [m].
        links: how far each link that moves may be off, by name.
    """

    name: str
    start: float
    end: float
    radius: float
    links: Mapping[str, Deviation]


@dataclass(frozen=True, eq=False)
class Points:
    """The samples of a file with accelerations, where a trajectory has more between them.

    Attributes:
        times: (m,) [s]. positions, velocities, accelerations: (m, k) [rad] or [m], and per second and its square.
    """

    times: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    accelerations: np.ndarray


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Samples of joint positions, and of velocities if they are known.

    Between samples each joint moves linearly; with velocities, on the cubic that has them at both ends.

    Attributes:
        times: (n,) [s], strictly increasing.
        joint_names: (k,) of the robot's moving joints, in column order.
        positions: (n, k) [rad] or [m], or a table whose columns have these names, in any order.
        velocities: (n, k) as positions, [rad/s] or [m/s], or None.
        path_error: [rad or m] how far joints may be off between samples, and at samples added to the file's.
        began: [s] the clock of a recording's messages at its time 0; None for what has no such clock.
        is_message: True for a planned message, which begins when its stamp says, or as it is received.
        is_recorded: True for a table that is a recording, whose times stay as they are.
        points: the file's own samples, where it has accelerations; None where they are all.
        holes: stretches of a recording in which it was not known where joints were.
        given_extents: (2, k) the least and greatest position before whole turns were subtracted, if any were.
        has_way_in: True if a message moves joints to the first of several samples from where nobody says.
            start_off: how far a start that the message gives is off that sample, in words, if it is.
        elsewhere: where the start of a message has other joints [rad or m], by name.
        starts_before_file: True if its first sample is a start at 0 s that was added to the file's.
        assumed: of a program's controller, where nothing confirms it, one line each. left_out: its instructions
            that the case leaves out, whatever time they take. odd: what looks like another unit in its file.
        is_rough: its times rest on accelerations that no file of its program says.
        contradicted: the points of a program whose own axes are far from them, one line each.
        unread: columns or fields of its file that look like motion or parts, and are not read.
        moves: of a program, when each is made. frames: the obstacles and links that its work frames are on.
        corners: stretches on which a controller may leave the path, and how far links may then be off.
        unproven: stretches of a program that are not proven.
        drives: other robots that its program moves too, whose own trajectories are their part of it.
        rides: what moves by itself and carries frames of the program, whose tool goes with it.
        wrap: one of `WRAPS`, or None if unknown; a case with such a step is then suspect.
            With the shortest way, a `PlacedRobot` subtracts whole turns.

    Raises:
        BadShape, NotFinite: not one finite number for each time and joint. BadTime: times that do not increase.
            BadDimension: a velocity that carries its joint out of all bounds before the next sample. BadInput: a
            wrap that is none.
    """

    times: np.ndarray
    joint_names: tuple[str, ...]
    positions: np.ndarray
    velocities: np.ndarray | None = None
    holes: tuple[Hole, ...] = ()
    wrap: str | None = None
    path_error: float = 0.0
    points: Points | None = None
    began: float | None = None
    is_message: bool = False
    is_recorded: bool = False
    given_extents: np.ndarray | None = None
    has_way_in: bool = False
    start_off: str = ""
    elsewhere: tuple[tuple[str, float], ...] = ()
    starts_before_file: bool = False
    corners: tuple[CornerZone, ...] = ()
    moves: tuple[MoveSpan, ...] = ()
    frames: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    is_rough: bool = False
    odd: tuple[str, ...] = ()
    contradicted: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    unproven: tuple[UnprovenSpan, ...] = ()
    drives: tuple[str, ...] = ()
    rides: tuple[str, ...] = ()

    def __repr__(self) -> str:
        n_samples, n_joints = self.positions.shape
        span = f"{time_text(self.times[0])} to {time_text(self.times[-1])} s"
        return f"<Trajectory: samples {n_samples}, joints {n_joints}, {span}>"

    def __post_init__(self) -> None:
        require_types(self, joint_names=[str])
        for name in ("times", "positions", "velocities"):
            if getattr(self, name) is not None or name != "velocities":
                names = self.joint_names if name != "times" else ()
                object.__setattr__(self, name, owned(numbers_of(getattr(self, name), names, name)))
        self._refuse_bad_samples()
        if self.wrap not in (None, *WRAPS):
            raise BadInput(f"wrap is {self.wrap!r:.60}", valid=f"one of {', '.join(WRAPS)}")
        if self.velocities is not None:
            self._refuse_bad_velocities(self.velocities)

    @property
    def file_times(self) -> np.ndarray:
        """(m,) [s] The times of its file's samples: without those that were added."""
        times = self.written.times
        return times[1:] if self.starts_before_file else times

    @property
    def n_steps(self) -> int:
        """Number of samples."""
        return len(self.times)

    def of_columns(self, columns: Sequence[int]) -> Trajectory:
        """The same of some of its joints, by their columns."""
        velocities = None if self.velocities is None else self.velocities[:, columns]
        names = tuple(self.joint_names[i] for i in columns)
        points = self.points
        if points is not None:
            values = (points.positions, points.velocities, points.accelerations)
            points = Points(points.times, *(one[:, columns] for one in values))
        extents = None if self.given_extents is None else self.given_extents[:, columns]
        return replace(
            self,
            joint_names=names,
            positions=self.positions[:, columns],
            velocities=velocities,
            points=points,
            given_extents=extents,
        )

    @property
    def written(self) -> Points | Trajectory:
        """The samples that its file has."""
        return self if self.points is None else self.points

    @property
    def not_measured(self) -> tuple[Window, ...]:
        """The stretches of its time [s] that are not measured."""
        return tuple(Window(one.start, one.end) for one in self.holes if one.means == NOT_MEASURED)

    def shifted(self, seconds: float) -> Trajectory:
        """The same, some seconds later.

        Raises:
            BadTime: two of its times round to the same double.
        """
        timing, own = Timing(start=seconds), self.points
        times = timing.run_times(self.times)
        if own is not None:
            own = replace(own, times=timing.run_times(own.times))
        began = None if self.began is None else self.began - seconds
        return replace(
            self,
            times=times,
            holes=_shifted(self.holes, seconds),
            points=own,
            began=began,
            corners=_shifted(self.corners, seconds),
            moves=_shifted(self.moves, seconds),
            unproven=_shifted(self.unproven, seconds),
        )

    def _refuse_bad_samples(self) -> None:
        wanted = (len(np.atleast_1d(self.times)), len(self.joint_names))
        for i, name in enumerate(self.joint_names):
            if name in self.joint_names[:i]:
                raise DuplicateName(f"joint {name!r} is there twice", valid="each joint once")
        if self.times.ndim != 1 or not len(self.times):
            raise BadShape(f"times have shape {self.times.shape}", valid="(n,) with n >= 1")
        if self.positions.shape != wanted:
            raise BadShape(
                f"positions have shape {self.positions.shape}",
                valid=f"{wanted}: a row for each time, a column for each of {', '.join(self.joint_names)}",
            )
        if not (np.isfinite(self.times).all() and np.isfinite(self.positions).all()):
            raise NotFinite("a time or a position is NaN or infinite", valid="finite numbers")
        require_increasing(self.times)

    def _refuse_bad_velocities(self, velocities: np.ndarray) -> None:
        if velocities.shape != np.shape(self.positions):
            raise BadShape(
                f"velocities have shape {velocities.shape}",
                valid=f"that of the positions, {np.shape(self.positions)}",
            )
        if not np.isfinite(velocities).all():
            raise NotFinite("a velocity is NaN or infinite", valid="finite numbers")
        longest = np.diff(self.times).max(initial=0.0)
        with np.errstate(over="ignore"):
            farthest = np.abs(velocities).max(axis=0, initial=0.0) * max(1.0, longest)
        if (farthest > LARGEST).any():
            raise BadDimension(
                f"joint {self.joint_names[int(np.argmax(farthest))]!r} has a velocity that takes it "
                f"{farthest.max():g} rad or m before the next sample",
                valid=f"{LARGEST:g} or less",
            )


Span = TypeVar("Span", Hole, CornerZone, MoveSpan, UnprovenSpan)


def _shifted(spans: Sequence[Span], seconds: float) -> tuple[Span, ...]:
    """The same, some seconds later."""
    return tuple(replace(one, start=one.start + seconds, end=one.end + seconds) for one in spans)
