"""A gain as a folder: the changed case, its figures, a page, and the reports of before and after, all or none.

Not for: how the case is written (`changed_files`), the page (`page`).
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from clearance.errors import Unwritable
from clearance.extras import LIBRARIES, is_installed
from clearance.files import fill_folder, refuse_inputs
from clearance.gains.changed_files import OWN as OF_CASE
from clearance.gains.changed_files import case_files
from clearance.gains.figures import figures_of
from clearance.gains.page import page_of
from clearance.gains.result import Gain
from clearance.report.output import OWN as OF_REPORT
from clearance.report.summary import json_text
from clearance.report.withdrawn import older_name, withdraw_file, withdraw_page, withdraw_report

FIGURES, PAGE = "gain.json", "gain.html"

REPORTS = ("before", "after")


def save_gain(gain: Gain, folder: Path, *, force: bool = False) -> Path:
    """Writes everything, or nothing; the folder.

    The reports are left out, and the page says so, where what draws them is not installed.

    Raises:
        BadInput: as `case_files`. Unwritable: something is there, or there is no way to write.
    """
    folder = Path(folder)
    made = case_files(gain, folder)
    drawn = all(is_installed(library) for library in LIBRARIES["report"])
    names = [*dict.fromkeys((*OF_CASE, FIGURES, PAGE, *made.files))]
    sources = gain.before.record.case.files_read
    refuse_existing(folder, names, force=force)
    refuse_inputs([folder / name for name in names], sources)
    page = page_of(gain, made.notes, with_reports=drawn)

    def fill(fresh: Path) -> None:
        for name, content in made.files.items():
            (fresh / name).write_bytes(content)
        (fresh / FIGURES).write_text(json_text(figures_of(gain, made.notes)), encoding="utf-8")
        (fresh / PAGE).write_text(page, encoding="utf-8")
        for name, run in zip(REPORTS, (gain.before, gain.after), strict=True):
            if drawn:
                run.save(fresh / name, earlier=gain.before if name == REPORTS[1] else None)

    fill_folder(folder, fill, (*names, older_name(Path(FIGURES)).name, *REPORTS))
    return folder


def withdraw_gain(folder: Path) -> None:
    """Marks the gain in a folder as older, if there is one, with both reports; a second time changes nothing.

    Raises:
        Unwritable: it cannot be marked.
    """
    withdraw_file(folder / FIGURES)
    withdraw_page(folder / PAGE)
    for name in REPORTS:
        withdraw_report(folder / name)


def refuse_existing(folder: Path, names: Collection[str], *, force: bool) -> None:
    """Nothing, if the files of a gain, and its reports, can be put into a folder without loss.

    Raises:
        Unwritable: one is there and may not be overwritten, or a folder of ours holds something else.
    """
    for name in (*names, *REPORTS):
        there = folder / name
        if there.exists() and not force:
            raise Unwritable("already exists", where=str(there), valid="--force overwrites it")
        if there.is_dir() and name not in REPORTS:
            raise Unwritable("is a folder", where=str(there), valid="a file is to be written there")
    for name in REPORTS:
        there = folder / name
        if there.is_file():
            raise Unwritable("is a file", where=str(there), valid="a report is to be written there")
        other = (
            [one.name for one in there.iterdir() if one.name not in OF_REPORT]
            if there.is_dir()
            else []
        )
        if other:
            raise Unwritable(
                f"holds {other[0]!r}, which belongs to no report",
                where=str(there),
                valid="another place",
            )
