"""A program's motion: samples of joints and their velocities, and how far joints are off the cubics between,
proven.

Straight lines and arcs of the tool are sampled so finely that every joint is within `PATH_ERROR` of its cubic.
Between two moves without a corner zone the tool stops. Not for: files, and what corner zones take of clearances
(`corner`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from clearance.errors import BadDimension, BadProgram, UnknownLink, at, nearest_name
from clearance.geometry.pose import inverse
from clearance.programs.arm import Arm
from clearance.programs.blends import doubts_on, require_apart
from clearance.programs.carriage import SMOOTH, Carriage
from clearance.programs.carriers import arm_of, on_carriers, start_of
from clearance.programs.corner import PATH_ERROR, corner_of
from clearance.programs.following import Follower, Ride
from clearance.programs.inverse import joints_at
from clearance.programs.joint_corner import JointCorner, bow
from clearance.programs.joint_way import JointWay
from clearance.programs.laid_samples import JumpingSamples, LaidSamples
from clearance.programs.legs import Corner, Leg, PlannedWay, duration_of, legs_of, ways_of
from clearance.programs.moves import STEP_TURN, JointMove, Move, PathMove, Program, ToolChange, Wait
from clearance.programs.path_samples import SAME_SPEED, PathSamples
from clearance.programs.time_law import Piece
from clearance.programs.tool_path import Stretch, line
from clearance.world.notice import listed
from clearance.world.robot import Robot
from clearance.world.trajectory import CornerZone, MoveSpan, Trajectory, UnprovenSpan

MOST_HALVINGS = 8
"""Times that intervals are halved until that is proven."""

MOST_WIDE = 4096
"""Intervals that are halved at once; where more are not proven, halves would not be either."""


@dataclass(frozen=True, eq=False)
class ProgramMotion:
    """What a program makes a robot do.

    Attributes:
        trajectory: samples with velocities; its `path_error` holds for lines and arcs.
        notes: what was assumed, one line each. doubtful: the same that a verdict has to name.
    """

    trajectory: Trajectory
    notes: tuple[str, ...] = ()
    doubtful: tuple[str, ...] = ()


def motion_of(robot: Robot, program: Program) -> ProgramMotion:
    """The motion of a program.

    Raises:
        BadInput: a target that cannot be reached, a joint beyond its limits, a singularity on the way: with the
            move, where the tool is, and the joints. UnknownLink, UnknownJoint: with the nearest name.
    """
    if program.link not in robot.link_names:
        valid = nearest_name(program.link, robot.link_names)
        raise UnknownLink(f"there is no link {program.link!r}", where="tool.link", valid=valid)
    if not 1e-5 <= program.step <= 1.0:
        raise BadDimension(f"a step of {program.step * 1e3:g} mm", valid="0.01 to 1000 mm")
    program = on_carriers(robot, program)
    arm = arm_of(robot, program)
    samples = _Samples(arm, program, start_of(arm, program))
    for part in program.parts:
        seen_from = "" if part.seen_from in program.carriages else part.seen_from
        samples.arm = arm = replace(arm, link_from_tool=part.link_from_tool, seen_from=seen_from)
        for run in part.runs:
            carriage = program.carriage_of(run)
            ways = ways_of(arm, run, samples.at, carriage, samples.now)
            samples.note_targets(ways, carriage)
            if program.skips_overlaps:
                require_apart(arm, ways)
            for leg in legs_of(arm, ways):
                with at(leg.move.where):
                    samples.add(leg)
    return samples.motion()


@dataclass(eq=False)
class _Samples:
    """The samples of legs, one after another.

    Attributes:
        at: (k,) where the joints are. error: [rad or m] the greatest proven deviation on lines and arcs.
        rides: the move before is on a carriage. may_jump: it is, or that of now, so that speeds change at once.
    """

    arm: Arm
    program: Program
    at: np.ndarray
    error: float = 0.0
    rides: bool = False
    may_jump: bool = False
    spans: list[MoveSpan] = field(default_factory=list)
    corners: list[CornerZone] = field(default_factory=list)
    unproven: list[UnprovenSpan] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    doubtful: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.laid = LaidSamples(self.at)

    @property
    def now(self) -> float:
        """[s] When the next leg begins."""
        return self.laid.now

    def add(self, leg: Leg) -> None:
        """Samples what a leg makes of the joints."""
        began, rides = self.now, self._carriage_of(leg.move) is not None
        self.may_jump = rides or self.rides
        if isinstance(leg.move, Wait) and leg.move.seen_from:
            self._ride(leg.move)
        elif isinstance(leg.move, Wait):
            still, times = np.zeros((2, len(self.at))), np.array([0.0, leg.move.seconds])
            self.laid.add(times, self.at + still, still, still, self.may_jump)
        elif leg.way is None and leg.corner is not None:
            self._beside_joints(leg, leg.corner)
        elif isinstance(leg.way, JointWay):
            self._straight(leg, leg.way)
        elif leg.way is not None and isinstance(leg.move, PathMove):
            self._along(leg, leg.way)
        self.rides = rides
        self._require_limits(self.laid.positions[-1])
        if self.spans and self.spans[-1].name == leg.move.name:
            self.spans[-1] = replace(self.spans[-1], end=self.now)
        else:
            self.spans.append(MoveSpan(leg.move.name, began, self.now, leg.move.where))

    def _carriage_of(self, move: Move) -> Carriage | None:
        """What the tool goes on with in a move."""
        own = move.seen_from if isinstance(move, PathMove | Wait) else ""
        return self.program.carriages.get(own)

    def note_targets(self, ways: Sequence[PlannedWay], carriage: Carriage | None) -> None:
        """Says which joints are taken in moves to a pose; on a carriage, when it is there."""
        names = [joint.name for joint in self.arm.joints]
        for move, way, *_ in ways:
            if isinstance(way, JointWay) and isinstance(move, JointMove) and move.pose is not None:
                target = np.round(way.target, 9) + 0.0  # 0 but for rounding is 0, and never -0
                texts = [f"{name} {at:.4g}" for name, at in zip(names, target, strict=True)]
                when = ""
                if carriage is not None:
                    arrival = self.now + duration_of(self.arm, move, way)
                    when = f", where {carriage.name!r} is at {arrival:.3f} s when they arrive,"
                self.notes.append(
                    f"{move.name}: the nearest joints found for its pose{when} are taken [rad or m]: "
                    + ", ".join(texts)
                )

    def motion(self) -> ProgramMotion:
        """All of them, joints that are not of the arm at rest."""
        own = [joint.name for joint in self.arm.joints]
        others = [name for name in self.program.start if name not in own]
        samples = self.laid.joined(self.program.carriages.values())
        times, positions, velocities, off = samples.without_jumps(0.25 * PATH_ERROR)
        rest = np.tile(np.array([self.program.start[name] for name in others]), (len(positions), 1))
        trajectory = Trajectory(
            times=times,
            joint_names=(*own, *others),
            positions=np.hstack([positions, rest]),
            velocities=np.hstack([velocities, np.zeros_like(rest)]),
            path_error=self.error + off,
            corners=tuple(self.corners),
            moves=tuple(self.spans),
            unproven=tuple(self.unproven),
        )
        notes = (*self._on_carriages(), *self.notes)
        return ProgramMotion(trajectory, notes, (*self._on_jumps(samples), *self.doubtful))

    def _on_carriages(self) -> Iterator[str]:
        """A line for each thing that moves by itself, on the moves that go with it."""
        for name in self.program.carriages:
            moves = [
                one.name for one in self.program.moves
                if not isinstance(one, ToolChange) and one.seen_from == name
            ]  # fmt: skip
            yield f"{listed(moves, 8)}: seen from {name!r}, which moves by itself"

    def _on_jumps(self, samples: JumpingSamples) -> Iterator[str]:
        """A line on where the tool changes its speed at once, by more than from row to row of a table."""
        i = samples.jumps
        by = samples.leave[i] - samples.come[i]
        _, rates = self.arm.tool.poses_and_rates(samples.positions[i])
        changes = (rates @ by[..., None])[..., 0]
        ways, turns = (np.linalg.norm(changes[:, own], axis=1) for own in (slice(3), slice(3, 6)))
        told = np.flatnonzero((ways > SMOOTH) | (turns > SMOOTH))
        if not self.program.carriages or not len(told):
            return
        sizes, unit = (ways, "m/s") if (ways > SMOOTH).any() else (turns, "rad/s")
        most = int(np.argmax(sizes))
        times = f"{len(told)} times, most" if len(told) > 1 else "once,"
        yield (
            f"the tool takes on, or loses, the speed of {listed([*self.program.carriages])} at once ({times} by "
            f"{sizes[most]:.3g} {unit} at {samples.times[i[most]]:.3f} s); a real robot lags, which is not counted"
        )

    def _ride(self, wait: Wait) -> None:
        """The tool stays where it is on a carriage."""
        carriage = self.program.carriages[wait.seen_from].at(np.array([self.now])).poses[0]
        pose = inverse(carriage) @ self.arm.poses(self.at[None])[0]
        self._along(Leg(wait, pieces=(Piece(wait.seconds, 0.0, 0.0, 0.0),)), line(pose, pose))

    def _straight(self, leg: Leg, way: JointWay) -> None:
        """All joints in proportion; exact, since a cubic holds what a constant acceleration makes of them."""
        if not leg.pieces:
            return
        for piece in leg.pieces:
            moved = way.joints(piece.at(np.linspace(0.0, piece.duration, 33)))
            n = self._n_samples(self.arm.poses(moved))
            times = np.linspace(0.0, piece.duration, n + 1)
            rates = way.share * piece.rates_at(times)[:, None] * way.whole
            self.laid.add(times, way.joints(piece.at(times)), rates, rates, self.may_jump)
        self.at = way.joints(np.ones(1))[0]
        self.laid.end_at(self.at, way.last == 1.0)

    def _along(self, leg: Leg, stretch: Stretch) -> None:
        """What the tool's path makes of the joints."""
        if not leg.pieces:
            return
        move, carriage = leg.move, self._carriage_of(leg.move)
        ride = None if carriage is None else Ride(carriage, self.now, leg.pieces)
        if ride is not None:
            ride.carriage.require_known(self.now + ride.duration)
        follower = Follower(self.arm, stretch, self.at, ride)
        samples, wide = self._enclosed(follower, leg.pieces, self._seam)
        if leg.corner is not None:
            corner = stretch.poses(np.array([[1.0, 0.0]]))
            if ride is not None:
                corner = ride.moved(np.array([0.5 * ride.duration])).poses @ corner
            near = samples.positions[len(samples.positions) // 2]
            self._require_limits(joints_at(self.arm.tool, corner, near[None]).positions)
        if leg.corner is not None and not wide.any():
            zone = corner_of(follower, samples, self.now, leg.corner.radius, move.name)
            if zone is None:
                self._leave_unproven(move, samples.times[[0, -1]], _too_wide(leg.corner.radius))
            else:
                self._add_corner(zone, leg.corner)
        elif leg.corner is not None:
            self._leave_unproven(move, samples.times[[0, -1]], SINGULAR)
        for first, last in _stretches_of(wide):
            self._leave_unproven(move, samples.times[[first, last]], SINGULAR)
        self.laid.add(
            samples.times, samples.positions, samples.velocities, samples.leaving, self.may_jump
        )
        self.at = samples.positions[-1]

    def _enclosed(
        self,
        follower: Follower,
        pieces: Sequence[Piece],
        seam: Callable[[PathSamples], float] = lambda _: 0.0,
    ) -> tuple[PathSamples, np.ndarray]:
        """Samples so near to each other that joints between them are within `PATH_ERROR` of their cubics, and
        (n - 1,) between which of them that is not proven."""
        samples = PathSamples.of(follower, pieces, self.program.step)
        for n_halved in range(MOST_HALVINGS + 1):
            off = samples.deviations.max(axis=1)
            off[0] += seam(samples)
            wide = off > PATH_ERROR
            if not wide.any() or n_halved == MOST_HALVINGS or wide.sum() > MOST_WIDE:
                break
            samples = samples.halved(follower, wide)
        self.error = max(self.error, float(off[~wide].max(initial=0.0)))
        return samples, wide

    def _leave_unproven(self, move: Move, ends: np.ndarray, why: str) -> None:
        """Tells of a stretch that begins and ends so many seconds from now."""
        start, end = (self.now + ends).tolist()
        self.unproven.append(UnprovenSpan(move.name, start, end, why))

    def _add_corner(self, zone: CornerZone, corner: Corner) -> None:
        self.corners.append(zone)
        self.notes.append(_note_on(zone, corner))
        if self.program.skips_overlaps:
            self.doubtful += doubts_on(corner)

    def _beside_joints(self, leg: Leg, corner: Corner) -> None:
        """The corner zone between two moves of which one is a joint move."""
        (piece,), joints, wide, is_proven = leg.pieces, [self.at], np.zeros(len(self.at)), True
        for side in corner.sides:
            if isinstance(side, JointWay):
                joints.append(side.joints(np.ones(1))[0])
                last = side.share * side.whole
                continue
            follower = Follower(self.arm, side, joints[-1])
            samples, narrow = self._enclosed(follower, [Piece(1.0, 0.0, 1.0, 0.0)])
            is_proven = is_proven and not narrow.any()
            joints.append(samples.positions[-1])
            last, wide = samples.velocities[-1], np.maximum(wide, bow(samples))
        self._require_limits(np.array(joints))
        rates = np.stack([self.laid.rates, 2.0 * piece.rate * last])
        zone = JointCorner(joints[0], joints[1], joints[2], rates, wide, piece.duration)
        n = self._n_samples(self.arm.poses(zone.samples(32)[1]))
        times, positions, velocities = zone.samples(n)
        if is_proven:
            ends, links = (self.now, self.now + piece.duration), zone.links_off(self.arm, n)
            found = CornerZone(leg.move.name, *ends, corner.radius, links)
            self._add_corner(found, corner)
        else:
            self._leave_unproven(leg.move, times[[0, -1]], SINGULAR)
        self.laid.add(times, positions, velocities, velocities, self.may_jump)
        self.at = positions[-1]

    def _seam(self, samples: PathSamples) -> float:
        """[rad or m] How far the first cubic is off that of the samples, as it begins like what was before.

        Raises:
            BadInput: joints would change their speed at once, since moves that a zone joins hold others.
        """
        rates = np.abs(samples.leaving[0] - self.laid.rates).max()
        if rates > SAME_SPEED and self.may_jump:
            rates = 0.0  # the first cubic begins as the samples do
        if rates > SAME_SPEED:
            raise BadProgram(
                "a joint changes its speed at once where a corner zone begins or ends",
                where="hold",
                valid="hold the same joints on both sides of a zone, where they are",
            )
        return float(np.abs(samples.positions[0] - self.at).max() + samples.times[1] * rates)

    def _n_samples(self, poses: np.ndarray) -> int:
        """How many samples a motion through poses needs where it is quickest."""
        n = len(poses) - 1
        ways = n * np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).max()
        turned = np.swapaxes(poses[:-1, :3, :3], 1, 2) @ poses[1:, :3, :3]
        cosines = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
        turns = n * np.arccos(np.clip(cosines, -1.0, 1.0)).max()
        return max(1, int(np.ceil(ways / self.program.step)), int(np.ceil(turns / STEP_TURN)))

    def _require_limits(self, positions: np.ndarray) -> None:
        """Nothing, if joints at positions (n, k) are within their limits.

        Raises:
            BadInput: the first that is not, with the joint and where the tool is then.
        """
        low, high = self.arm.ranges.T
        beyond = np.maximum(low - positions, positions - high)
        joint = int(np.argmax(beyond.max(axis=0)))
        if beyond[:, joint].max() > 0.0:
            row = int(np.argmax(beyond[:, joint] > 0.0))
            place = self.arm.place(self.arm.poses(positions[row : row + 1])[0])
            raise BadProgram(
                f"joint {self.arm.joints[joint].name!r} is beyond its limit at {place}",
                valid=f"{low[joint]:.4g} to {high[joint]:.4g}",
            )


