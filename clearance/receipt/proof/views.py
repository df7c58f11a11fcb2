"""From where each pair is looked at: the nearest link above both of its bodies, so that only joints between count.

Not for: where things are seen (`placing`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.motion_data import NONE, Stretch


class Views(NamedTuple):
    """Bodies as they are seen.

    Attributes:
        above: (frames,) the frame that each hangs on as it is seen, or `NONE`; parents first.
        links: (frames,) whose joint it hangs by.
        frames: (views,) the frame that a seen body is fixed to, or `NONE`: then it stands at `poses`.
        poses: (views, 4, 4) [m]. bodies: (views,) which body is seen.
        pairs: (p, 2) the views of a stretch's pairs.
    """

    above: np.ndarray
    links: np.ndarray
    frames: np.ndarray
    poses: np.ndarray
    bodies: np.ndarray
    pairs: np.ndarray

    def frames_of(self, views: np.ndarray) -> np.ndarray:
        """(frames,) True for those that carry some views."""
        wanted = np.zeros(len(self.above), dtype=bool)
        frames = self.frames[views]
        wanted[frames[frames != NONE]] = True
        for frame in np.flatnonzero(self.above != NONE)[::-1]:
            wanted[self.above[frame]] |= wanted[frame]
        return wanted


def views_of(stretch: Stretch) -> Views:
    """The views of all pairs of a stretch."""
    return _ViewCollector(stretch).views()


def chain_above(above: np.ndarray, one: int) -> list[int]:
    """One and all above it, nearest first; `above` (n,) is `NONE` at the top."""
    found = []
    while one != NONE:
        found.append(one)
        one = int(above[one])
    return found


class _ViewCollector:
    """Gathers frames and views, each once."""

    def __init__(self, stretch: Stretch) -> None:
        self.stretch = stretch
        self.frames: dict[tuple[int, int], int] = {}  # (the link looked from, the link seen)
        self.above: list[int] = []
        self.seen: dict[tuple[int, int], int] = {}  # (the link looked from, the body)

    def views(self) -> Views:
        pairs = np.array([self._pair(a, b) for a, b in self.stretch.pairs.tolist()])
        poses = np.tile(np.eye(4), (len(self.seen), 1, 1))
        frames = np.full(len(self.seen), NONE)
        for view, (reference, body) in enumerate(self.seen):
            link = int(self.stretch.carriers[body])
            if link == NONE:
                poses[view] = self.stretch.poses[body]
            elif link != reference:
                frames[view] = self.frames[reference, link]
        links = np.array([link for _, link in self.frames], dtype=np.int64)
        bodies = np.array([body for _, body in self.seen])
        above = np.array(self.above, dtype=np.int64)
        return Views(above, links, frames, poses, bodies, pairs.reshape(-1, 2))

    def _pair(self, a: int, b: int) -> tuple[int, int]:
        one, other = (int(self.stretch.carriers[body]) for body in (a, b))
        parents = self.stretch.joints.parents
        others = set(chain_above(parents, other))
        reference = next((link for link in chain_above(parents, one) if link in others), NONE)
        return self._view(reference, a, one), self._view(reference, b, other)

    def _view(self, reference: int, body: int, link: int) -> int:
        if link not in (NONE, reference):
            self._frame(reference, link)
        return self.seen.setdefault((reference, body), len(self.seen))

    def _frame(self, reference: int, link: int) -> int:
        if (reference, link) not in self.frames:
            parent = int(self.stretch.joints.parents[link])
            above = NONE if parent in (NONE, reference) else self._frame(reference, parent)
            self.above.append(above)
            self.frames[reference, link] = len(self.above) - 1
        return self.frames[reference, link]
