"""How far along its path a tool is over time: pieces of constant acceleration (trapezoids of speed)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np


class Piece(NamedTuple):
    """A stretch of time in which a share of a path has a constant second derivative.

    Attributes:
        duration: [s]. share, rate, change: of the path at its beginning: the share [-], the first [1/s] and the
            second derivative [1/s^2].
    """

    duration: float
    share: float
    rate: float
    change: float

    def at(self, times: np.ndarray) -> np.ndarray:
        """(n,) the share at times (n,) [s] after its beginning."""
        return self.share + times * (self.rate + 0.5 * self.change * times)

    def rates_at(self, times: np.ndarray) -> np.ndarray:
        """(n,) [1/s] its rate there."""
        return self.rate + self.change * times


class Limits(NamedTuple):
    """How fast a way is gone along at most, and by how much faster each second, in its own size."""

    speed: float
    change: float

    def lasting(self, size: float, seconds: float) -> Limits:
        """Those with which a way of a size takes some time from standstill to standstill: the change stays as it
        is, unless the time is too short for it."""
        change = max(self.change, 4.0 * size / seconds**2)
        root = np.sqrt(max(seconds**2 - 4.0 * size / change, 0.0))
        return Limits(2.0 * size / (seconds + root), change)


UNLIMITED = Limits(np.inf, np.inf)

SHORTEST = 1e-9
"""[s] A piece that is shorter is none."""


def trapezoid(rate: float, change: float, first: float = 0.0, last: float = 0.0) -> list[Piece]:
    """The quickest pieces from share 0 to 1 with a greatest rate [1/s] and a greatest change of rate [1/s^2].

    The path is long enough to change between the rates `first` and `last` at its ends [1/s]; callers check that.
    """
    peak = min(rate, np.sqrt(change + 0.5 * (first**2 + last**2)))
    speeding, slowing = max(peak - first, 0.0) / change, max(peak - last, 0.0) / change
    covered = 0.5 * (first + peak) * speeding + 0.5 * (peak + last) * slowing
    cruising = max(1.0 - covered, 0.0) / peak
    pieces: list[Piece] = []
    share, now = 0.0, first
    for duration, by in ((speeding, change), (cruising, 0.0), (slowing, -change)):
        if duration > SHORTEST:
            pieces.append(Piece(duration, share, now, by))
            share, now = share + duration * (now + 0.5 * by * duration), now + by * duration
    return pieces


def cut_at(pieces: Sequence[Piece], times: np.ndarray) -> Iterator[Piece]:
    """The same pieces, cut at times (m,) [s] from their beginning that lie within them."""
    began = 0.0
    for piece in pieces:
        own = times - began
        inside = own[(own > SHORTEST) & (own < piece.duration - SHORTEST)]
        edges = [0.0, *inside.tolist(), piece.duration]
        for start, end in pairwise(edges):
            share, rate = (float(of(np.array(start))) for of in (piece.at, piece.rates_at))
            yield Piece(end - start, share, rate, piece.change)
        began += piece.duration