SINGULAR = "a singularity is too near"
"""Why joints are not enclosed: none else is known."""


def _too_wide(radius: float) -> str:
    return f"a corner zone of {radius * 1e3:.4g} mm is too wide to be proven where the arm is"


def _stretches_of(wide: np.ndarray) -> Iterator[tuple[int, int]]:
    """The first and the last sample of each row of intervals (n,) that are marked."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], wide, [False]]).astype(int)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def _note_on(zone: CornerZone, corner: Corner) -> str:
    """What a corner zone is taken to admit."""
    most, asked = max(off.way for off in zone.links.values()), corner.moves[0].zone
    before = "" if zone.radius == asked else f" from {asked * 1e3:.4g} mm"
    cut = f" (cut{before}: at most half of a move)" if corner.is_cut else ""
    if corner.joints is not None:
        paths = "paths of the joints in its triangle"
    elif any(isinstance(side, Stretch) and side.ways[0].bend for side in corner.sides):
        paths = "paths of the tool in the hull of its triangle and arcs"
    else:
        paths = "paths of the tool in its triangle"
    return (
        f"corner zone of {zone.radius * 1e3:.4g} mm{cut} after {zone.name}, {zone.start:.3f} to "
        f"{zone.end:.3f} s: all {paths} count; origins of links are up to {most * 1e3:.3g} mm off the nominal path"
    )
