"""The instants of a body's poses, so that between two of them no point leaves its chord by too much.

How far it may is bounded by `chain_bounds`. Not for: clearances between the steps (`simulate.measure.certify`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.profiles.chain import Chain
from clearance.profiles.chain_bounds import ChainBounds
from clearance.profiles.plane import Plane

MOST_PARTS = 4096
"""Parts of one step: a motion that needs more turns about more than a thousand times."""


@dataclass(frozen=True, eq=False)
class BodyKnots:
    """The instants at which a body is projected.

    Attributes:
        instant: (k,) in steps, increasing; whole numbers are the steps themselves.
        poses: (k, 4, 4) world_from_body [m] there.
        moves: (k - 1,) whether the body moves from each to the next.
        chord: (k - 1,) [m] proven bound of the distance of its points from their chords, in the plane.
        turn: (k - 1,) [rad] how far the direction of view turns in the body to either side of the middle.
        middle: (k - 1, 4, 4) poses in the middle of each interval.
    """

    instant: np.ndarray
    poses: np.ndarray
    moves: np.ndarray
    chord: np.ndarray
    turn: np.ndarray
    middle: np.ndarray


def knots_of(
    chain: Chain, shape: Polyhedron, plane: Plane, limit: float, *, solid: bool, first: int = 0
) -> BodyKnots:
    """The steps, and instants between them, so that no point leaves its chord by more than `limit` [m].

    Args:
        chain: down to the link that carries the shape, at the link's own pose.
        first: the step of the run that the chain's phase begins with.
        solid: bound the distance in space, not in the plane.
    """
    bounds = ChainBounds(chain, shape, plane, solid)
    instants = np.arange(chain.n_steps, dtype=float)
    low, high = instants[:-1], instants[1:]
    done: list[tuple[np.ndarray, ...]] = []
    while len(low):
        chord, turn, middle, moves = bounds.of(low, high)
        fine = (chord <= limit) | (high - low <= 1.0 / MOST_PARTS)
        done.append((low[fine], high[fine], chord[fine], turn[fine], middle[fine], moves[fine]))
        low, high = _split(low[~fine], high[~fine], chord[~fine], limit)
    if not done:
        return standing(chain.poses_at(np.zeros(1))[0, -1], first)
    low, high, chord, turn, middle, moves = (
        np.concatenate(part) for part in zip(*done, strict=True)
    )
    order = np.argsort(low, kind="stable")
    instant = np.append(low[order], high[order[-1]])
    poses = np.ascontiguousarray(chain.poses_at(instant)[:, -1])
    return BodyKnots(first + instant, poses, moves[order], chord[order], turn[order], middle[order])


def standing(pose: np.ndarray, first: int = 0) -> BodyKnots:
    """The one instant of a body that never moves, at a (4, 4) pose [m], from a step on."""
    none, instant = np.zeros(0), np.full(1, float(first))
    return BodyKnots(instant, pose[None], none.astype(bool), none, none, np.zeros((0, 4, 4)))


def _split(low: np.ndarray, high: np.ndarray, chord: np.ndarray, limit: float):
    """Each interval in as many equal parts as its bound needs; the bound falls with the square."""
    parts = np.clip(np.ceil(np.sqrt(1.02 * chord / limit)), 2, 64).astype(int)
    rank = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    low, high, n = np.repeat(low, parts), np.repeat(high, parts), np.repeat(parts, parts)
    ends = low + (high - low) * (rank + 1) / n
    return low + (high - low) * rank / n, np.where(rank + 1 == n, high, ends)
