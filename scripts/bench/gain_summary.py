"""What the journals of the benchmark of gains come to: a line a kind, then the slow cases and those not kept.

Not for: the rows themselves (`gain`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from gain_cases import KINDS
from gain_journal import Journal, Row
from rich.console import Console
from rich.table import Table

SLOW = {"waypoints": 20.0, "obstacle": 1.0, "base": 1.0}
"""[s] Cases that take longer are listed."""

OTHERS = ("general", "drake")


def print_summary(ours: Journal, general: Journal, drake: Journal) -> None:
    """The table, the slow cases and those that are not kept."""
    table = Table(
        "kind", "cases", "kept", "checked anew", "s, median", "s, worst", "size / known",
        *(f"size / {name}" for name in OTHERS),
    )  # fmt: skip
    for kind in KINDS:
        own = [row for row in ours if row["kind"] == kind]
        if own:
            beside = (_beside(own, one, ours) for one in (general, drake))
            table.add_row(kind, *_figures(own), *beside)
    Console(width=160).print(table)
    for row in ours:
        if not row["kept"] or not row["checked"] or row["seconds"] > SLOW[row["kind"]]:
            print(line_of(row))


def line_of(row: Row) -> str:
    """What one case came to."""
    told = "kept" if row["kept"] else "NOT"
    told += "" if row["checked"] in (True, None) else ", BUT NOT WHEN CHECKED"
    return (
        f"{row['case']:3.0f} {row['source']:28} {row['how']:10} {row['kind']:9} {row['who']:12} {told:4} "
        f"{row['size']:.5f} known {row['known']:.5f} >= {row['lower_bound']:.5f} {row['seconds']:.2f} s "
        f"{row['blocked'] or ''}"
    )


def _figures(own: Sequence[Row]) -> tuple[str, ...]:
    kept = [row for row in own if row["kept"]]
    seconds = [row["seconds"] for row in own]
    return (
        str(len(own)), f"{len(kept)} ({100 * len(kept) / len(own):.1f} %)",
        str(sum(bool(row["checked"]) for row in kept)), f"{np.median(seconds):.2f}",
        f"{np.max(seconds):.2f}", _spread([row["size"] / row["known"] for row in kept]),
    )  # fmt: skip


def _spread(ratios: Sequence[float]) -> str:
    """The median and the greatest."""
    return f"{np.median(ratios):.3f} (to {np.max(ratios):.3f})" if ratios else ""


def _beside(own: Sequence[Row], other: Journal, ours: Journal) -> str:
    """The ratio to another's size where both keep the limits, and how many of those asked each kept."""
    numbers = {row["case"] for row in own}
    pairs = [(ours.rows[int(row["case"])], row) for row in other if row["case"] in numbers]
    if not pairs:
        return ""
    both = [(row, one) for row, one in pairs if row["kept"] and _keeps(one)]
    kept = sum(bool(row["kept"]) for row, _ in pairs), sum(_keeps(one) for _, one in pairs)
    spread = _spread([row["size"] / one["size"] for row, one in both])
    return f"{spread}, kept {kept[0]} and {kept[1]} of {len(pairs)}"


def _keeps(other: Row) -> bool:
    """Whether another found a change; one of Drake's is to be proven."""
    return other["size"] is not None and other.get("proven", True) is True
