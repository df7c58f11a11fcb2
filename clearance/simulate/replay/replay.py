"""Makes the drawing data of a record: every step or a choice of them, with the moments between.

The motion before a change is drawn by the bodies that were elsewhere, at the same times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clearance.record.contact import StepContact
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.replay import (
    LINK,
    DrawnBody,
    DrawnContact,
    DrawnMoment,
    DrawnRule,
    EarlierBody,
    Replay,
)
from clearance.record.row_status import rule_places
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.record.status import STATUSES, Status
from clearance.simulate.answers.measured_run import MeasuredRun
from clearance.simulate.replay.bodies import (
    FramePlace,
    carries_of,
    kind_of,
    packed,
    placed_bodies,
    shape_index,
)
from clearance.simulate.replay.curve_moments import curve_moments
from clearance.simulate.replay.frames import ReplayFrames, least_of
from clearance.world.case import Case
from clearance.world.motion import place_in
from clearance.world.pairs import BodyIndex, bodies_of

if TYPE_CHECKING:
    from clearance.query.contact import Contact

MAX_FRAMES = 3000
"""Most frames selected: at 20 links these are 1.7 MB of poses, and no screen is wider in pixels."""


def replay_of(
    run: MeasuredRun,
    max_frames: int = MAX_FRAMES,
    rows: MeasuredRows = IN_MEMORY,
    worst: Moment | None = None,
) -> Replay:
    """The replay of a record: every step, or where there are more than `max_frames` a choice that
    keeps the least clearance of every stretch, the worst step, the step of every pair's minimum,
    the deepest contact, and where something changes hands, comes or goes; and moments between them:
    where the motion is nearer, and on the way where steps are far from each other.

    Args:
        worst: the most critical moment; that of the record if it is not given.
    """
    record = run.record
    worst = worst or record.worst
    steps, moments = frame_steps(run, max_frames, worst), curve_moments(run, worst)
    contacts, regions = drawn_contacts(run, steps)
    frames = ReplayFrames.of(record, steps, moments, rows)
    indices = bodies_of(record.case)
    drawn = placed_bodies(record, indices, frames.places)
    bodies, shapes = _drawn_bodies(record.case, indices)
    move, moves = record.moves.codes(frames.arrays["times"])
    place_of = {
        int(step): i
        for i, step in enumerate(frames.arrays["steps"])
        if not frames.arrays["between"][i]
    }
    return Replay(
        name=record.case.name,
        rules=tuple(DrawnRule(one.name, one.limits.fail, one.limits.warn) for one in record.rules),
        n_steps=record.rows.n_rows,
        bodies=bodies,
        shapes=shapes,
        poses=tuple(packed(poses) for poses in drawn.poses),
        shown=tuple(_once(shown.astype(np.uint8)) for shown in drawn.shown),
        carries=carries_of(record, indices),
        worst=_drawn_worst(record, worst, frames, bodies),
        nearest=_places_of(bodies, [one.pair for one in frames.places]),
        move=move.astype(np.int32),
        moves=tuple(moves),
        unmeasured=_unmeasured(record),
        contacts=tuple(replace(one, frame=place_of[int(steps[one.frame])]) for one in contacts),
        regions=regions,
        **frames.arrays,
    )


def _unmeasured(record: Record) -> tuple[tuple[float, float], ...]:
    """The stretches [s] between steps without a bound, as no pair is left there; those that meet are one."""
    if record.certificate is None:
        return ()
    times = record.timeline.times
    steps = np.flatnonzero(np.isinf(record.certificate.lower_bound[:-1]))
    runs = np.split(steps, np.flatnonzero(np.diff(steps) > 1) + 1)
    return tuple((float(times[run[0]]), float(times[run[-1] + 1])) for run in runs if len(run))


def _once(values: np.ndarray) -> np.ndarray:
    """The values, or the first alone where all are alike."""
    return values[:1] if (values == values[0]).all() else values


def _frame_of(moment: Moment, frames: ReplayFrames) -> int:
    """The frame of a moment."""
    arrays = frames.arrays
    is_it = (arrays["steps"] == moment.step) & (arrays["between"] == int(moment.between))
    is_it &= ~np.array(moment.between) | (arrays["times"] == moment.time)
    return int(np.argmax(is_it))


def _drawn_worst(
    record: Record, moment: Moment, frames: ReplayFrames, bodies: Sequence[DrawnBody]
) -> DrawnMoment:
    """The most critical moment, of its own pair: another may be nearer in its frame, and waived."""
    code = STATUSES.index(Status(record.status_of(moment)))
    first, second = _places_of(bodies, [(moment.link, moment.obstacle)])[0].tolist()
    line = (*map(float, moment.point_link), *map(float, moment.point_obstacle))
    return DrawnMoment(
        _frame_of(moment, frames), float(moment.clearance), code, line, (first, second)
    )


def _places_of(
    bodies: Sequence[DrawnBody], named: Sequence[tuple[str | None, str | None]]
) -> np.ndarray:
    """(n, 2) int32 the places of the two bodies of pairs; of a name that is a link's and an obstacle's the first
    is the link."""
    links, others = (
        {body.name: i for i, body in enumerate(bodies) if (body.kind == LINK) == is_link}
        for is_link in (True, False)
    )
    none: dict[str | None, int] = {None: -1}
    first, second = none | others | links, none | links | others
    pairs = [(first[a], second[b]) for a, b in named]
    return np.array(pairs, dtype=np.int32).reshape(-1, 2)


def frame_steps(run: MeasuredRun, max_frames: int, worst: Moment) -> np.ndarray:
    """(frames,) int64 increasing step indices: all, or the choice that `replay_of` describes."""
    record = run.record
    clearances = _row_margins(record)
    n_steps = len(clearances)
    if n_steps <= max_frames:
        return np.arange(n_steps)
    pair_steps = [minimum.step for minimum in run.pair_minima()]
    deepest = [] if record.deepest is None else [record.deepest.step]
    turns = [phase.first for phase in record.timeline.phases[1:]][: max_frames // 4]
    reported = [
        moment.step for moment in (record.worst, record.nearest, worst) if not moment.between
    ]
    selected = {0, n_steps - 1, record.worst_step, *pair_steps, *deepest, *turns, *reported}
    edges = np.linspace(0, n_steps, max(1, (max_frames - len(selected)) // 2) + 1).astype(np.int64)
    starts = np.unique(edges[:-1])
    least = [
        a + int(np.argmin(clearances[a:b]))
        for a, b in zip(starts, [*starts[1:], n_steps], strict=True)
    ]
    return np.array(sorted(selected.union(starts.tolist(), least)), dtype=np.int64)


def _row_margins(record: Record) -> np.ndarray:
    """(n,) [m] the clearance by which rows are selected, with several rules its excess over the fail limit."""
    least = least_of(record.rows)
    if len(record.rules) == 1:
        return least
    return least - np.array([one.limits.fail for one in record.rules])[rule_places(record)]


def _drawn_bodies(case: Case, indices: Sequence[BodyIndex]) -> tuple[tuple, tuple]:
    """What each body is, and the shapes."""
    shapes: list[tuple[np.ndarray, np.ndarray]] = []
    seen: dict[bytes, int] = {}
    bodies = tuple(
        DrawnBody(
            body.name_in(case),
            kind_of(case, body),
            body.is_obstacle
            or body.own_name_in(case) not in case.robots[body.i_robot].exclude_links,
            shape_index(body.shape_in(case), shapes, seen),
            body.i_robot,
        )
        for body in indices
    )
    return bodies, tuple(shapes)


MOST_CONTACTS = 600
"""Most overlaps drawn: each is an object of its own in the viewer."""

MOST_TRIANGLES = 200_000
"""Most triangles of all regions together: about 5 MB on the page."""


def drawn_contacts(
    run: MeasuredRun, steps: np.ndarray
) -> tuple[tuple[DrawnContact, ...], tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """The overlaps that the run works out at `steps`, and the region of each: vertices (n, 3) float32,
    triangles (m, 3) int32.

    Beyond `MOST_CONTACTS` or `MOST_TRIANGLES`, every second, third, … contact; always the deepest.
    """
    frames = {int(step): i for i, step in enumerate(steps)}
    rows = [row for row in run.record.worked_out if row.step in frames]
    chosen = _decimated(run, rows)
    return (
        tuple(_drawn(row, found, frames[row.step]) for row, found in chosen),
        tuple(
            (found.region.vertices.astype(np.float32), found.region.triangles.astype(np.int32))
            for _, found in chosen
        ),
    )


def _decimated(run: MeasuredRun, rows: Sequence[StepContact]) -> list[tuple[StepContact, Contact]]:
    every, deepest = max(1, -(-len(rows) // MOST_CONTACTS)), run.record.deepest
    while True:
        chosen = [row for i, row in enumerate(rows) if i % every == 0 or _same(row, deepest)]
        if len(chosen) <= MOST_CONTACTS:
            found = [(row, run.overlap(row)) for row in chosen]
            n_triangles = sum(len(one.region.triangles) for _, one in found)
            if len(chosen) <= 2 or n_triangles <= MOST_TRIANGLES:
                return found
        every += 1


def _same(row: StepContact, other: StepContact | None) -> bool:
    return other is not None and (row.step, row.link, row.obstacle) == (
        other.step,
        other.link,
        other.obstacle,
    )


def _drawn(row: StepContact, found: Contact, frame: int) -> DrawnContact:
    return DrawnContact(
        frame=frame,
        link=row.link,
        obstacle=row.obstacle,
        penetration=found.penetration,
        penetration_at_least=found.penetration_at_least,
        volume=found.volume,
        volume_at_least=found.volume_at_least,
        exact=bool(found.exact[0]),
        volume_exact=bool(found.exact[1]),
        start=tuple(found.centroid.tolist()),
        direction=tuple(found.direction.tolist()),
    )


MOVED = 1e-6
"""[m] and, of unit quaternions, [-]: a body that was off by less is not drawn twice."""


def earlier_motion(earlier: Record, replay: Replay) -> list[EarlierBody]:
    """The bodies of a replay that were elsewhere at some frame.

    Args:
        earlier: a run of the same bodies.
    """
    places = (place_in(earlier.timeline.times, time) for time in replay.times)
    frames = [FramePlace(*place, None, (None, None)) for place in places]
    drawn = placed_bodies(earlier, bodies_of(earlier.case), frames)
    was = [packed(poses) for poses in drawn.poses]
    return [
        EarlierBody(i, before, shown.astype(np.uint8))
        for i, (before, after, shown) in enumerate(zip(was, replay.poses, drawn.shown, strict=True))
        if (np.abs(before - after) > MOVED).any()
    ]
