"""What a build server asks for beside the report: waivers, a baseline, a summary, annotations.

Not for: their words (`report`), nor JUnit, which is a file of the report.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli.options import OutputPath, in_order

if TYPE_CHECKING:
    from clearance.findings.comparison import Comparison
    from clearance.findings.findings_file import FindingList
    from clearance.run import Run

SUMMARY_VARIABLE, ROOT_VARIABLE = "GITHUB_STEP_SUMMARY", "GITHUB_WORKSPACE"
"""What GitHub Actions calls the file of a step's summary, and the folder of the repository."""


class DateParamType(click.ParamType):
    """A day, as 2027-03-31."""

    name = "DATE"

    def convert(
        self, value: str | date, param: click.Parameter | None, ctx: click.Context | None
    ) -> date:
        """The day."""
        if isinstance(value, date):
            return value
        try:
            return date.fromisoformat(value)
        except ValueError:
            self.fail(f"{value!r} is no day, as 2027-03-31", param, ctx)


_OPTIONS = (
    click.option(
        "--waivers",
        metavar="FILE",
        multiple=True,
        type=click.Path(path_type=Path),
        help="Waivers beside those of the case; may be given more than once.",
    ),
    click.option(
        "--today",
        type=DateParamType(),
        help="The day that waivers are held against.  [default: today, in UTC]",
    ),
    click.option(
        "--baseline",
        metavar="DIR|FILE",
        type=click.Path(path_type=Path),
        help="An older report or its findings.json: says what is new, worse, better, gone since.",
    ),
    click.option(
        "--summary",
        metavar="FILE.md",
        type=OutputPath(),
        help="Write verdict and findings as Markdown.",
    ),
    click.option(
        "--github",
        is_flag=True,
        help=f"Annotate the rows of the trajectory, and append the summary to ${SUMMARY_VARIABLE}.",
    ),
)


ci_options = in_order(*_OPTIONS)


def baseline_of(path: Path | None, outputs: Sequence[Path]) -> FindingList | None:
    """The findings that a run is held against; None where no baseline is given.

    Raises:
        BadInput: no findings.json, or a damaged one. Incomplete: the run that was to write it was interrupted.
        Unwritable: this run would overwrite it.
    """
    if path is None:
        return None
    from clearance.cli.places import refuse_inputs
    from clearance.cli.run_rows import require_finished
    from clearance.findings.findings_file import FILE_NAME, read_findings

    refuse_inputs(outputs, [path / FILE_NAME if path.is_dir() else path])
    require_finished(path)
    return read_findings(path)


def comparison_of(run: Run, baseline: FindingList | None) -> Comparison | None:
    """The run held against its baseline, if there is one."""
    if baseline is None:
        return None
    from clearance.findings.comparison import compared

    return compared(baseline, run.finding_list)


@dataclass(frozen=True)
class CiOutputs:
    """What is to be written for people who look at a build.

    Attributes:
        summary: a file for the Markdown. github: whether GitHub Actions is told as well.
    """

    summary: Path | None
    github: bool

    def write(self, run: Run, comparison: Comparison | None, to_stderr: bool) -> None:
        """Writes summary and annotations."""
        if self.summary is None and not self.github:
            return
        from clearance.files import write_file
        from clearance.report.markdown import markdown

        text = markdown(run.record, run.verdict, run.findings, comparison)
        if self.summary is not None:
            write_file(self.summary, text.encode("utf-8"))
        if self.github:
            _append_to_summary(text)
            _annotate(run, to_stderr)


def _append_to_summary(text: str) -> None:
    place = os.environ.get(SUMMARY_VARIABLE)
    if not place:
        click.echo(f"note: {SUMMARY_VARIABLE} is not set; no step summary is written", err=True)
        return
    from clearance.errors import unwritable

    with unwritable(Path(place)), open(place, "a", encoding="utf-8") as file:
        file.write(text)


def _annotate(run: Run, to_stderr: bool) -> None:
    from clearance.report.annotations import annotation_lines

    root = Path(os.environ.get(ROOT_VARIABLE) or os.curdir)
    for line in annotation_lines(run.record, run.verdict, run.findings, root):
        click.echo(line, err=to_stderr)
