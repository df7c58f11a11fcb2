"""Files that `clearance check` writes on request, for slides, CAD and other programs: picture, GLB, trajectory.

Whatever can be refused is refused before anything is measured. Not for: what is in them (room `report`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from clearance.cli.options import OutputPath

if TYPE_CHECKING:
    from clearance.formats.motion.trajectory_writer import WrittenTrajectory
    from clearance.run import Run
    from clearance.world.case import Case

Command = TypeVar("Command", bound=Callable[..., object])


def more_files_options(command: Command) -> Command:
    """Adds the options to a command; it is called with `png`, `glb` and `trajectory`."""
    for option, what in (
        (
            "--trajectory",
            "Write the motion that was measured: .yaml or .json (JointTrajectory), or .csv.",
        ),
        (
            "--glb",
            "Write the worst moment as GLB: robots, obstacles and the line, for slides and CAD.",
        ),
        ("--png", "Write a picture of the worst moment."),
    ):
        command = click.option(option, metavar="FILE", type=OutputPath(), help=what)(command)
    return command


@dataclass(frozen=True)
class MoreFiles:
    """Where each goes, if it is wanted."""

    png: Path | None = None
    glb: Path | None = None
    trajectory: Path | None = None

    @property
    def by_option(self) -> dict[str, Path]:
        """Those that are wanted."""
        named = {"--png": self.png, "--glb": self.glb, "--trajectory": self.trajectory}
        return {option: path for option, path in named.items() if path is not None}

    def require_writable(self) -> None:
        """Refuses what could not be written in the end.

        Raises:
            Unavailable: a library is missing. Unwritable: a folder, a place that cannot be written, or another
                suffix.
        """
        from clearance.cli.places import require_file_place
        from clearance.errors import Unwritable
        from clearance.extras import require

        if self.png is not None:
            require("report", "--png")
        for option, path in self.by_option.items():
            require_file_place(path, option)
            suffix = f".{option.removeprefix('--')}"
            if option != "--trajectory" and path.suffix.lower() != suffix:
                raise Unwritable(
                    f"is no {suffix} file", where=str(path), valid=f"{option} needs one"
                )

    def made_ahead(self, case: Case, motion: str) -> WrittenTrajectory | None:
        """The trajectory file, where the motion is known before it is measured.

        Raises:
            BadInput, BadTime: the motion cannot be written so.
        """
        if self.trajectory is None:
            return None
        from clearance.report.motion_file import motion_content, require_motion_file
        from clearance.world.motion import kinematic_motion
        from clearance.world.timeline import timeline_of

        require_motion_file(case.robots, self.trajectory.name)
        if motion != "kinematic":
            return None
        own = [kinematic_motion(placed) for placed in case.robots]
        return motion_content(timeline_of(case, own).motions, self.trajectory.name)

    def write(self, run: Run, ahead: WrittenTrajectory | None) -> list[str]:
        """Writes each, whole or not at all; lines on what is not as it was.

        Raises:
            Unwritable: it cannot be written.
        """
        from clearance.files import write_file

        if self.png is not None or self.glb is not None:
            self._write_still(run)
        if self.trajectory is None:
            return []
        if ahead is None:
            from clearance.report.motion_file import motion_content

            ahead = motion_content(run.record.motions, self.trajectory.name)
        write_file(self.trajectory, ahead.content)
        return [f"{self.trajectory.name}: {note}" for note in ahead.notes]

    def print_written(self, notes: list[str]) -> None:
        """Says in a terminal which files there are, and what is not as it was."""
        for word, lines in (("note", notes), ("written", self.by_option.values())):
            for line in lines:
                click.echo(f"  {word:<11} {line}")

    def _write_still(self, run: Run) -> None:
        from clearance.files import write_file

        replay = run.session.replay(run.rows)
        if self.glb is not None:
            from clearance.report.glb import glb_of

            write_file(self.glb, glb_of(run.record, replay))
        if self.png is not None:
            from clearance.report.picture import png_of

            write_file(self.png, png_of(run.record, replay, run.verdict))
