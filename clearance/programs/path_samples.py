"""Samples of the joints along one stretch of a tool's path, and how far joints are off the cubics between them,
proven."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.programs.enclosure import Intervals, deviations
from clearance.programs.following import Follower
from clearance.programs.moves import STEP_TURN
from clearance.programs.time_law import Piece, cut_at
from clearance.world.robot import JointKind

LEAST_IN_CORNER = 8
"""Intervals of a corner zone: with fewer, cells are wide along the path, however finely they are cut across."""


SAME_SPEED = 1e-5
"""[rad/s] or [m/s]: speeds of a joint that differ by less differ by rounding."""


@dataclass(frozen=True, eq=False)
class PathSamples:
    """Samples on one stretch.

    Attributes:
        parts: each piece and its samples (m,) [s] from its beginning.
        times: (n,) [s] from its beginning. shares: (n,) of the way through it.
        positions, velocities: (n, k) of the arm's joints. leaving: (n, k) velocities from then on; others where
            what carries the path changes its speed at once.
        intervals: between them. deviations: (n - 1, k) [rad or m]; infinite where nothing is proven.
    """

    parts: list[tuple[Piece, np.ndarray]]
    times: np.ndarray
    shares: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    leaving: np.ndarray
    intervals: Intervals
    deviations: np.ndarray

    @classmethod
    def of(cls, follower: Follower, pieces: Sequence[Piece], step: float) -> PathSamples:
        """The samples along pieces, so many that the tool, and joints that are told where to go, move and turn by
        no more than a step between them; and at all knots of what carries the path.

        Raises:
            BadInput: the tool cannot go on.
        """
        if follower.ride is not None:
            knots = follower.ride.carriage.knots - follower.ride.began
            pieces = list(cut_at(pieces, knots))
        counts = _n_intervals(follower, pieces, step)
        return cls._at(
            follower,
            [
                (piece, np.linspace(0.0, piece.duration, count + 1))
                for piece, count in zip(pieces, counts, strict=True)
            ],
        )

    def halved(self, follower: Follower, wide: np.ndarray) -> PathSamples:
        """The same with a sample more in the middle of some intervals (n - 1,)."""
        ends = np.cumsum([0, *(len(times) - 1 for _, times in self.parts)])
        parts = []
        for (piece, times), first, last in zip(self.parts, ends, ends[1:], strict=False):
            middles = (0.5 * (times[:-1] + times[1:]))[wide[first:last]]
            parts.append((piece, np.sort(np.concatenate([times, middles]))))
        return self._at(follower, parts)

    @classmethod
    def _at(cls, follower: Follower, parts: list[tuple[Piece, np.ndarray]]) -> PathSamples:
        begun = np.cumsum([0.0, *(piece.duration for piece, _ in parts)])
        each_once = [*((piece, own[:-1]) for piece, own in parts[:-1]), parts[-1]]
        rows = [
            (began + own, piece.at(own), piece.rates_at(own), np.full(len(own), piece.change))
            for (piece, own), began in zip(each_once, begun, strict=False)
        ]
        times, shares, rates, changes = (np.concatenate(one) for one in zip(*rows, strict=True))
        times[-1], shares[-1] = begun[-1], 1.0
        rates[np.abs(rates) < 1e-9 * np.abs(rates).max(initial=0.0)] = 0.0
        strokes, ride = follower.stretch.strokes(shares, rates, changes), follower.ride
        positions = follower.positions(shares if ride is None else times)
        velocities, leaving = _velocities(follower, positions, strokes, times)
        lengths, ends = np.diff(times), np.stack([leaving[:-1], velocities[1:]])
        given = Intervals(lengths, positions[:-1], positions[1:], ends, strokes[:, :-1])
        if ride is not None:
            middles = ride.began + times[:-1] + 0.5 * lengths
            given = given._replace(carried=ride.carriage.series(middles, 0.5 * lengths))
        off = deviations(follower.arm, follower.stretch, given, follower.free)
        return cls(parts, times, shares, positions, velocities, leaving, given, off)


def _velocities(
    follower: Follower, positions: np.ndarray, strokes: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(n, k) how fast the joints come to samples, and leave them; the same but for more than rounding."""
    if follower.ride is None:
        found = follower.rates(positions, strokes)
        return found, found
    come, leave = (
        follower.rates(positions, strokes, follower.ride.moved(times, before))
        for before in (True, False)
    )
    jumps = np.abs(leave - come).max(axis=1, keepdims=True) > SAME_SPEED
    return come, np.where(jumps, leave, come)


def _n_intervals(follower: Follower, pieces: Sequence[Piece], step: float) -> list[int]:
    """How many intervals each piece needs where it is quickest."""
    stretch = follower.stretch
    turned = np.linalg.norm(stretch.turns, axis=1).sum()
    length = sum(way.length for way in stretch.ways)
    turns = [joint.kind is not JointKind.PRISMATIC for joint in follower.arm.joints]
    held = np.abs(follower.joints_on_path.held).sum(axis=0) / np.where(turns, STEP_TURN, step)
    most = max(length / step, turned / STEP_TURN, held.max())
    durations, _, rates, changes = np.array(pieces).T
    fastest = np.maximum(np.abs(rates), np.abs(rates + changes * durations))
    steps = durations * fastest * most
    least = LEAST_IN_CORNER if stretch.is_corner else 1
    if follower.ride is not None:
        steps = np.maximum(steps, durations * _steps_of_tool(follower, durations, step))
        least = -(-least // len(pieces))
    return (
        np.maximum(least, np.ceil(steps - 1e-9)).astype(int).tolist()
    )  # rounding makes no step more


def _steps_of_tool(follower: Follower, durations: np.ndarray, step: float) -> np.ndarray:
    """(pieces,) [1/s] by how many steps the tool moves or turns on a ride, at the ends or the middle of pieces."""
    assert follower.ride is not None
    began = np.cumsum(durations) - durations
    found = []
    for share in (1e-3, 0.5, 1.0 - 1e-3):
        times = began + share * durations
        strokes = follower.ride.strokes(follower.stretch, times)
        rates = follower.tool_rates(strokes, follower.ride.moved(times))
        ways, turns = (np.linalg.norm(rates[:, own], axis=1) for own in (slice(3), slice(3, 6)))
        found.append(np.maximum(ways / step, turns / STEP_TURN))
    return np.asarray(np.max(found, axis=0))
