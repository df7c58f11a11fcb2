"""Where the rows of a run with `--out` are kept while it runs: a hidden folder, gone when the report is there.

Not for: the report itself (`clearance.files`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.errors import Incomplete
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows, open_resumable_rows

if TYPE_CHECKING:
    from clearance.findings.findings_file import FindingList

SUFFIX = ".unfinished"


@contextmanager
def resumable_rows_of(out: Path | None, quiet: bool) -> Iterator[MeasuredRows]:
    """The resumable rows for the report folder `out`; rows in memory where no report is wanted.

    Raises:
        Unwritable: another run is writing the same report, or there is no room.
    """
    if out is None:
        yield IN_MEMORY
        return
    say = (lambda line: None) if quiet else partial(click.echo, err=True)
    with open_resumable_rows(place_of(out), say) as rows:
        yield rows


def place_of(out: Path) -> Path:
    """The folder `.NAME.unfinished` beside `out`, or `.unfinished` in it where that is on no other disk."""
    out = Path(os.path.realpath(out))
    if not out.is_dir():
        return out.parent / f".{out.name}{SUFFIX}"
    parent = out.parent
    fits_beside = os.access(parent, os.W_OK) and os.stat(parent).st_dev == os.stat(out).st_dev
    return parent / f".{out.name}{SUFFIX}" if fits_beside and parent != out else out / SUFFIX


def require_finished(report: Path) -> None:
    """Refuses a report, or a file of one, whose folder a run was to write anew and has not.

    Raises:
        Incomplete: what is there is of an older run.
    """
    from clearance.report.withdrawn import OLDER_SUMMARY, is_withdrawn

    folder = report if report.is_dir() else report.parent
    rows = place_of(folder)
    if rows.exists() or is_withdrawn(folder):
        raise Incomplete(
            "a run into this folder was interrupted or refused, or is not finished; its files are older",
            where=str(folder),
            valid=f"the same check again, or remove {rows.name if rows.exists() else OLDER_SUMMARY!r}",
        )


def finished_findings(report: Path) -> FindingList:
    """The findings in a report folder, or in a file of one.

    Raises:
        Incomplete: as `require_finished`. BadInput: no findings.json, or a damaged one.
    """
    from clearance.findings.findings_file import read_findings

    require_finished(report)
    return read_findings(report)
