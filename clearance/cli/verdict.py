"""The answer of a run for a person at a terminal. Not for: its words (`report.terminal`)."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from clearance.report.terminal import print_answer
from clearance.run import Run


def print_verdict(run: Run, out: Path | None, console: Console | None = None) -> None:
    """Prints the answer on stdout, or on `console`."""
    print_answer(run.report, out, console)
