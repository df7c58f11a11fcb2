"""`clearance check`: a case in, a verdict out, a report where one is wanted."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli import ExitCode
from clearance.cli.options import Millimetres, motion_option

if TYPE_CHECKING:
    from clearance.run import Run
    from clearance.world.case import Limits


@click.command()
@click.argument("case_file", metavar="CASE.yaml", type=click.Path(path_type=Path))
@click.option(
    "--out", metavar="DIR", type=click.Path(path_type=Path), help="Write the report here."
)
@click.option("--fail-mm", type=Millimetres(), help="Fail limit instead of the case's.")
@click.option("--warn-mm", type=Millimetres(), help="Warn limit instead of the case's.")
@click.option("--certify", is_flag=True, help="Prove a bound for the motion between the steps too.")
@click.option("--certify-mm", type=Millimetres(), help="How tight that bound is.  [default: 0.1]")
@click.option(
    "--need",
    type=click.Choice(["steps", "pairs", "limit", "minimum"]),
    default="steps",
    show_default=True,
    help="steps: every step. pairs: every pair at every step too (pairs.parquet). limit: steps below "
    "the warn limit, a proven bound for the rest. minimum: the worst moment only.",
)
@click.option(
    "--contact",
    type=click.Choice(["none", "events", "every"]),
    default="events",
    show_default=True,
    help="Whose depth, volume and way out are told: of none, of the deepest moment of each event, of every step.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Threads.  [default: all cores; same bytes]"
)
@click.option("--cross-check", is_flag=True, help="Hold every step against FCL.")
@click.option(
    "--method",
    type=click.Choice(["exact", "paper"]),
    default="exact",
    show_default=True,
    help="exact: the true minimum. paper: the first paper's algorithm, without guarantee.",
)
@motion_option
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object only.")
@click.option("--junit", metavar="FILE", type=click.Path(path_type=Path), help="Write JUnit XML.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors; the exit code tells.")
def check(
    case_file: Path,
    out: Path | None,
    fail_mm: float | None,
    warn_mm: float | None,
    certify: bool,
    certify_mm: float | None,
    need: str,
    contact: str,
    jobs: int | None,
    cross_check: bool,
    method: str,
    motion: str,
    as_json: bool,
    junit: Path | None,
    quiet: bool,
) -> int:
    """Measures the least clearance of every step of CASE.yaml.

    Without --out nothing is written. With it, the same command goes on where an interrupted one
    was. Exit code: 0 clear (or near), 1 a limit is violated, 2 bad input, 3 the cross-check
    disagrees.
    """
    from clearance.cli.places import require_file_place, require_folder_place
    from clearance.cli.progress import shown_progress
    from clearance.load.case_file import load_case

    require_folder_place(out)
    require_file_place(junit)
    _compile_ahead(quiet)
    case = load_case(case_file)
    limits = _limits(case.limits, fail_mm, warn_mm)
    from clearance.cli.kept import kept_rows
    from clearance.run import check as answer
    from clearance.tolerance import CERTIFY_GAP

    certify = certify or certify_mm is not None
    passes = ["measuring"] + ["certifying"] * certify + ["cross-checking"] * cross_check
    passes += ["looking into contacts"]
    with kept_rows(out, quiet) as kept:
        with shown_progress(quiet or as_json, passes) as progress:
            run = answer(
                case,
                need=need,
                jobs=jobs,
                method=method,
                motion=motion,
                limits=limits,
                certify=certify,
                certify_gap=CERTIFY_GAP if certify_mm is None else certify_mm,
                cross_check=cross_check,
                contact=contact,
                progress=progress,
                kept=kept,
            )
            if out is not None or as_json:
                run.record.work_out_contacts(progress)
        _write(run, out, junit)
    _print(run, out, as_json, quiet)
    return _exit_code(run)


def _compile_ahead(quiet: bool) -> None:
    """Begins to compile what this machine has not yet, and says so in a terminal."""
    from clearance import ahead

    if ahead.start() and not quiet and sys.stderr.isatty():
        click.echo("compiling for this machine, once: about half a minute", err=True)


def _limits(given: Limits, fail: float | None, warn: float | None) -> Limits | None:
    """The limits with what the command line changes; raising `fail` alone takes `warn` along."""
    from clearance.world.case import Limits

    if fail is None and warn is None:
        return None
    if fail is None:
        fail = given.fail
    if warn is None:
        warn = max(given.warn, fail)
    if warn < fail:
        raise click.UsageError(
            f"the warn limit {warn * 1000:g} mm is below the fail limit {fail * 1000:g} mm"
        )
    return Limits(fail=fail, warn=warn)


def _write(run: Run, out: Path | None, junit: Path | None) -> None:
    if out is not None:
        run.save(out)
    if junit is not None:
        from clearance.report import write_junit

        write_junit(run.record, junit)


def _print(run: Run, out: Path | None, as_json: bool, quiet: bool) -> None:
    if as_json:
        from clearance.report import json_text, summary_of

        click.echo(json_text(summary_of(run.record)), nl=False)
    elif not quiet:
        from clearance.cli.verdict import print_verdict

        print_verdict(run, out)


def _exit_code(run: Run) -> ExitCode:
    if run.cross_check is not None and not run.cross_check.agrees:
        return ExitCode.DISAGREES
    return ExitCode.CLEAR if run.passed else ExitCode.VIOLATED
