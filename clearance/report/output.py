"""The report of a record as a folder: tables, summary, replay and page, all of them or none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from clearance.files import LAST, fill_folder
from clearance.findings import findings_file
from clearance.findings.comparison import Comparison
from clearance.record.replay import EarlierBody, Replay
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.report.curves import more_curves, pair_curves
from clearance.report.model import PageContent, ReportModel
from clearance.report.moveit_moments import FILE_NAME as MOMENTS
from clearance.report.moveit_moments import moments_text
from clearance.report.page import PageCurves, page_of
from clearance.report.summary import json_text, summary_of
from clearance.report.tables import (
    BUDGET,
    budget_table,
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
    findings_file.FILE_NAME,
    "report.html",
    LAST,
)
"""What a report can consist of."""

OWN = (*CONTENT, "receipt.bin", OLDER_SUMMARY, "replay.npz")
"""All files that a report can have, or had; a receipt, which is of one report, goes with it."""


class Drawings(NamedTuple):
    """The pictures of a report.

    Attributes:
        pictures: of each profile as SVG, by its name. earlier: where bodies were before a change.
    """

    replay: Replay
    pictures: dict[str, str]
    earlier: Sequence[EarlierBody] = ()


def page_text(
    model: ReportModel,
    drawn: Drawings,
    measured: MeasuredRows = IN_MEMORY,
    comparison: Comparison | None = None,
) -> str:
    """`report.html`.

    Args:
        measured: where the record's rows are. comparison: with a baseline.
    """
    findings = model.finding_list.findings
    content = PageContent(
        summary_of(model), model.verdict, drawn.pictures, findings, comparison, model.may_lack
    )
    curves = pair_curves(model.record, model.session.motion_minima(), measured)
    more = PageCurves(curves, [*more_curves(model.record)])
    return page_of(content, drawn.replay, more, drawn.earlier)


def write(
    model: ReportModel,
    drawn: Drawings,
    folder: str | Path,
    measured: MeasuredRows = IN_MEMORY,
    comparison: Comparison | None = None,
) -> None:
    """Writes `steps.parquet`, `steps.csv`, `contacts.csv`, where there are tolerances `budget.csv`,
    `worst_moments.yaml`, `findings.json`, `report.html` and, last, `summary.json`.

    The same record gives the same bytes. Other files in `folder` are left alone; an older report
    there is replaced as a whole, or, if anything goes wrong, kept as it was.

    Memory does not grow with the steps: the tables are written a block at a time.

    Args:
        measured: where the record's rows are; files on the way to `folder` lie beside them.
        comparison: with a baseline, for the page.

    Raises:
        Unwritable: `folder` cannot be written.
    """
    record = model.record
    texts = {
        MOMENTS: moments_text(model),
        findings_file.FILE_NAME: findings_file.findings_text(model.finding_list),
        "report.html": page_text(model, drawn, measured, comparison),
        LAST: json_text(summary_of(model)),
    }

    def fill(place: Path) -> None:
        write_parquet(step_batches(record, measured), place / "steps.parquet")
        write_csv(lambda: step_batches(record, measured), place / "steps.csv")
        if record.every_pair is not None:
            write_parquet(pair_batches(record, measured), place / "pairs.parquet")
        write_csv(lambda: contact_batches(record), place / "contacts.csv")
        if record.budget is not None:
            write_csv(lambda: [budget_table(model.least_left)], place / BUDGET)
        for name, text in texts.items():
            (place / name).write_text(text, encoding="utf-8")

    fill_folder(Path(folder), fill, OWN, measured.folder)
