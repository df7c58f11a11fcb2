"""Samples of the joints along one stretch of a tool's path, and how far joints are off the cubics between them,
proven."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.programs.enclosure import Intervals, deviations
from clearance.programs.following import Follower
from clearance.programs.moves import STEP_TURN
from clearance.programs.time_law import Piece
from clearance.world.robot import JointKind

LEAST_IN_CORNER = 8
"""Intervals of a corner zone: with fewer, cells are wide along the path, however finely they are cut across."""


@dataclass(frozen=True, eq=False)
class PathSamples:
    """Samples on one stretch.

    Attributes:
        parts: each piece and its samples (m,) [s] from its beginning.
        times: (n,) [s] from its beginning. shares: (n,) of the way through it.
        positions, velocities: (n, k) of the arm's joints.
        intervals: between them. deviations: (n - 1, k) [rad or m]; infinite where nothing is proven.
    """

    parts: list[tuple[Piece, np.ndarray]]
    times: np.ndarray
    shares: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    intervals: Intervals
    deviations: np.ndarray

    @classmethod
    def of(cls, follower: Follower, pieces: Sequence[Piece], step: float) -> PathSamples:
        """The samples along pieces, so many that the tool, and joints that are told where to go, move and turn by
        no more than a step between them.

        Raises:
            BadInput: the tool cannot go on.
        """
        return cls._at(
            follower,
            [
                (piece, np.linspace(0.0, piece.duration, _n_intervals(follower, piece, step) + 1))
                for piece in pieces
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
        times = [began + own[:-1] for (_, own), began in zip(parts, begun, strict=False)]
        shares = [piece.at(own[:-1]) for piece, own in parts]
        rates = [piece.rates_at(own[:-1]) for piece, own in parts]
        changes = [np.full(len(own) - 1, piece.change) for piece, own in parts]
        last_piece, last_times = parts[-1]
        times_all = np.append(np.concatenate(times), begun[-1])
        shares_all = np.append(np.concatenate(shares), 1.0)
        rates_all = np.append(np.concatenate(rates), last_piece.rates_at(last_times[-1:]))
        changes_all = np.append(np.concatenate(changes), last_piece.change)
        rates_all[np.abs(rates_all) < 1e-9 * np.abs(rates_all).max(initial=0.0)] = 0.0
        strokes = follower.stretch.strokes(shares_all, rates_all, changes_all)
        positions = follower.positions(shares_all)
        velocities = follower.rates(positions, strokes)
        given = Intervals(
            np.diff(times_all),
            positions[:-1],
            positions[1:],
            np.stack([velocities[:-1], velocities[1:]]),
            strokes[:, :-1],
        )
        off = deviations(follower.arm, follower.stretch, given, follower.free)
        return cls(parts, times_all, shares_all, positions, velocities, given, off)


def _n_intervals(follower: Follower, piece: Piece, step: float) -> int:
    """How many intervals a piece needs where it is quickest."""
    stretch = follower.stretch
    share = piece.duration * np.abs(piece.rates_at(np.array([0.0, piece.duration]))).max()
    turned = np.linalg.norm(stretch.turns, axis=1).sum()
    length = sum(way.length for way in stretch.ways)
    turns = [joint.kind is not JointKind.PRISMATIC for joint in follower.arm.joints]
    held = np.abs(follower.joints_on_path.held).sum(axis=0) / np.where(turns, STEP_TURN, step)
    steps = share * max(length / step, turned / STEP_TURN, held.max())
    least = LEAST_IN_CORNER if stretch.is_corner else 1
    return max(least, int(np.ceil(steps - 1e-9)))  # rounding makes no step more
