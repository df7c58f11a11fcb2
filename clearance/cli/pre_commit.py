"""`clearance pre-commit`: many case files, checked as far as their limits, one line each that is not passed.

What the hook of `.pre-commit-hooks.yaml` calls, without files: a commit may change a motion or a mesh alone. Not
for: a report (`check`).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.options import asked_options, said, spelled_by
from clearance.options import made
from clearance.run.options import CASE_SUFFIXES, USUAL, CheckOptions

if TYPE_CHECKING:
    from clearance.run import Run

MOST = 20
"""Findings that are told of one case."""


@click.command("pre-commit")
@click.argument("files", metavar="CASE.yaml...", nargs=-1, type=click.Path(path_type=Path))
@asked_options(CheckOptions, USUAL)
def pre_commit(files: tuple[Path, ...], **given: Any) -> int:
    """Checks cases before a commit.

    All *.clearance.yaml below this folder where no file is given.
    Cases that a file lists are checked too, each against its limits.

    Prints only what is broken. Exit code: the greatest of `clearance check` on each.
    """
    asked = USUAL | said(CheckOptions, given)
    options = made(CheckOptions, asked, spelled_by(CheckOptions))
    from clearance.case.case_list import cases_in
    from clearance.errors import ClearanceError, MissingFile

    worst, found = ExitCode.CLEAR, files or tuple(_below(Path()))
    if not found:
        raise MissingFile(f"there is no *{CASE_SUFFIXES[0]} below this folder", valid="a case file")
    for file in found:
        try:
            worst = max(worst, *(_checked(path, options) for path in cases_in(file)))
        except ClearanceError as error:
            click.echo(f"{file}: {error.line}", err=True)
            worst = max(worst, ExitCode.BAD_INPUT)
    return worst


def _below(folder: Path) -> Iterator[Path]:
    """The files of cases, or lists of them, in a folder and those in it whose names begin with no dot."""
    for one in sorted(folder.iterdir()):
        if one.is_dir() and not one.name.startswith("."):
            yield from _below(one)
        elif one.name.endswith(CASE_SUFFIXES):
            yield one


def _checked(path: Path, options: CheckOptions) -> ExitCode:
    from clearance.case.case_file import load_case
    from clearance.run import Question, answer

    run = answer(Question.of(load_case(path), options, spelled_by(CheckOptions)))
    if not run.passed:
        click.echo(f"{path}: {run.verdict.headline(str.upper)}")
        for line in _why(run):
            click.echo(f"  {line}")
    return ExitCode(run.verdict.exit_code)


def _why(run: Run) -> list[str]:
    """What is broken, the worst first, then what else fails the run: input in doubt, waivers that should go."""
    from clearance.findings.doubts import WARNING, doubts_of
    from clearance.findings.finding_text import coded_line
    from clearance.report.comparison_text import doubt_text

    broken = [coded_line(finding) for finding in run.findings if finding.fails]
    more = [f"and {len(broken) - MOST} more"] if len(broken) > MOST else []
    warned = {WARNING} if run.record.case.fail_on_warning else set()
    found = doubts_of(run.record, run.judgement)
    doubts = [doubt_text(one) for one in found if one.fails or one.kind in warned]
    return [*broken[:MOST], *more, *doubts]
