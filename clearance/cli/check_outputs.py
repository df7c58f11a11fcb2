"""What `clearance check` writes: the report, JUnit, files for slides and CAD, and what a build server is told.

Whatever can be refused is refused before anything is measured. Not for: what is in the files (room `report`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

import click

from clearance.cli.options import OutputPath, in_order, line_of
from clearance.errors import Unwritable

if TYPE_CHECKING:
    from clearance.findings.comparison import Comparison
    from clearance.formats.motion.trajectory_writer import WrittenFile
    from clearance.run import Question, Run

SUMMARY_VARIABLE, ROOT_VARIABLE = "GITHUB_STEP_SUMMARY", "GITHUB_WORKSPACE"
"""What GitHub Actions calls the file of a step's summary, and the folder of the repository."""

_FILES = {
    "junit": ("FILE", "Write JUnit XML."),
    "png": ("FILE", "Write a picture of the worst moment."),
    "glb": (
        "FILE",
        "Write the worst moment as GLB: robots, obstacles and the line, for slides and CAD.",
    ),
    "trajectory": (
        "FILE",
        "Write the motion that was measured: .yaml or .json (JointTrajectory), or .csv.",
    ),
    "summary": ("FILE.md", "Write verdict and findings as Markdown."),
}
"""Options that name a file."""

_SUFFIXED = ("png", "glb")
"""Options whose file must end in their name."""

_FOR_PEOPLE = {"png": (".png",), "glb": (".glb",), "trajectory": (".csv", ".json", ".yaml", ".yml")}
"""Options of files that no build server reads, and how such a file may end."""

output_options = in_order(
    click.option("--out", metavar="DIR", type=OutputPath(), help="Write the report here."),
    *(
        click.option(f"--{name}", metavar=metavar, type=OutputPath(), help=told)
        for name, (metavar, told) in _FILES.items()
    ),
    click.option(
        "--github",
        is_flag=True,
        help=f"Annotate the rows of the trajectory, and append the summary to ${SUMMARY_VARIABLE}.",
    ),
)


