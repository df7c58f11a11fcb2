"""What it takes to draw a record again: shapes, poses frame by frame, and the line between the
witness points.

The page in a report and the live viewer both draw from this, so they show the same frames. Geometry
and poses are float32, which is for the eye only; times, clearances and witness points stay float64.
Not for: measuring.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from clearance.errors import BadSyntax, MissingFile
from clearance.simulate.moment import Moment
from clearance.simulate.record import Record
from clearance.simulate.replay.bodies import (
    LINK,
    DrawnBody,
    DrawnCarry,
    bodies_of,
    carries_of,
    kind_of,
    packed,
    placed_bodies,
    shape_index,
)
from clearance.simulate.replay.contact import DrawnContact, drawn_contacts
from clearance.simulate.replay.curve_moments import curve_moments
from clearance.simulate.replay.frames import ReplayFrames, least_of
from clearance.simulate.row_status import rule_places
from clearance.simulate.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.world.case import Case
from clearance.world.pairs import BodyIndex

MAX_FRAMES = 3000
"""Most frames kept: at 20 links these are 1.7 MB of poses, and no screen is wider in pixels."""

FILE_NAME = "replay.npz"
_FORMAT = 4


@dataclass(frozen=True)
class DrawnRule:
    """A rule that frames are held against: its name and its limits [m]."""

    name: str
    fail: float
    warn: float


@dataclass(frozen=True, eq=False)
class Replay:
    """The frames of one record.

    Attributes:
        rules: what frames are held against.
        i_worst: the frame of the moment that stands worst against its rule.
        n_steps: number of steps of the record; those of `steps` that are not `between` are frames.
        shapes: vertices (n, 3) float32 [m] and triangles (m, 3) int32 of each different shape.
        poses: for each body (frames, 7) or, where it stands still, (1, 7) float32: xyz [m] and
            quat_xyzw, in the world frame.
        shown: for each body (frames,) or (1,) uint8, 0 while it is not in the cell.
        carries: who carries what from when until when.
        steps, times, clearances: (frames,) step index, [s], [m].
        times_b: (frames,) [s] when the second body of the line is there, if its clock is another; else NaN.
        rule: (frames,) int32 into `rules`, of what judges it.
        between: (frames,) uint8, 1 for a moment between that step and the next, where the motion is worse than at
            both.
        known: (frames,) uint8, 0 where the clearance is only a proven lower bound; then the line has no
            length and nothing is nearest.
        status: (frames,) uint8 indices into `STATUSES`.
        lines: (frames, 6) [m] witness points on the two bodies in the world frame.
        nearest: (frames, 2) int32 indices into `bodies` of the two; -1: there is none.
        contacts: the overlaps that are drawn, frames first.
        regions: of each contact the common region's vertices (n, 3) float32 [m] in the world frame and
            triangles (m, 3) int32.
    """

    name: str
    rules: tuple[DrawnRule, ...]
    n_steps: int
    bodies: tuple[DrawnBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    poses: tuple[np.ndarray, ...]
    shown: tuple[np.ndarray, ...]
    carries: tuple[DrawnCarry, ...]
    i_worst: int
    steps: np.ndarray
    times: np.ndarray
    times_b: np.ndarray
    clearances: np.ndarray
    between: np.ndarray
    known: np.ndarray
    status: np.ndarray
    rule: np.ndarray
    lines: np.ndarray
    nearest: np.ndarray
    contacts: tuple[DrawnContact, ...] = ()
    regions: tuple[tuple[np.ndarray, np.ndarray], ...] = ()

    def save(self, path: Path) -> None:
        """Writes everything into one compressed file; the same replay gives the same bytes."""
        arrays = {name: getattr(self, name) for name in _FRAME_ARRAYS}
        for i, (vertices, triangles) in enumerate(self.shapes):
            arrays[f"vertices_{i}"], arrays[f"triangles_{i}"] = vertices, triangles
        for i, (poses, shown) in enumerate(zip(self.poses, self.shown, strict=True)):
            arrays[f"poses_{i}"], arrays[f"shown_{i}"] = poses, shown
        for i, (vertices, triangles) in enumerate(self.regions):
            arrays[f"region_vertices_{i}"], arrays[f"region_triangles_{i}"] = vertices, triangles
        head = {
            "format": _FORMAT,
            "name": self.name,
            "i_worst": self.i_worst,
            "rules": [asdict(rule) for rule in self.rules],
            "carries": [asdict(carry) for carry in self.carries],
            "n_steps": self.n_steps,
            "n_shapes": len(self.shapes),
            "bodies": [asdict(body) for body in self.bodies],
            "contacts": [asdict(contact) for contact in self.contacts],
        }
        text = json.dumps(head, sort_keys=True).encode()
        np.savez_compressed(path, head=np.frombuffer(text, dtype=np.uint8), **arrays)


_FRAME_ARRAYS = (
    "steps", "times", "times_b", "clearances", "between", "known", "status", "rule", "lines", "nearest",
)  # fmt: skip


def load_replay(path: Path) -> Replay:
    """The replay that `Replay.save` wrote.

    Raises:
        MissingFile: no such file. BadSyntax: it is not a replay of this version.
    """
    if not path.is_file():
        raise MissingFile(
            "no replay here", where=str(path), valid="a folder that `clearance check --out` wrote"
        )
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            head = json.loads(stored["head"].tobytes())
            if head["format"] != _FORMAT:
                raise ValueError(f"format {head['format']}")
            return _from_arrays(head, dict(stored))
    except Exception as error:  # np.load raises many kinds for a damaged archive
        raise BadSyntax(
            f"not a replay of this version ({type(error).__name__}: {error})",
            where=str(path),
            valid="run `clearance check` again",
        ) from None


def _from_arrays(head: dict, arrays: dict[str, np.ndarray]) -> Replay:
    n_shapes, n_bodies = head["n_shapes"], len(head["bodies"])
    return Replay(
        name=head["name"],
        i_worst=head["i_worst"],
        rules=tuple(DrawnRule(**rule) for rule in head["rules"]),
        carries=tuple(DrawnCarry(**carry) for carry in head["carries"]),
        n_steps=head["n_steps"],
        bodies=tuple(DrawnBody(**body) for body in head["bodies"]),
        shapes=tuple((arrays[f"vertices_{i}"], arrays[f"triangles_{i}"]) for i in range(n_shapes)),
        poses=tuple(arrays[f"poses_{i}"] for i in range(n_bodies)),
        shown=tuple(arrays[f"shown_{i}"] for i in range(n_bodies)),
        contacts=tuple(
            DrawnContact(
                **row | {"start": tuple(row["start"]), "direction": tuple(row["direction"])}
            )
            for row in head["contacts"]
        ),
        regions=tuple(
            (arrays[f"region_vertices_{i}"], arrays[f"region_triangles_{i}"])
            for i in range(len(head["contacts"]))
        ),
        **{name: arrays[name] for name in _FRAME_ARRAYS},
    )


def replay_of(
    record: Record, max_frames: int = MAX_FRAMES, rows: MeasuredRows = IN_MEMORY
) -> Replay:
    """The replay of a record: every step, or where there are more than `max_frames` a choice that
    keeps the least clearance of every stretch, the worst step, the step of every pair's minimum,
    the deepest contact, and where something changes hands, comes or goes; and moments between them:
    where the motion is nearer, and on the way where steps are far apart."""
    kept = kept_steps(record, max_frames)
    moments = curve_moments(record)
    contacts, regions = drawn_contacts(record, kept)
    frames = ReplayFrames.of(record, kept, moments, rows)
    indices = bodies_of(record.case)
    drawn = placed_bodies(record, indices, frames.places)
    bodies, shapes = _drawn_bodies(record.case, indices)
    place_of = {
        int(step): i
        for i, step in enumerate(frames.arrays["steps"])
        if not frames.arrays["between"][i]
    }
    return Replay(
        name=record.case.name,
        rules=tuple(DrawnRule(one.name, one.limits.fail, one.limits.warn) for one in record.rules),
        n_steps=record.steps.num_rows,
        bodies=bodies,
        shapes=shapes,
        poses=tuple(packed(poses) for poses in drawn.poses),
        shown=tuple(_once(shown.astype(np.uint8)) for shown in drawn.shown),
        carries=carries_of(record, indices),
        i_worst=_frame_of(record.worst, frames),
        nearest=_nearest(bodies, frames),
        contacts=tuple(replace(one, frame=place_of[int(kept[one.frame])]) for one in contacts),
        regions=regions,
        **frames.arrays,
    )


def _once(values: np.ndarray) -> np.ndarray:
    """The values, or the first alone where all are alike."""
    return values[:1] if (values == values[0]).all() else values


def _frame_of(moment: Moment, frames: ReplayFrames) -> int:
    """The frame of a moment."""
    arrays = frames.arrays
    is_it = (arrays["steps"] == moment.step) & (arrays["between"] == int(moment.between))
    is_it &= ~np.array(moment.between) | (arrays["times"] == moment.time)
    return int(np.argmax(is_it))


def _nearest(bodies: Sequence[DrawnBody], frames: ReplayFrames) -> np.ndarray:
    """(frames, 2) int32 the places of the two bodies of each frame; of a name that is a link's and an obstacle's
    the first is the link."""
    links, others = (
        {body.name: i for i, body in enumerate(bodies) if (body.kind == LINK) == is_link}
        for is_link in (True, False)
    )
    none: dict[str | None, int] = {None: -1}
    first, second = none | others | links, none | links | others
    pairs = [(first[a], second[b]) for a, b in (one.pair for one in frames.places)]
    return np.array(pairs, dtype=np.int32).reshape(-1, 2)


def kept_steps(record: Record, max_frames: int) -> np.ndarray:
    """(frames,) int64 increasing step indices: all, or the choice that `replay_of` describes."""
    clearances = _row_margins(record)
    n_steps = len(clearances)
    if n_steps <= max_frames:
        return np.arange(n_steps)
    pair_steps = [minimum.step for minimum in record.pair_minima]
    deepest = [] if record.deepest is None else [record.deepest.step]
    turns = [phase.first for phase in record.timeline.phases[1:]][: max_frames // 4]
    told = [moment.step for moment in (record.worst, record.nearest) if not moment.between]
    kept = {0, n_steps - 1, record.worst_step, *pair_steps, *deepest, *turns, *told}
    edges = np.linspace(0, n_steps, max(1, (max_frames - len(kept)) // 2) + 1).astype(np.int64)
    starts = np.unique(edges[:-1])
    least = [
        a + int(np.argmin(clearances[a:b]))
        for a, b in zip(starts, [*starts[1:], n_steps], strict=True)
    ]
    return np.array(sorted(kept.union(starts.tolist(), least)), dtype=np.int64)


def _row_margins(record: Record) -> np.ndarray:
    """(n,) [m] what rows are kept by: the clearance, or with several rules how far it is above its fail limit."""
    least = least_of(record.steps)
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
