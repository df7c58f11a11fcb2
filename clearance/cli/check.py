"""`clearance check`: a case in, a verdict out, a report where one is wanted."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from clearance.cli import ExitCode
from clearance.cli.check_outputs import Outputs
from clearance.cli.for_ci import CiOutputs, baseline_of, ci_options, comparison_of
from clearance.cli.more_files import MoreFiles, more_files_options
from clearance.cli.options import LengthParamType, OutputPath, accept_option
from clearance.cli.recorded import recorded_options, require_recorded, with_recording
from clearance.cli.tolerances import tolerance_options, with_leniency, with_tolerances
from clearance.cli.verify import receipt_option, require_receipt, write_receipt_of

if TYPE_CHECKING:
    from clearance.findings.findings_file import FindingList
    from clearance.run import Question, Run
    from clearance.world.case import Case


@click.command()
@click.argument("case_file", metavar="CASE.yaml", type=click.Path(path_type=Path))
@click.option("--out", metavar="DIR", type=OutputPath(), help="Write the report here.")
@click.option(
    "--fail-mm",
    type=LengthParamType(),
    help="Fail limit instead of the case's; rules that give one keep theirs.",
)
@click.option("--warn-mm", type=LengthParamType(), help="Warn limit instead of the case's.")
@click.option(
    "--samples-only",
    is_flag=True,
    help="Look at the samples only: no proof for the motion between them.",
)
@click.option("--certify", is_flag=True, hidden=True, help="The default.")
@click.option(
    "--certify-mm",
    type=LengthParamType(),
    help="How tight the bound proven for the motion between the samples is.  [default: 0.1]",
)
@click.option(
    "--need",
    type=click.Choice(["steps", "pairs", "limit", "minimum"]),
    default="steps",
    show_default=True,
    help="steps: every step. pairs: every pair at every step too (pairs.parquet). limit: steps below "
    "the warn limit, a proven bound for the rest. minimum: the worst moment only.",
)
@accept_option("the verdict")
@tolerance_options
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
@click.option(
    "--body-gaps",
    is_flag=True,
    help="Tell which gaps people may be caught in, by the widths of ISO 13854; no verdict depends on it.",
)
@click.option("--cross-check", is_flag=True, help="Hold every step against FCL.")
@click.option(
    "--method",
    type=click.Choice(["exact", "paper"]),
    default="exact",
    show_default=True,
    help="exact: the true minimum. paper: the first paper's algorithm, without guarantee.",
)
@click.option(
    "--paper-tolerance-mm",
    "paper_tolerance",
    type=LengthParamType(),
    help="With --method paper: its rule 1 leaves out polygons this far apart or farther.  [default: none]",
)
@recorded_options
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object only.")
@click.option("--junit", metavar="FILE", type=OutputPath(), help="Write JUnit XML.")
@receipt_option
@more_files_options
@ci_options
@click.option("--quiet", is_flag=True, help="Print nothing but errors; the exit code tells.")
def check(
    case_file: Path,
    out: Path | None,
    fail_mm: float | None,
    warn_mm: float | None,
    samples_only: bool,
    certify: bool,
    certify_mm: float | None,
    need: str,
    accept: tuple[str, ...],
    tolerance: Path | None,
    unproven_ok: bool,
    contact: str,
    jobs: int | None,
    body_gaps: bool,
    cross_check: bool,
    method: str,
    paper_tolerance: float | None,
    motion: str,
    recorded: Path | None,
    recorded_offset: float | None,
    recorded_robot: str | None,
    recorded_gaps: str | None,
    recorded_columns: dict[str, str] | None,
    as_json: bool,
    junit: Path | None,
    receipt: str | None,
    png: Path | None,
    glb: Path | None,
    trajectory: Path | None,
    waivers: tuple[Path, ...],
    today: date | None,
    baseline: Path | None,
    summary: Path | None,
    github: bool,
    quiet: bool,
) -> int:
    """Measures the least clearance of every step of CASE.yaml.

    The verdict is proven for the motion between the samples too. Without --out nothing is
    written. With it, the same command goes on where an interrupted one was. Exit code: 0 clear
    (or near), 1 a limit is violated or, with tolerances, not proven, or a waiver is stale, 2 bad
    or suspect input, 3 the cross-check disagrees; the greatest that holds. A baseline does not
    change it: `clearance compare` has an exit code of its own.
    """
    _require_proof_or_samples(samples_only, certify or certify_mm is not None)
    recording = recorded, recorded_offset, recorded_robot, recorded_gaps, recorded_columns
    require_recorded(motion, *recording)
    _require_extras(cross_check, motion)
    outputs = Outputs(out, junit, CiOutputs(summary, github), MoreFiles(png, glb, trajectory))
    outputs.require_writable()
    _require_file(case_file)
    from clearance.run import Question

    case = _case(case_file, fail_mm, warn_mm, accept, waivers)
    case = with_leniency(with_recording(with_tolerances(case, tolerance), *recording), unproven_ok)
    outputs.refuse_inputs(case)
    before = baseline_of(baseline, outputs.files)
    question = Question(
        case, need=need, method=method, motion=motion, certify=not samples_only, certify_gap=_gap(certify_mm),
        cross_check=cross_check, contact=contact, paper_tolerance=paper_tolerance, today=today,
        body_gaps=body_gaps,
    )  # fmt: skip
    require_receipt(receipt, out, question)
    run = _answer(question, before, outputs, jobs, PrintedOutput(as_json, quiet))
    write_receipt_of(run, receipt, out, case_file, (tolerance, waivers), quiet=as_json or quiet)
    return ExitCode(run.verdict.exit_code)


def _gap(given: float | None) -> float:
    """[m] How fine the proof is."""
    from clearance.tolerance import CERTIFY_GAP

    return CERTIFY_GAP if given is None else given


def _require_proof_or_samples(samples_only: bool, certify: bool) -> None:
    if samples_only and certify:
        raise click.UsageError(
            "--samples-only proves nothing; leave out --certify and --certify-mm"
        )


class PrintedOutput(NamedTuple):
    """What is printed: the summary as JSON, nothing, or, where neither is asked for, words."""

    as_json: bool
    quiet: bool

    @property
    def has_words(self) -> bool:
        """True if people read it."""
        return not (self.as_json or self.quiet)


def _answer(
    question: Question,
    before: FindingList | None,
    outputs: Outputs,
    jobs: int | None,
    printed: PrintedOutput,
) -> Run:
    """Measures, writes what is wanted, and prints the verdict."""
    from clearance.cli.progress import shown_progress
    from clearance.cli.run_rows import kept_rows
    from clearance.run import Resources, answer

    outputs.withdraw_older()
    ahead = outputs.more.made_ahead(question.case, question.motion)
    with kept_rows(outputs.out, printed.quiet) as rows:
        with shown_progress(not printed.has_words, _passes(question)) as progress:
            run = answer(question, Resources(jobs, progress, rows))
        comparison = comparison_of(run, before)
        outputs.write(run, comparison)
        notes = outputs.more.write(run, ahead)
    _print(run, outputs.out, printed)
    if printed.has_words:
        outputs.more.print_written(notes)
        if comparison is not None:
            from clearance.cli.comparison import print_comparison

            print_comparison(comparison)
    outputs.for_ci.write(run, comparison, to_stderr=printed.as_json)
    return run


def _require_file(case_file: Path) -> None:
    """Refuses a path that leads to no file, before all that a run needs is imported.

    Raises:
        MissingFile: as when it is read.
    """
    from clearance.formats.files.input_files import require_file

    require_file(case_file, case_file.name)


def _passes(question: Question) -> list[str]:
    """What a run does over the steps, one after the other, as progress names it."""
    passes = ["measuring"] + ["certifying"] * question.certify
    return passes + ["cross-checking"] * question.cross_check + ["looking into contacts"]


def _case(
    case_file: Path,
    fail: float | None,
    warn: float | None,
    accept: tuple[str, ...],
    waivers: tuple[Path, ...],
) -> Case:
    """The case with what the command line changes of it."""
    from clearance.case.case_file import load_case
    from clearance.case.waiver_file import with_waivers
    from clearance.run.question import with_levels

    case = load_case(case_file)
    accepted = tuple(dict.fromkeys([*case.accept, *accept]))
    case = replace(case, limits=with_levels(case.limits, fail, warn), accept=accepted)
    return with_waivers(case, waivers)


def _require_extras(cross_check: bool, motion: str) -> None:
    """Refuses, before anything is measured, what a missing library could not do in the end.

    Raises:
        Unavailable: a library of an extra that this run needs is missing.
    """
    from clearance.extras import require

    if cross_check:
        require("crosscheck", "--cross-check")
    if motion == "simulated":
        require("simulate", "--motion simulated")


def _print(run: Run, out: Path | None, printed: PrintedOutput) -> None:
    if printed.as_json:
        from clearance.report.output import json_text

        click.echo(json_text(run.summary), nl=False)
    elif not printed.quiet:
        from clearance.cli.verdict import print_verdict

        print_verdict(run, out)
