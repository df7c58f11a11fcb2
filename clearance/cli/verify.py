"""`clearance verify`: proves the bound of a certified run again, from its receipt.

Not for: proving (room `receipt`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli import ExitCode

if TYPE_CHECKING:
    from clearance.run import CheckOptions, Question, Run

NOMINAL = "the receipt proves the bound without tolerances; what these leave is not proven again"

NO_RECEIPT = "{}: the report is whole, and has no receipt"

receipt_option = click.option(
    "--receipt",
    type=click.Choice(["full", "sampled"]),
    is_flag=False,
    flag_value="full",
    help="With --out: write a receipt, from which `clearance verify DIR` proves the certified bound again. "
    "sampled: for one interval in 16 only.",
)


def require_receipt(receipt: str | None, out: Path | None, question: Question) -> None:
    """Refuses, before anything is measured, a receipt that could not be written.

    Raises:
        UsageError: no folder, or nothing that is proven. BadInput: what no receipt is written of.
    """
    if receipt is None:
        return
    if out is None or not question.certify:
        lacks = "--out DIR" if out is None else "a certified run: leave out --samples-only"
        raise click.UsageError(f"--receipt needs {lacks}")
    from clearance.receipt.asked import refuse_uncovered

    refuse_uncovered(question)


def write_receipt_of(
    run: Run,
    receipt: str | None,
    out: Path | None,
    case_file: Path,
    options: CheckOptions,
    *,
    quiet: bool,
) -> None:
    """Writes the receipt where one is wanted, and says how long it is, and if tolerances are no part of it.

    The report is written before: whoever does not wait for the receipt keeps the answer.

    Args:
        options: of the run, which may name files beside the case.
    """
    if receipt is None or out is None:
        return
    from clearance.cli.progress import shown_progress
    from clearance.receipt.receipt_file import read_receipt
    from clearance.receipt.writing import write_receipt

    tolerance, waivers = next(iter(options.files["tolerance"]), ""), options.files["waivers"]
    try:
        with shown_progress(quiet, ["receipt"]) as progress:
            path = write_receipt(run, out, case_file, receipt, tolerance, progress, waivers)
    except KeyboardInterrupt:
        click.echo(NO_RECEIPT.format(out), err=True)
        raise
    if read_receipt(path).head["nominal"]:
        click.echo(f"{path}: {NOMINAL}", err=True)
    if not quiet:
        size = path.stat().st_size / 1e3
        heading = "receipt     " if receipt == "full" else "sampled receipt  "
        click.echo(f"  {heading}{path}, {size:.0f} kB; proven again by: clearance verify {out}")


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "--case",
    "case_file",
    metavar="CASE.yaml",
    type=click.Path(path_type=Path),
    help="The case file, if it has moved.",
)
@click.option(
    "--tolerance",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="The --tolerance file of the run, if it has moved.",
)
@click.option(
    "--waivers",
    metavar="FILE",
    multiple=True,
    type=click.Path(path_type=Path),
    help="A --waivers file of the run, if they have moved; give all of them, in the same order.",
)
@click.option("--inputs", is_flag=True, help="List the input files, each with its sha256.")
@click.option(
    "--quiet", is_flag=True, help="Print nothing but errors; the exit code has the answer."
)
def verify(
    folder: Path,
    case_file: Path | None,
    tolerance: Path | None,
    waivers: tuple[Path, ...],
    inputs: bool,
    quiet: bool,
) -> int:
    """Proves the certified bound of a report again.

    The report is compared with a fresh run, too.

    The proof shares no code with the measurement. Limits, rules, waivers and verdict come from the
    case's files, not from the report. The first line names each file that is not verified: all, where
    the extra `report` is missing, or another version made them. Exit
    code: 0 the bound is proven and the report is right; 1 it is not: the line names the first pair
    and interval, or the file and its line; 2 bad input: the receipt is damaged, or an input has
    changed.
    """
    from clearance.cli.progress import shown_work
    from clearance.errors import shown
    from clearance.receipt.verifying import verify as verified

    with shown_work(quiet, "proving the bound again, and comparing the report with a fresh run"):
        found = verified(folder, case_file, tolerance, waivers)
    if not quiet:
        click.echo(found.headline)
        for path, digest in found.files if inputs else ():
            click.echo(f"  {digest}  {shown(path)}")
        if found.unmeasured:
            click.echo(f"  links and pairs left out, as in the report: {len(found.unmeasured)}")
            for one in found.unmeasured[:MOST_LISTED]:
                click.echo(f"    {shown(one.link)} - {shown(one.obstacle)}: {shown(one.reason)}")
            if len(found.unmeasured) > MOST_LISTED:
                click.echo(f"    and {len(found.unmeasured) - MOST_LISTED} more")
    return ExitCode.CLEAR if found.proven else ExitCode.VIOLATED


MOST_LISTED = 10
"""Most of what is left out that is told in a terminal."""
