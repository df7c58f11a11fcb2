"""`clearance check`: a case in, a verdict out, a report where one is wanted."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from clearance.cli import ExitCode
from clearance.cli.check_outputs import Outputs, output_options
from clearance.cli.options import AnsweringCommand, asked_options, said, spelled_by
from clearance.cli.verify import receipt_option, require_receipt, write_receipt_of
from clearance.options import made
from clearance.run.options import CheckOptions

if TYPE_CHECKING:
    from clearance.findings.comparison import Comparison
    from clearance.findings.findings_file import FindingList
    from clearance.run import Question, Run

ARGUMENTS = {"recorded": "RUN"}


def _report_unread(
    error: click.UsageError, case_file: Path | None, baseline: Path | None, **given: Any
) -> None:
    """Tells build servers of a command line that is not understood."""
    outputs = Outputs(**{one.name: given[one.name] for one in fields(Outputs)})
    if baseline is None:  # which may lie in --out
        outputs.report_unread(case_file or Path("CASE.yaml"), error)


@click.command(cls=AnsweringCommand, report_unread=_report_unread)
@click.argument("case_file", metavar="CASE.yaml", type=click.Path(path_type=Path))
@asked_options(CheckOptions, arguments=ARGUMENTS)
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Threads.  [default: all cores; same bytes]"
)
@output_options
@receipt_option
@click.option(
    "--baseline",
    metavar="DIR|FILE",
    type=click.Path(path_type=Path),
    help="Older report, or its findings.json, to compare with: list findings that are new, worse, better or gone.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object only.")
@click.option(
    "--quiet",
    is_flag=True,
    help="Print nothing but errors, and JSON with --json; the exit code has the answer.",
)
@click.option("-q", "--brief", is_flag=True, help="Print the verdict and errors only.")
@click.option(
    "--watch",
    "as_watch",
    is_flag=True,
    help="Check again whenever an input file changes, until Ctrl-C; the page of --out loads itself anew.",
)
def check(
    case_file: Path,
    jobs: int | None,
    receipt: str | None,
    baseline: Path | None,
    as_json: bool,
    quiet: bool,
    brief: bool,
    as_watch: bool,
    **given: Any,
) -> int:
    """Measures the least clearance of every step of CASE.yaml.

    The verdict is proven for the motion between the samples too. Without --out nothing is
    written. With it, the same command resumes an interrupted run. Exit code: 0 clear or near
    (at the samples only, too); 1 a limit is violated or not proven, a waiver is unused or expired,
    or --fail-on-warning finds one; 2 bad or suspect input; 3 the cross-check disagrees. The
    greatest that applies counts. --baseline does not change it: `clearance compare` has an exit code of its own.
    """
    from clearance.files import refuse_inputs

    spelled = spelled_by(CheckOptions, ARGUMENTS)
    asked, outputs = said(CheckOptions, given), Outputs(**given)
    printed = PrintedOutput(as_json, quiet, brief)
    with outputs.refusal_reported(case_file, to_stderr=as_json):
        refuse_inputs(outputs.files, [case_file, *_files_of(baseline)])
        outputs.withdraw_older(case_file)
        outputs.require_writable()
        if as_watch and receipt is not None:
            raise click.UsageError(
                "--watch and --receipt exclude each other: a receipt belongs to one report"
            )
        options = made(CheckOptions, asked, spelled)
        _require_file(case_file)

    @outputs.refusal_reported(case_file, to_stderr=as_json)
    def checked() -> ExitCode:
        from clearance.case.case_file import load_case
        from clearance.cli.run_rows import finished_findings
        from clearance.run import Question

        outputs.withdraw_older(case_file)
        question = Question.of(load_case(case_file), options, spelled)
        refuse_inputs(outputs.files, question.case.files_read)
        before = None if baseline is None else finished_findings(baseline)
        require_receipt(receipt, outputs.out, question)
        run = _answer(question, before, outputs, jobs, printed)
        write_receipt_of(run, receipt, outputs.out, case_file, options, quiet=not printed.has_words)
        return ExitCode(run.verdict.exit_code)

    if not as_watch:
        return checked()
    from clearance.cli.watch import watch

    watch(checked, outputs.out, quiet=quiet)


class PrintedOutput(NamedTuple):
    """What is printed: the summary as JSON, nothing, the verdict, or, where none is asked for, all."""

    as_json: bool
    quiet: bool
    brief: bool = False

    @property
    def has_words(self) -> bool:
        """True if people read all of it."""
        return not (self.as_json or self.quiet or self.brief)


def _answer(
    question: Question,
    before: FindingList | None,
    outputs: Outputs,
    jobs: int | None,
    printed: PrintedOutput,
) -> Run:
    """Measures, writes what is wanted, and prints the verdict."""
    from clearance.cli.progress import shown_progress, shown_work
    from clearance.cli.run_rows import resumable_rows_of
    from clearance.progress import doing
    from clearance.run import Resources, answer

    ahead = outputs.trajectory_ahead(question)
    with resumable_rows_of(outputs.out, printed.quiet) as rows:
        with shown_progress(not printed.has_words, _passes(question)) as progress:
            run = answer(question, Resources(jobs, progress, rows))
        with shown_work(not printed.has_words, "working out and writing the report"):
            comparison = _comparison_of(run, before)
            notes = outputs.write(run, comparison, ahead)
    with doing(lambda: "working out the nearest pairs, events and slopes of the worst moment"):
        _print(run, outputs.out, printed)
    if printed.has_words:
        outputs.print_written(notes)
        if comparison is not None:
            from clearance.report.comparison import print_comparison

            print_comparison(comparison)
    outputs.report_to_builds(run, comparison, to_stderr=printed.as_json)
    return run


def _require_file(case_file: Path) -> None:
    """Refuses a path that leads to no file, before all that a run needs is imported.

    Raises:
        MissingFile: as when it is read.
    """
    from clearance.case.case_list import refuse_folder
    from clearance.formats.files.input_files import require_file

    refuse_folder(case_file)
    require_file(case_file, case_file.name)


def _files_of(baseline: Path | None) -> list[Path]:
    """The file that a baseline is read from."""
    if baseline is None:
        return []
    from clearance.findings.findings_file import FILE_NAME

    return [baseline / FILE_NAME if baseline.is_dir() else baseline]


def _comparison_of(run: Run, baseline: FindingList | None) -> Comparison | None:
    """The run held against its baseline, if there is one."""
    if baseline is None:
        return None
    from clearance.findings.comparison import compared

    return compared(baseline, run.finding_list)


def _passes(question: Question) -> list[str]:
    """What a run does over the steps, one after the other, as progress names it."""
    passes = ["measuring"] + ["certifying"] * question.certify
    return passes + ["cross-checking"] * question.cross_check + ["looking into contacts"]


def _print(run: Run, out: Path | None, printed: PrintedOutput) -> None:
    if printed.as_json:
        from clearance.report.summary import json_text

        click.echo(json_text(run.summary), nl=False)
    elif printed.has_words:
        from clearance.report.terminal import print_answer

        print_answer(run.report, out)
    elif printed.brief and not printed.quiet:
        from clearance.report.terminal import print_answer
        from clearance.report.topics import verdict

        print_answer(run.report, None, topics=[verdict.TOPIC])
