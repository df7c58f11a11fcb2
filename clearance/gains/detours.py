"""Searches for a path from beside it, where no joint moves a pair apart in first order but some may farther off.

A body that passes over another is no farther from it for a small step to the side, and clear of it for a larger.
So each joint between the two is moved by so much, either way, about that moment and all along; the starts that
miss least are gone on from. Not for: a pair that no joint of the path is between (`obstruction`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.gains.offsets import JointOffsets
from clearance.gains.path_change import PathChange
from clearance.gains.search import FINE, Search, SearchResult
from clearance.gains.shortfalls import State
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import has_joint_between

FLAT = 1e-3
"""[-] Of what is missing: where a first step foretells less, the way is not known from it."""

FAR = (0.1, 0.3)
"""[rad] How far a joint is moved."""

WIDE = 0.25
"""[-] Of the splines, how many on either side of the moment move with it."""

MOST_STARTS = 4
"""That are gone on from."""


class FlatMoment(NamedTuple):
    """A pair that falls short where no small step of the path changes its clearance.

    Attributes:
        approach: of the pair. time: [s] of the run.
    """

    approach: Approach
    time: float


def flat_moment(state: State, offsets: PathChange) -> FlatMoment | None:
    """The one that falls short by most; None without one."""
    found: FlatMoment | None = None
    worst = FINE
    for approach in state.near:
        by_unit = offsets.gradient(approach, state.record.timeline)
        missing = state.missing(approach)
        if by_unit is None or missing.max(initial=0.0) <= worst:
            continue
        foretold = np.abs(by_unit) @ offsets.first_reach
        flat = np.where(foretold < FLAT * missing, missing, 0.0)
        row = int(flat.argmax())
        if flat[row] > worst:
            worst, found = float(flat[row]), FlatMoment(approach, float(approach.times[row]))
    return found


def from_detours(search: Search, offsets: PathChange, flat: FlatMoment) -> SearchResult | None:
    """The least that searches from beside a path come to and prove; None where none does."""
    states = [search.state_at(start) for start in _starts(offsets, flat)]
    best: SearchResult | None = None
    for state in sorted(states, key=_rank)[:MOST_STARTS]:
        below = np.inf if best is None else offsets.size(best.state.x)
        found = search.from_state(state, below)
        if found.kept:
            best = found
    return best


def _rank(state: State) -> tuple[bool, float]:
    """What starts are sorted by: those in contact last, then by what the worst moment has above its limit [m].

    How deep they are in contact is not worked out, which takes most of the time.
    """
    worst = state.record.worst
    return state.touches, state.record.rule(worst.rule).limits.fail - worst.clearance


def _starts(offsets: PathChange, flat: FlatMoment) -> Iterator[np.ndarray]:
    """(m,) variables, all within the limits of joints."""
    before, size = 0, len(offsets.first_reach)
    for part in offsets.parts:
        shapes = _shapes(part, flat.time)
        for joint, column in enumerate(part.columns):
            if has_joint_between(flat.approach.case, flat.approach.pair, [column]):
                own = slice(before + joint * part.n_splines, before + (joint + 1) * part.n_splines)
                for shape in shapes:
                    for far in (*FAR, *(-one for one in FAR)):
                        x = np.zeros(size)
                        x[own] = far / part.weights[joint] * shape
                        yield _share_within_limits(offsets, x) * x
        before += part.n_joints * part.n_splines


def _shapes(part: JointOffsets, time: float) -> list[np.ndarray]:
    """(splines,) how far each goes, of 1: about a moment of the run [s], and all alike."""
    splines = np.arange(part.n_splines)
    own = part.basis.at(np.array([part.placed.timing.table_times(time)]))[0]
    if not own.any():
        return []
    off = np.abs(splines - int(own.argmax()))
    return [np.maximum(0.0, 1.0 - off / (1.0 + WIDE * part.n_splines)), np.ones(part.n_splines)]


def _share_within_limits(offsets: PathChange, x: np.ndarray) -> float:
    """[-] The share of a change up to 1 that keeps all limits of joints."""
    grown, most = offsets.inequalities.a @ x, offsets.inequalities.b
    some = grown > most
    return float((most[some] / grown[some]).min(initial=1.0))
