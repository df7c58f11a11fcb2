"""The frames of a replay: which steps and moments there are, and what was found at each.

Not for: shapes and poses (`replay`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from clearance.simulate.moment import Moment
from clearance.simulate.parts import blocks
from clearance.simulate.record import Record
from clearance.simulate.resumable_rows import MeasuredRows
from clearance.simulate.status import STATUSES, status_codes
from clearance.simulate.steps import between_of
from clearance.world.motion import Motion

MOST_MOMENTS = 500
"""Most moments between steps that are frames of their own, the least first."""


def kept_moments(record: Record) -> list[Moment]:
    """The moments between steps at which the motion is worse than at both, and that of its least clearance."""
    certificate = record.certificate
    if certificate is None:
        return []
    steps = np.flatnonzero(between_of(record.steps) & (certificate.pair >= 0))
    least_first = steps[np.argsort(certificate.upper_bound[steps], kind="stable")][:MOST_MOMENTS]
    chosen = set(least_first.tolist())
    if record.worst is not record.worst_sample:
        chosen.add(certificate.nearest_between)
    return [certificate.moment_of(step) for step in sorted(chosen)]


@dataclass(frozen=True, eq=False)
class ReplayFrames:
    """The kept steps and the moments between them, in order of time.

    Attributes:
        arrays: by name as in `Replay`. pairs: link and obstacle of each frame, None where a bound decides.
        positions: of each robot's joints, (frames, k).
    """

    arrays: dict[str, np.ndarray]
    pairs: list[tuple[str | None, str | None]]
    positions: list[np.ndarray]

    @staticmethod
    def of(
        record: Record, kept: np.ndarray, moments: Sequence[Moment], rows: MeasuredRows
    ) -> ReplayFrames:
        table, limits = _rows_at(record, kept, rows), record.case.limits
        known = table["clearance"].is_valid().to_numpy()
        after = np.searchsorted(kept, [moment.step for moment in moments], side="right")
        shown = {moment.step for moment in moments}
        own = status_codes(table["clearance"].to_numpy(), limits).astype(np.uint8)
        is_shown = known & np.isin(kept, list(shown)) & between_of(table)
        clearances = np.array([moment.clearance for moment in moments])
        ends = [(*moment.point_link, *moment.point_obstacle) for moment in moments]
        joined: dict[str, tuple[np.ndarray, ArrayLike]] = {
            "steps": (kept, [moment.step for moment in moments]),
            "times": (
                table["time"].to_numpy().astype(np.float64),
                [moment.time for moment in moments],
            ),
            "clearances": (least_of(table), clearances),
            "between": (np.zeros(len(kept), dtype=np.uint8), 1),
            "known": (known.astype(np.uint8), 1),
            "status": (np.where(is_shown, own, codes_of(table)), status_codes(clearances, limits)),
        }
        arrays = {name: np.insert(column, after, more) for name, (column, more) in joined.items()}
        lines = _lines(record, table)
        arrays["lines"] = np.insert(lines, after, np.array(ends).reshape(-1, 6), axis=0)
        names = table["link"].to_pylist(), table["obstacle"].to_pylist()
        pairs = list(zip(*names, strict=True))
        for place, moment in reversed(list(zip(after, moments, strict=True))):
            pairs.insert(place, (moment.link, moment.obstacle))
        positions = [
            np.insert(motion.positions[kept], after, _rows(moments, i, motion), axis=0)
            for i, motion in enumerate(record.motions)
        ]
        return ReplayFrames(arrays, pairs, positions)


def _rows(moments: Sequence[Moment], i_robot: int, motion: Motion) -> np.ndarray:
    """(moments, k) the positions of one robot's joints."""
    n_joints = motion.positions.shape[1]
    return np.array([moment.positions[i_robot] for moment in moments]).reshape(-1, n_joints)


def _rows_at(record: Record, kept: np.ndarray, on_disk: MeasuredRows) -> pa.Table:
    """The rows of some steps, block by block: taken at once, all rows would be put together first."""
    taken = []
    for block in blocks(record.steps.num_rows):
        here = kept[np.searchsorted(kept, block.start) : np.searchsorted(kept, block.stop)]
        rows = record.steps.slice(block.start, block.stop - block.start)
        taken.append(rows.take(here - block.start))
        on_disk.let_go()
    return pa.concat_tables(taken).combine_chunks()


_LINE = ("link_x", "link_y", "link_z", "obstacle_x", "obstacle_y", "obstacle_z")


def least_of(steps: pa.Table) -> np.ndarray:
    """(n,) [m] the clearance of each step, or what it is at least."""
    clearances = steps["clearance"].to_numpy().astype(np.float64)
    if steps["clearance"].null_count == 0:
        return clearances
    return np.where(np.isnan(clearances), steps["lower_bound"].to_numpy(), clearances)


def _lines(record: Record, steps: pa.Table) -> np.ndarray:
    """(n, 6) [m] the witness points; where they are unknown, twice that of the worst step's link."""
    lines = np.column_stack([steps[name].to_numpy() for name in _LINE]).astype(np.float64)
    worst = [record.steps[name][record.worst_step].as_py() for name in _LINE[:3]]
    return np.where(np.isnan(lines), np.tile(worst, 2), lines)


def codes_of(steps: pa.Table) -> np.ndarray:
    """(n,) uint8 the statuses of a steps table as indices into `STATUSES`; 0 where there is none."""
    names = pa.array([str(status) for status in STATUSES])
    return np.concatenate(
        [_codes(part, names) for part in steps["status"].iterchunks()] or [_NO_CODES]
    )


_NO_CODES = np.empty(0, dtype=np.uint8)


def _codes(statuses: pa.Array, names: pa.Array) -> np.ndarray:
    import pyarrow.compute

    found = pyarrow.compute.index_in(statuses, names).fill_null(0)
    return found.to_numpy(zero_copy_only=False).astype(np.uint8)
