"""The report of a record as a folder: tables, summary, replay and page, all of them or none."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from clearance.files import LAST, fill_folder
from clearance.findings import findings_file
from clearance.findings.comparison import Comparison
from clearance.record.replay import FILE_NAME, EarlierBody, Replay
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.report.budget_table import FILE_NAME as BUDGET
from clearance.report.budget_table import budget_table
from clearance.report.findings import findings
from clearance.report.moments_file import FILE_NAME as MOMENTS
from clearance.report.moments_file import moments_text
from clearance.report.more_curves import more_curves
from clearance.report.page import page_of
from clearance.report.pair_curves import pair_curves
from clearance.report.report_data import ReportData
from clearance.report.summary import summary_of
from clearance.report.tables import (
    contact_batches,
    pair_batches,
    step_batches,
    write_csv,
    write_parquet,
)
from clearance.report.withdrawn import OLDER_SUMMARY

CONTENT = (
    "steps.parquet",
    "steps.csv",
    "pairs.parquet",
    "contacts.csv",
    BUDGET,
    MOMENTS,
    FILE_NAME,
    findings_file.FILE_NAME,
    "report.html",
    LAST,
)
"""What a report can consist of."""

OWN = (*CONTENT, "receipt.bin", OLDER_SUMMARY)
"""All files that a report can have; a receipt, which is of one report, goes with it."""


class Drawings(NamedTuple):
    """The pictures of a report.

    Attributes:
        pictures: of each profile as SVG, by its name. earlier: where bodies were before a change.
    """

    replay: Replay
    pictures: dict[str, str]
    earlier: Sequence[EarlierBody] = ()


def write(
    data: ReportData,
    drawn: Drawings,
    folder: str | Path,
    kept: MeasuredRows = IN_MEMORY,
    comparison: Comparison | None = None,
) -> None:
    """Writes `steps.parquet`, `steps.csv`, `contacts.csv`, where there are tolerances `budget.csv`,
    `worst_moments.yaml`, `replay.npz`, `findings.json`, `report.html` and, last, `summary.json`.

    The same record gives the same bytes. Other files in `folder` are left alone; an older report
    there is replaced as a whole, or, if anything goes wrong, kept as it was.

    Memory does not grow with the steps: the tables are written a block at a time.

    Args:
        kept: where the record's rows are; files on the way to `folder` lie beside them.
        comparison: with a baseline, for the page.

    Raises:
        Unwritable: `folder` cannot be written.
    """
    record, summary, moments = data.record, summary_of(data), moments_text(data)
    told = findings(data.findings.findings, comparison)
    curves = pair_curves(record, data.details.minima, kept)
    more = more_curves(record)
    page = page_of(summary, drawn.replay, drawn.pictures, curves, told, more, drawn.earlier)

    def fill(place: Path) -> None:
        write_parquet(step_batches(record, kept), place / "steps.parquet")
        write_csv(lambda: step_batches(record, kept), place / "steps.csv")
        if record.every_pair is not None:
            write_parquet(pair_batches(record, kept), place / "pairs.parquet")
        write_csv(lambda: contact_batches(record), place / "contacts.csv")
        if record.budget is not None:
            write_csv(lambda: [budget_table(record, data.details.left)], place / BUDGET)
        (place / MOMENTS).write_text(moments, encoding="utf-8")
        drawn.replay.save(place / FILE_NAME)
        findings_text = findings_file.findings_text(data.findings)
        (place / findings_file.FILE_NAME).write_text(findings_text, encoding="utf-8")
        (place / "report.html").write_text(page, encoding="utf-8")
        (place / LAST).write_text(json_text(summary), encoding="utf-8")

    fill_folder(Path(folder), fill, OWN, kept.folder)


def json_text(summary: dict[str, Any]) -> str:
    """The summary as `summary.json` holds it: sorted keys, floats that read back the same, no
    NaN."""
    return json.dumps(summary, indent=2, sort_keys=True, allow_nan=False, ensure_ascii=False) + "\n"
