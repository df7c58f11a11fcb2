"""Overlaps at the steps in contact: which pairs overlap, how deep, in which region.

Called when the clearance of every step is known and some of them are 0; a run without contact does not even
load this module. Work is counted in triangles, not in seconds: the same input gives the same bytes on any machine.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from clearance.errors import ClearanceError
from clearance.geometry.convex_parts import ConvexParts, convex_parts
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import inverse
from clearance.progress import Progress
from clearance.query.contact import BodyPair, Contact
from clearance.query.contact_bounds import bounded_contact
from clearance.query.distance import distance
from clearance.record.names import pair_names
from clearance.record.rows.blocks import blocks
from clearance.simulate.answers.contact.events import (
    MOST_DEEPER,
    MOST_RATED,
    ContactEvent,
    events_of,
    hull_depths,
    rated_places,
)
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import pairs_within
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

MOST_KNOWN = 1000
"""Poses whose overlap is remembered, in case they occur again."""

MOST_VOLUMES = 9
"""Steps of an event at which the volume shared is asked for, and as many again about the best."""


def overlap_finder(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    clearance: np.ndarray,
    nearest: np.ndarray,
    work_out: str,
) -> OverlapFinder:
    """What finds the overlap of every pair in contact, step by step and pair by pair.

    Args:
        clearance: (n,) [m] of every step; those at 0 are checked.
        nearest: (n,) the pair that has it. It is in contact for sure; the others are asked.
        work_out: of which rows depth, volume and separation vector are found: the deepest moment of each of the
            "events", "every" one, or "none".
    """
    touching = [
        block.start + np.flatnonzero(clearance[block] <= 0.0) for block in blocks(len(clearance))
    ]
    steps = np.concatenate(touching)
    return OverlapFinder(
        case, tuple(motions), tuple(pairs), steps, np.array(nearest[steps]), work_out
    )


@dataclass(eq=False)
class OverlapFinder:
    """Overlaps of one run; bodies are cut into parts once, and a pose between two bodies is asked once."""

    case: Case
    motions: tuple[Motion, ...]
    pairs: tuple[Pair, ...]
    steps: np.ndarray
    nearest: np.ndarray
    work_out: str
    _known: dict[tuple[int, bytes], Contact] = field(default_factory=dict)
    _made: dict[int, BodyPair | str] = field(default_factory=dict)
    _notes: dict[str, None] = field(default_factory=dict)

    def touching(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) steps and (n,) pairs in contact, steps first; the nearest pair of a step is one for sure.

        Clouds of points are excluded: what of a ball is in a body says nothing of the thing that was scanned.
        """
        what = PairsInMotion(self.case, self.motions, self.pairs)
        rows, pairs, _ = pairs_within(what, self.steps, 0.0)
        sure = np.arange(len(self.steps)) * len(self.pairs) + self.nearest
        both = np.union1d(rows * len(self.pairs) + pairs, sure)
        rows, pairs = np.divmod(both, len(self.pairs))
        is_solid = ~np.array([pair.has_cloud(self.case) for pair in self.pairs])[pairs]
        return self.steps[rows[is_solid]], pairs[is_solid]

    def chosen(
        self, steps: np.ndarray, pairs: np.ndarray, progress: Progress | None
    ) -> Iterator[tuple[int, Contact]]:
        """The rows that the run works out, each with its overlap in the world frame."""
        if self.work_out == "none":
            return
        if self.work_out == "every":
            rows = ((i, self.contact(int(steps[i]), int(pairs[i]))) for i in range(len(steps)))
            n_rows = len(steps)
        else:
            events = list(events_of(steps, pairs))
            budgets = {event.i_pair: self._budget(event.i_pair) for event in events}
            rows = (self._deepest(event, steps, budgets[event.i_pair]) for event in events)
            n_rows = len(events)
        for n_done, row in enumerate(rows, start=1):
            yield row
            if progress:
                progress(n_done, n_rows)

    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies that were in contact, where it is not they themselves."""
        return tuple(self._notes)

    def contact(self, step: int, i_pair: int) -> Contact:
        """The overlap of a pair that is in contact at a step, in the world frame."""
        b_from_a = self._poses(i_pair, np.array([step]))[0]
        key = (i_pair, b_from_a.tobytes())
        if key not in self._known:
            if len(self._known) >= MOST_KNOWN:
                del self._known[next(iter(self._known))]
            self._known[key] = self._asked(i_pair, b_from_a)
        return self._known[key].placed(self._world_from_b(i_pair, step))

    def _deepest(
        self, event: ContactEvent, steps: np.ndarray, budget: ContactWork
    ) -> tuple[int, Contact]:
        """The row of an event that is worked out, and its overlap; bounds alone beyond the budget."""
        i_pair, n_rows = event.i_pair, len(event.rows)
        if not budget.take_event(n_rows):
            row = event.rows[n_rows // 2]
            return int(row), self._bounded(i_pair, int(steps[row]), budget.why)
        pair = self._pair(i_pair)
        if isinstance(pair, str) or n_rows == 1:
            row = event.rows[n_rows // 2]
            return int(row), self.contact(int(steps[row]), i_pair)
        by_volume = pair.is_rated_by_volume
        self._made[i_pair] = pair = self._near(pair, i_pair, steps[event.rows])
        rated = partial(self._rated, pair, i_pair, steps[event.rows], by_volume)
        if by_volume:
            row = event.rows[rated_places(n_rows, rated, MOST_VOLUMES)[0][0]]
            return int(row), self.contact(int(steps[row]), i_pair)
        places, depths = rated_places(n_rows, rated)
        return self._deepest_by_hulls(i_pair, event.rows[places], depths, steps, budget)

    def _deepest_by_hulls(
        self,
        i_pair: int,
        rows: np.ndarray,
        depths: np.ndarray,
        steps: np.ndarray,
        budget: ContactWork,
    ) -> tuple[int, Contact]:
        """The deepest of some rows; `depths` [m], decreasing: none is deeper than that."""
        best, found = int(rows[0]), self.contact(int(steps[rows[0]]), i_pair)
        for row, depth in zip(rows[1:MOST_DEEPER].tolist(), depths[1:].tolist(), strict=False):
            if depth <= found.penetration or not budget.take_deeper():
                break
            other = self.contact(int(steps[row]), i_pair)
            if other.penetration > found.penetration:
                best, found = row, other
        return best, found

    def _near(self, pair: BodyPair, i_pair: int, steps: np.ndarray) -> BodyPair:
        """The pair with what of large solids can be reached in an event."""
        few = np.unique(
            np.linspace(0, len(steps) - 1, min(len(steps), MOST_RATED)).round().astype(np.int64)
        )
        return pair.near(self._poses(i_pair, steps[few])) if pair.is_rated_by_volume else pair

    def _rated(
        self, pair: BodyPair, i_pair: int, steps: np.ndarray, by_volume: bool, few: np.ndarray
    ) -> np.ndarray:
        """How deep the steps `few` of an event seem to be: [m^3] shared, or [m] of the hulls."""
        poses = self._poses(i_pair, steps[few])
        if by_volume:
            return np.array([_volume_shared(pair, pose) for pose in poses])
        corners = pair.hull_a.vertices, pair.hull_b.vertices
        return hull_depths(*corners, pair.hull_b.normals, poses)

    def _bounded(self, i_pair: int, step: int, why: str) -> Contact:
        a, b = self._shapes(i_pair)
        b_from_a = self._poses(i_pair, np.array([step]))[0]
        near = distance(a, b, pose_a=b_from_a)
        self._note(i_pair, why)
        bounded = bounded_contact(a, b, b_from_a, near.point_b, why)
        return bounded.placed(self._world_from_b(i_pair, step))

    def _asked(self, i_pair: int, b_from_a: np.ndarray) -> Contact:
        """The overlap in the second body's frame, where rounding may part bodies that touch in the world."""
        a, b = self._shapes(i_pair)
        near, pair = distance(a, b, pose_a=b_from_a), self._pair(i_pair)
        if isinstance(pair, str):
            return bounded_contact(a, b, b_from_a, near.point_b, pair)
        return pair.contact(b_from_a, near.point_b)

    def _pair(self, i_pair: int) -> BodyPair | str:
        """The bodies with their parts, or why there are none."""
        if i_pair not in self._made:
            self._made[i_pair] = self._with_parts(i_pair)
        return self._made[i_pair]

    def _with_parts(self, i_pair: int) -> BodyPair | str:
        bodies, names = self._shapes(i_pair), [names[i_pair] for names in self._names]
        parts: list[ConvexParts] = []
        for body, name in zip(bodies, names, strict=True):
            try:
                parts.append(convex_parts(body, rough=self.work_out != "every"))
            except ClearanceError as error:
                self._notes[f"contact: {name}: no depth from below, {error.problem}"] = None
                return f"{name}: {error.problem}"
            if parts[-1].note:
                self._notes[f"contact: {name}: {parts[-1].note}"] = None
        return BodyPair(*bodies, parts[0], parts[1])

    def _note(self, i_pair: int, why: str) -> None:
        links, obstacles = self._names
        self._notes[f"contact: {links[i_pair]} - {obstacles[i_pair]}: {why}"] = None

    def _budget(self, i_pair: int) -> ContactWork:
        return ContactWork(sum(body.n_triangles for body in self._shapes(i_pair)))

    def _world_from_b(self, i_pair: int, step: int) -> np.ndarray:
        b = self.pairs[i_pair].b
        poses = link_poses_at(self.case, self.motions, slice(step, step + 1))
        return b.poses_in(self.case, poses)[0]

    def _poses(self, i_pair: int, steps: np.ndarray) -> np.ndarray:
        """(k, 4, 4) the first body of a pair as the second sees it."""
        pair = self.pairs[i_pair]
        poses = link_poses_at(self.case, self.motions, steps)
        return inverse(pair.b.poses_in(self.case, poses)) @ pair.a.poses_in(self.case, poses)

    def _shapes(self, i_pair: int) -> tuple[Polyhedron, Polyhedron]:
        pair = self.pairs[i_pair]
        return pair.a.shape_in(self.case), pair.b.shape_in(self.case)

    @property
    def _names(self) -> tuple[list[str], list[str]]:
        return pair_names(self.case, self.pairs)


