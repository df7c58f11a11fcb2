"""What `clearance check` writes: the report, JUnit, what a build server is told, files on request.

Whatever can be refused is refused before anything is measured. Not for: what is in the files (room `report`).
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.cli.for_ci import CiOutputs
from clearance.cli.more_files import MoreFiles

if TYPE_CHECKING:
    from clearance.findings.comparison import Comparison
    from clearance.run import Run
    from clearance.world.case import Case


@dataclass(frozen=True)
class Outputs:
    """Where everything goes that is wanted.

    Attributes:
        out: the report's folder. junit: a file. for_ci, more: what else.
    """

    out: Path | None
    junit: Path | None
    for_ci: CiOutputs
    more: MoreFiles

    def require_writable(self) -> None:
        """Refuses what could not be written in the end.

        Raises:
            Unavailable: a library is missing. Unwritable: a place that cannot be written, or is taken twice.
        """
        from clearance.cli.places import require_file_place, require_folder_place
        from clearance.extras import require

        if self.out is not None:
            require("report", "--out")
        require_folder_place(self.out)
        require_file_place(self.junit)
        require_file_place(self.for_ci.summary, "--summary")
        self.more.require_writable()
        _ = self.files

    def refuse_inputs(self, case: Case) -> None:
        """Refuses to write over a file that the case was read from.

        Raises:
            Unwritable: it would.
        """
        from clearance.cli.places import refuse_inputs_of_cases

        refuse_inputs_of_cases([case], self.files)

    def withdraw_older(self) -> None:
        """Says in an older report and JUnit file that there is no answer yet; a run that is stopped leaves nothing
        green.

        Raises:
            Unwritable: it cannot be written.
        """
        if self.out is not None and self.out.is_dir():
            from clearance.report.withdrawn import withdraw_report

            withdraw_report(self.out)
        if self.junit is not None and self.junit.is_file():
            from clearance.report.junit import write_unfinished

            told = "this run has not come to an end; the same command goes on"
            write_unfinished("clearance", told, self.junit)

    @property
    def files(self) -> list[Path]:
        """The files that may be written; no two are the same.

        Raises:
            Unwritable: one would overwrite another.
        """
        asked = {"--junit": self.junit, "--summary": self.for_ci.summary, **self.more.by_option}
        named = {option: path for option, path in asked.items() if path is not None}
        report = self._report_files()
        taken = {os.path.realpath(path): "is a file of the report" for path in report}
        for option, path in named.items():
            _refuse_taken(path, option, taken)
            taken[os.path.realpath(path)] = f"is the file of {option}"
        return [*report, *named.values()]

    def _report_files(self) -> list[Path]:
        if self.out is None:
            return []
        from clearance.report.output import OWN

        return [self.out / name for name in OWN]

    def write(self, run: Run, comparison: Comparison | None) -> None:
        """Writes the report and JUnit, each whole or not at all.

        Raises:
            Unwritable: it cannot be written.
        """
        if self.out is not None:
            run.save(self.out, comparison)
        if self.junit is not None:
            from clearance.report.junit_cases import write_run_junit

            write_run_junit(run.report_data, self.junit)


def _refuse_taken(path: Path, option: str, taken: dict[str, str]) -> None:
    problem = taken.get(os.path.realpath(path))
    if problem is not None:
        from clearance.errors import Unwritable

        raise Unwritable(problem, where=str(path), valid=f"{option} needs another name")
