"""The frames of a replay: which steps and moments there are, and what was found at each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.row_status import (
    RowStatus,
    between_of,
    codes_of_moments,
    rule_places,
    status_codes_of,
)
from clearance.record.rows.blocks import blocks
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.record.table import Table
from clearance.simulate.replay.bodies import FramePlace


@dataclass(frozen=True, eq=False)
class ReplayFrames:
    """The selected steps and the moments between them, in order of time.

    Attributes:
        arrays: by name as in `Replay`. places: when each frame is, and between whom its clearance is.
    """

    arrays: dict[str, np.ndarray]
    places: list[FramePlace]

    @staticmethod
    def of(
        record: Record, chosen: np.ndarray, moments: Sequence[Moment], rows: MeasuredRows
    ) -> ReplayFrames:
        table = _rows_at(record, chosen, rows)
        known = ~np.isnan(table.numbers("clearance"))
        after = np.searchsorted(chosen, [moment.step for moment in moments], side="right")
        shown = {moment.step for moment in moments}
        own = RowStatus(record).of_samples(chosen).astype(np.uint8)
        is_shown = known & np.isin(chosen, list(shown)) & between_of(table)
        clearances = np.array([moment.clearance for moment in moments])
        ends = [(*moment.point_link, *moment.point_obstacle) for moment in moments]
        rule_names = [rule.name for rule in record.rules]
        joined: dict[str, tuple[np.ndarray, ArrayLike]] = {
            "steps": (chosen, [moment.step for moment in moments]),
            "times": (table.numbers("time"), [moment.time for moment in moments]),
            "times_b": (_times_b(table), np.array([one.time_b for one in moments], dtype=float)),
            "clearances": (least_of(table), clearances),
            "between": (np.zeros(len(chosen), dtype=np.uint8), 1),
            "known": (known.astype(np.uint8), 1),
            "status": (
                np.where(is_shown, own, status_codes_of(table)),
                codes_of_moments(record, list(moments)),
            ),
            "rule": (
                rule_places(record)[chosen].astype(np.int32),
                [rule_names.index(moment.rule) for moment in moments],
            ),
        }
        arrays = {name: np.insert(column, after, more) for name, (column, more) in joined.items()}
        lines = _lines(record, table)
        arrays["lines"] = np.insert(lines, after, np.array(ends).reshape(-1, 6), axis=0)
        return ReplayFrames(
            arrays, _places(record, chosen, table, list(zip(after, moments, strict=True)))
        )


def _places(
    record: Record, chosen: np.ndarray, table: Table, moments: Sequence[tuple[int, Moment]]
) -> list[FramePlace]:
    names = zip(*(table.names(name).tolist() for name in record.sides[:2]), strict=True)
    numbers = table.numbers("clearance").tolist(), _times_b(table).tolist()
    clearances, times_b = ([None if x != x else x for x in column] for column in numbers)
    rows = zip(chosen.tolist(), clearances, names, times_b, strict=True)
    places = [FramePlace(step, 0.0, gap, pair, time_b) for step, gap, pair, time_b in rows]
    for place, moment in reversed(moments):
        pair = moment.link, moment.obstacle
        one = FramePlace(moment.step, moment.share, moment.clearance, pair, moment.time_b)
        places.insert(place, one)
    return places


def _times_b(table: Table) -> np.ndarray:
    """(n,) [s] when the second body of each row is there, NaN where that is its time."""
    return table.numbers("time_b") if "time_b" in table else np.full(table.n_rows, np.nan)


def _rows_at(record: Record, chosen: np.ndarray, on_disk: MeasuredRows) -> Table:
    """The rows of some steps, block by block: at once, all rows would be put together first."""
    tables = []
    for block in blocks(record.rows.n_rows):
        here = chosen[np.searchsorted(chosen, block.start) : np.searchsorted(chosen, block.stop)]
        tables.append(record.rows.at(here))
        on_disk.let_go()
    return IN_MEMORY.table("table", len(chosen), tables)


def least_of(steps: Table) -> np.ndarray:
    """(n,) [m] the clearance of each step, or what it is at least."""
    clearances = steps.numbers("clearance")
    unknown = np.isnan(clearances)
    return (
        np.where(unknown, steps.numbers("lower_bound"), clearances) if unknown.any() else clearances
    )


def _lines(record: Record, steps: Table) -> np.ndarray:
    """(n, 6) [m] the witness points; where they are unknown, twice that of the worst step's first body."""
    points = record.sides[2:]
    lines = np.column_stack([steps.numbers(name) for name in points])
    return np.where(np.isnan(lines), np.tile(record.worst_sample.point_link, 2), lines)