@dataclass(frozen=True)
class Outputs:
    """Where everything goes that is wanted: the report's folder, and a file for each of the others."""

    out: Path | None = None
    junit: Path | None = None
    png: Path | None = None
    glb: Path | None = None
    trajectory: Path | None = None
    summary: Path | None = None
    github: bool = False

    def require_writable(self) -> None:
        """Refuses what could not be written in the end.

        Raises:
            Unavailable: a library is missing. Unwritable: a place that cannot be written or is taken twice, or
                another suffix.
        """
        from clearance.extras import require
        from clearance.files import require_file_place, require_folder_place

        for name in ("out", "png"):
            if getattr(self, name) is not None:
                require("report", f"--{name}")
        require_folder_place(self.out)
        uses = {os.path.realpath(path): "is a file of the report" for path in self._report_files()}
        for name, path in self._named.items():
            require_file_place(path, f"--{name}")
            if name in _SUFFIXED and path.suffix.lower() != f".{name}":
                raise Unwritable(
                    f"is no .{name} file", where=str(path), valid=f"--{name} needs one"
                )
            own = f"is the file of --{name}"
            if (problem := uses.setdefault(os.path.realpath(path), own)) != own:
                raise Unwritable(problem, where=str(path), valid=f"--{name} needs another name")

    @property
    def _named(self) -> dict[str, Path]:
        """The files that are wanted, by option."""
        return {name: path for name in _FILES if (path := getattr(self, name)) is not None}

    @property
    def _for_people(self) -> dict[str, Path]:
        """Those of them that no build server reads."""
        return {name: path for name, path in self._named.items() if name in _FOR_PEOPLE}

    @property
    def files(self) -> list[Path]:
        """The files that may be written."""
        return [*self._report_files(), *self._named.values()]

    def _report_files(self) -> list[Path]:
        if self.out is None:
            return []
        from clearance.report.output import OWN

        return [self.out / name for name in OWN]

    def withdraw_older(self, case_file: Path) -> None:
        """Says in an older report, JUnit file and summary that there is no answer yet, before anything is read: a
        run that is stopped, killed too, leaves nothing green. Other files get the name of an older one, but those
        that the case file names: they may be inputs, named by mistake.

        Raises:
            Unwritable: it cannot be written.
        """
        from clearance.report.withdrawn import withdraw_file, withdraw_report

        if self.out is not None and self.out.is_dir():
            withdraw_report(self.out)
        for name, file in self._for_people.items():
            if file.suffix.lower() in _FOR_PEOPLE[name] and not _names(case_file, file):
                withdraw_file(file)
        why = "this run has not come to an end; the same command goes on"
        self._that_are_there()._write_instead(case_file, why, "Incomplete")

    @contextmanager
    def refusal_reported(self, case_file: Path, *, to_stderr: bool) -> Iterator[None]:
        """Tells build servers what stops a run, so that nothing of an older run is taken for its answer.

        A place that holds no JUnit or no summary is left as it is: it may be an input, named by mistake. So is
        one that is itself refused.
        """
        try:
            yield
        except Exception as error:
            with suppress(Unwritable):
                self._report_refusal(case_file, error, to_stderr)
            raise

    def report_unread(self, case_file: Path, error: click.UsageError) -> None:
        """Tells build servers of a command line that is not understood: older files say so, and no new ones.

        Raises:
            Unwritable: one of them cannot be written.
        """
        outputs = self._that_are_there()
        outputs.withdraw_older(case_file)
        outputs._report_refusal(case_file, error, to_stderr=True)

    def _that_are_there(self) -> Outputs:
        """Without the files that do not exist."""
        gone: dict[str, Any] = {
            name: None for name, path in self._named.items() if not path.exists()
        }
        return replace(self, **gone)

    def _report_refusal(self, case_file: Path, error: Exception, to_stderr: bool) -> None:
        text = line_of(error)
        self._write_instead(case_file, text, type(error).__name__, getattr(error, "where", ""))
        if self.github:
            from clearance.report.annotations import refusal_line
            from clearance.report.markdown import refusal_markdown

            click.echo(refusal_line(case_file, text, _root()), err=to_stderr)
            _append_to_summary(refusal_markdown(case_file.name, text))

    def _write_instead(self, case_file: Path, text: str, fault: str, refused: str = "") -> None:
        """Writes a text in place of a verdict, in JUnit and summary, but not at a place that is refused."""
        if _holds(self.junit, rb"[\s\S]*<testsuite", refused):
            from clearance.report.junit import write_unfinished

            write_unfinished("clearance", text, self.junit, fault)
        if _holds(self.summary, rb"### .+: .+\n\n[-|] ", refused):
            from clearance.files import write_file
            from clearance.report.markdown import refusal_markdown

            write_file(self.summary, refusal_markdown(case_file.name, text).encode("utf-8"))

    def trajectory_ahead(self, question: Question) -> WrittenFile | None:
        """The trajectory file, where the motion is known before it is measured.

        Raises:
            BadInput, BadTime: the motion cannot be written so.
        """
        if self.trajectory is None:
            return None
        from clearance.report.motion_file import motion_content, require_motion_file
        from clearance.world.motion import kinematic_motion
        from clearance.world.timeline import timeline_of

        case = question.case
        require_motion_file(case.robots, self.trajectory.name)
        if question.motion != "kinematic":
            return None
        own = [kinematic_motion(placed) for placed in case.robots]
        return motion_content(timeline_of(case, own).motions, self.trajectory.name)

    def write(
        self, run: Run, comparison: Comparison | None, ahead: WrittenFile | None
    ) -> list[str]:
        """Writes each file, whole or not at all; a line for each thing in the trajectory that is not as it was.

        Raises:
            Unwritable: it cannot be written.
        """
        if self.out is not None:
            run.save(self.out, comparison)
        if self.junit is not None:
            from clearance.report.junit_cases import write_run_junit

            write_run_junit(run.report, self.junit)
        self._write_still(run)
        notes = self._write_trajectory(run, ahead)
        from clearance.report.withdrawn import older_name

        for file in self._for_people.values():
            older_name(file).unlink(missing_ok=True)
        return notes

    def _write_trajectory(self, run: Run, ahead: WrittenFile | None) -> list[str]:
        if self.trajectory is None:
            return []
        from clearance.files import write_file
        from clearance.report.motion_file import motion_content

        made = ahead or motion_content(run.record.motions, self.trajectory.name)
        write_file(self.trajectory, made.content)
        return [f"{self.trajectory.name}: {note}" for note in made.notes]

    def _write_still(self, run: Run) -> None:
        if self.png is None and self.glb is None:
            return
        from clearance.files import write_file

        replay = run.replay()
        if self.glb is not None:
            from clearance.report.glb import glb_of

            write_file(self.glb, glb_of(run.record, replay, run.verdict.worst))
        if self.png is not None:
            from clearance.report.picture import png_of

            write_file(self.png, png_of(run.record, replay, run.verdict))

    def print_written(self, notes: list[str]) -> None:
        """Says in a terminal which files for people there are, and what is not as it was."""
        for word, lines in (("note", notes), ("written", self._for_people.values())):
            for line in lines:
                click.echo(f"  {word:<11} {line}")

    def report_to_builds(self, run: Run, comparison: Comparison | None, to_stderr: bool) -> None:
        """Writes the summary, and tells GitHub Actions of it and of each finding, where that is wanted."""
        if self.summary is None and not self.github:
            return
        from clearance.files import write_file
        from clearance.report.markdown import markdown

        text = markdown(run.report, comparison)
        if self.summary is not None:
            write_file(self.summary, text.encode("utf-8"))
        if self.github:
            _append_to_summary(text)
            _annotate(run, to_stderr)


def _names(case_file: Path, file: Path) -> bool:
    """Whether a case file has the name of a file in it, or is that file; if it cannot be read, it may have."""
    with suppress(OSError):
        return file.name == case_file.name or file.name.encode() in case_file.read_bytes()
    return True


def _holds(file: Path | None, sign: bytes, refused: str) -> TypeGuard[Path]:
    """Whether a file, which is not refused, begins with a sign; one that is empty or not there does."""
    if file is None or str(file) == refused:
        return False
    if not file.exists():
        return True
    with suppress(OSError), file.open("rb") as opened:
        begin = opened.read(1000)
        return not begin or re.match(sign, begin) is not None
    return False


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

    for line in annotation_lines(run.report, _root()):
        click.echo(line, err=to_stderr)


def _root() -> Path:
    """The folder of the repository."""
    return Path(os.environ.get(ROOT_VARIABLE) or os.curdir)
