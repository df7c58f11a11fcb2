"""`clearance batch`: many cases in, one verdict for all; `status` asks how far one is, `merge` joins its parts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from clearance.cli import ExitCode
from clearance.cli.options import (
    AnsweringCommand,
    OutputPath,
    asked_options,
    line_of,
    said,
    spelled_by,
)
from clearance.errors import ClearanceError, Incomplete
from clearance.extras import require
from clearance.options import made
from clearance.run.options import USUAL, CheckOptions

_LEFT_OUT = "clearance.batch.command_left_out"


class _Commands(click.Group):
    """A group in which what is no command's name is an argument of the first one."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """The arguments, the command's name before them where it is left out."""
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            args = ["check", *args]
            ctx.meta[_LEFT_OUT] = True
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command; without a name where that was left out, so that hints say what was typed."""
        name, command, rest = super().resolve_command(ctx, args)
        return None if ctx.meta.get(_LEFT_OUT) else name, command, rest

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The options of the command whose name may be left out, then the commands."""
        self.commands["check"].format_options(ctx, formatter)
        self.format_commands(ctx, formatter)


@click.group(
    cls=_Commands, options_metavar="", subcommand_metavar="[check] … | status STORE | merge STORE"
)
def batch() -> None:
    """Many cases, measured once each and answered together.

    `clearance batch MANIFEST.yaml --out STORE` checks; these are its options.
    """
    require("tables", "clearance batch")


def _part(value: str) -> tuple[int, int]:
    """The two numbers of a part of several, as 2/5."""
    first, _, second = value.partition("/")
    if not (first.isdecimal() and second.isdecimal() and 1 <= int(first) <= int(second)):
        raise click.BadParameter(f"{value!r} is no part; i/n with i from 1 to n, as 2/5")
    return int(first), int(second)


def _report_unread(
    error: click.UsageError, place: Path | None, baseline: Path | None, **_: Any
) -> None:
    """Says in a store that its answer is not of a command line that is not understood."""
    if place is not None and baseline is None:  # which may be the same
        _withdraw(place, error)


def _withdraw(place: Path, error: Exception | None = None) -> None:
    """Takes an older answer away from a store, if it is one: it is not of a batch that is refused or stopped."""
    from clearance.batch.output import UNFINISHED, withdraw_answer
    from clearance.batch.store_files import FILE

    if not (place / FILE).is_file():
        return
    if error is None:
        withdraw_answer(place, UNFINISHED.format("cases are"))
    else:
        withdraw_answer(place, line_of(error), type(error).__name__)


@batch.command(cls=AnsweringCommand, report_unread=_report_unread)
@click.argument("arguments", metavar="MANIFEST.yaml|CASE.yaml|ZIP|GLOB…", nargs=-1, required=True)
@click.option(
    "--out",
    "place",
    metavar="STORE",
    type=OutputPath(),
    required=True,
    help="The folder that keeps every case's row, and the answer.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Worker processes.  [default: all cores; same bytes]"
)
@click.option("--scheduler", metavar="ADDRESS", help="Use the workers of this dask scheduler.")
@click.option(
    "--shard", type=_part, metavar="I/N", help="Measure every n-th case only, from the i-th on."
)
@click.option("--fresh", is_flag=True, help="Measure all again, whatever the store has.")
@click.option(
    "--rehash",
    is_flag=True,
    help="Read every input file, even if its size and times are unchanged.",
)
@click.option("--strict", is_flag=True, help="Exit with 2, not 1, if a case cannot be read.")
@asked_options(CheckOptions, USUAL)
@click.option(
    "--baseline",
    metavar="STORE",
    type=click.Path(path_type=Path),
    help="Older store to compare with: list findings that are new, worse, better or gone.",
)
@click.option(
    "--quiet", is_flag=True, help="Print nothing but errors; the exit code has the answer."
)
def check(
    arguments: tuple[str, ...], place: Path, shard: tuple[int, int] | None, **given: Any
) -> int:
    """Checks many cases: those of manifests, case files and patterns of them.

    STORE keeps the row of every finished case, so the same command resumes an interrupted batch,
    and measures only changed cases. Exit code: the greatest of all cases, as by `clearance check`;
    1 for a case that cannot be read (2 with --strict), and for a waiver of --waivers that is expired
    or that no case needs; 4 if some are not measured, as on a full disk. --baseline does not change
    it; `clearance compare` has an exit code of its own.
    """
    own = said(CheckOptions, given)
    if given["baseline"] is not None:
        _require_other(given["baseline"], place)
    _withdraw(place)
    try:
        return _checked(arguments, place, own, {**given, "shard": shard})
    except (ClearanceError, click.UsageError) as error:
        if not isinstance(error, Incomplete):
            _withdraw(place, error)
        raise


def _checked(
    arguments: tuple[str, ...], place: Path, own: dict[str, Any], given: dict[str, Any]
) -> int:
    from clearance.batch.compared import require_answer
    from clearance.batch.manifest import batch_of
    from clearance.batch.output import ANSWER
    from clearance.batch.store_files import FILE
    from clearance.cli.batch_run import BatchRequest, run_asked
    from clearance.files import refuse_inputs

    options = made(CheckOptions, own, spelled_by(CheckOptions))
    if given["jobs"] is not None and given["scheduler"] is not None:
        raise click.UsageError("--jobs is for this machine; leave it out with --scheduler")
    if given["baseline"] is not None:
        if given["shard"] is not None:
            raise click.UsageError(
                "--baseline compares whole batches; compare once all parts are done"
            )
        require_answer(given["baseline"])
    batch = batch_of(arguments, own)
    files = [path for paths in options.files.values() for path in paths]
    refuse_inputs([place / name for name in (*ANSWER, FILE)], files)
    return run_asked(batch.items, place, BatchRequest(**given, waivers=batch.waivers))


def _require_other(baseline: Path, place: Path) -> None:
    """Refuses a baseline that the batch would overwrite.

    Raises:
        click.UsageError: it is the store.
    """
    if baseline.resolve() == place.resolve():
        raise click.UsageError(
            "--baseline is the store that --out writes; keep the batch before in another one"
        )


@batch.command()
@click.argument("place", metavar="STORE", type=click.Path(path_type=Path))
def status(place: Path) -> int:
    """Shows how far the last batch of STORE is: done, missing, unreadable, failed, and the worst.

    A case is missing if it was never measured, or if its files have changed since. It is unreadable
    if its last try found bad input. Exit code: the greatest of the cases that are done, 1 for an
    unreadable one; 4 if some are missing.
    """
    from clearance.batch.status import status_of
    from clearance.batch.store import open_store
    from clearance.cli.batch_verdict import print_status

    with open_store(place, make=False) as store:
        found = status_of(store)
    print_status(found)
    return max(ExitCode.INCOMPLETE if found.n_missing else 0, found.answered.exit_code)


@batch.command()
@click.argument("place", metavar="STORE", type=click.Path(path_type=Path))
@click.argument("others", metavar="[PART]…", nargs=-1, type=click.Path(path_type=Path))
def merge(place: Path, others: tuple[Path, ...]) -> int:
    """Adds the results of other parts of a batch (--shard) to STORE.

    PART is the folder or the file of a part that was measured elsewhere. The parts in STORE itself
    need not be named. The same `clearance batch` without --shard then writes the answer.
    """
    from clearance.batch.store import merge, open_store
    from clearance.cli.batch_run import say

    with open_store(place) as store, store.locked(say):
        n_files, n_rows = merge(store, others, say)
    click.echo(f"{n_rows:,} rows of {n_files:,} parts are in {place}")
    return ExitCode.CLEAR