def _volume_shared(pair: BodyPair, b_from_a: np.ndarray) -> float:
    """[m^3] what two solids share at a pose; 0 where that is not known."""
    shared = pair.shared(b_from_a)
    return 0.0 if shared is None else shared.volume


WORK = 30_000_000
"""Of one pair: about 2 s of the machine on which the figures of `query/CONTACT.md` were measured."""

ROW = 300_000
"""An overlap, its bodies however small: 20 ms, most of it calls."""

RATED = 15_000
"""Rating how deep a step may be: 1 ms."""

RATINGS = 18
"""Most ratings of an event."""

PER_TRIANGLE = 12
"""Times that each triangle of both bodies is gone through in an overlap: a solid made of them takes as much."""


@dataclass(eq=False)
class ContactWork:
    """Remaining work for a pair of so many triangles in all."""

    n_triangles: int
    remaining: int = field(default_factory=lambda: WORK)
    remaining_for_deeper: int = field(default_factory=lambda: WORK // 2)

    @property
    def why(self) -> str:
        """What is said of an event that is beyond it."""
        return "beyond the work allowed for a pair: bounds by 26 directions and boxes only"

    def take_event(self, n_steps: int) -> bool:
        """True if the deepest moment of one more event of so many steps may be worked out; it is counted then."""
        n_rated = min(n_steps, RATINGS) if n_steps > 1 else 0
        work = ROW + PER_TRIANGLE * self.n_triangles + n_rated * (RATED + self.n_triangles)
        if work > self.remaining:
            return False
        self.remaining -= work
        return True

    def take_deeper(self) -> bool:
        """True if one more overlap may be worked out to find a deeper one; it is counted then, by itself."""
        work = ROW + PER_TRIANGLE * self.n_triangles
        if work > self.remaining_for_deeper:
            return False
        self.remaining_for_deeper -= work
        return True
