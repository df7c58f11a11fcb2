"""`clearance compare`: two runs side by side, as a table and, where one is wanted, a page.

Not for: comparing (`findings.comparison`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.options import AnsweringCommand, OutputPath

if TYPE_CHECKING:
    from clearance.findings.comparison import Comparison


def _withdraw_older(out: Path | None, **_: Any) -> None:
    """Marks an older page, before anything is read.

    Raises:
        Unwritable: it cannot be marked.
    """
    if out is not None:
        from clearance.report.comparison import FILE_NAME
        from clearance.report.withdrawn import withdraw_page

        withdraw_page(out / FILE_NAME)


@click.command(cls=AnsweringCommand, report_unread=_withdraw_older)
@click.argument("before", metavar="A", type=click.Path(path_type=Path))
@click.argument("now", metavar="B", type=click.Path(path_type=Path))
@click.option("--out", metavar="DIR", type=OutputPath(), help="Write a page with both curves here.")
@click.option(
    "--quiet", is_flag=True, help="Print nothing but errors; the exit code has the answer."
)
def compare(before: Path, now: Path, out: Path | None, quiet: bool) -> int:
    """Compares two runs of a case, or two batches.

    Each is a report folder, its findings.json, or a store.

    Lists findings that are new, worse, unchanged, better, gone, or not comparable and why.
    Exit code: 1 if B is worse: it breaks a rule more than A did, without a waiver; its input has
    a suspicion, a warning or an unchecked part that A had not; or less is proven, measured or asked for.
    Else 0; 2 bad input; 4 if the run into A or B was interrupted. Two stores are compared case by
    case, by name; a case that only A has counts as worse.
    """
    _withdraw_older(out)
    if _are_stores(before, now):
        return _compare_batches(before, now, out, quiet)
    from clearance.cli.run_rows import finished_findings
    from clearance.findings.comparison import compared

    comparison = compared(finished_findings(before), finished_findings(now))
    if out is not None:
        _write(comparison, before, now, out)
    if not quiet:
        from clearance.report.comparison import print_comparison

        print_comparison(comparison)
    return ExitCode.CLEAR if comparison.passed else ExitCode.VIOLATED


def _are_stores(before: Path, now: Path) -> bool:
    """True if both are stores.

    Raises:
        click.UsageError: one is.
    """
    from clearance.batch.store_files import is_store

    both = [is_store(place) for place in (before, now)]
    if any(both) and not all(both):
        raise click.UsageError("one is a store, the other is a run; two of a kind can be compared")
    return all(both)


def _compare_batches(before: Path, now: Path, out: Path | None, quiet: bool) -> int:
    from clearance.extras import require

    require("tables", "comparing batches")
    from clearance.batch.compared import compared_batches
    from clearance.report.comparison import print_batch_comparison

    if out is not None:
        raise click.UsageError(
            "--out compares two runs; `clearance view STORE CASE` writes the page of a case of either store"
        )
    found = compared_batches(before, now)
    if not quiet:
        print_batch_comparison(found)
    return ExitCode.CLEAR if found.passed else ExitCode.VIOLATED


def _write(comparison: Comparison, before: Path, now: Path, out: Path) -> None:
    from clearance.files import refuse_inputs, require_folder_place
    from clearance.report.comparison import FILE_NAME, write_comparison
    from clearance.report.output import OWN

    require_folder_place(out)
    inputs = [place / name for place in (before, now) if place.is_dir() for name in OWN]
    refuse_inputs([out / FILE_NAME], [*inputs, before, now])
    write_comparison(comparison, before, now, out)
