"""The answer for a person at a terminal: verdict first, then the worst moment, then what else matters.

What puts the clearance in doubt, and what was not checked, stands right below the headline. Lengths are in
millimetres and rounded down; coordinates in metres, world frame. Colour only in a terminal. Each line is printed
as soon as it is known. Not for: what a topic says (`topics`).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from clearance.errors import shown
from clearance.findings.finding import NOT_PROVEN
from clearance.findings.limit_lines import contact_line, moment_line
from clearance.record.wording import least_text, limits_text
from clearance.report.model import ReportModel
from clearance.report.topic import TerminalTable, Topic
from clearance.report.topics import IN_TERMINAL

_STYLES = {"clear": "bold green", "near": "bold yellow"}
_PLAIN_WIDTH = 160  # columns for tables where the output is not a terminal


def print_answer(
    model: ReportModel,
    out: Path | None,
    console: Console | None = None,
    topics: Iterable[Topic] = IN_TERMINAL,
) -> None:
    """Prints the answer on stdout, or on `console`.

    Args:
        out: the folder of the report, if it is to be named. topics: what is printed below the headline.
    """
    console = console or terminal()
    _print(console, _headline(model))
    for topic in topics:
        for line in () if topic.lines is None else topic.lines(model):
            if isinstance(line, TerminalTable):
                console.print(terminal_table(line))
            else:
                _print(console, _row(*line))
    if out is not None:
        _print(console, _row("report", shown(str(out / "report.html"))))


def terminal() -> Console:
    """Standard output."""
    console = Console()
    return console if console.is_terminal else Console(width=_PLAIN_WIDTH)


def _print(console: Console, text: Text) -> None:
    console.print(text, soft_wrap=True, highlight=False, markup=False)


def _headline(model: ReportModel) -> Text:
    """Verdict and least clearance, or the most critical moment and its rule, or the deepest contact."""
    record, verdict, limits = model.record, model.verdict, model.record.case.limits
    text = Text(verdict.headline(str.upper), style=_STYLES.get(verdict.shade, "bold red"))
    worst = verdict.worst
    if worst.touches:
        after = contact_line(record, worst)
    elif verdict.beside and record.status_of(worst) in _STYLES:
        after = f"{verdict.beside[0]}; {least_text(worst)}"
    elif limits.rules or verdict.nearest:
        after = moment_line(record, worst)
    else:
        after = least_text(worst, (limits.fail, limits.warn))
        after += " as measured" if verdict.tolerances == NOT_PROVEN else ""
        after += f" ({limits_text(limits.fail, limits.warn)})"
        named = record.status_of(worst) != "clear"
        after += f": {worst.link} - {worst.obstacle}" if named else ""
    if verdict.beside and record.status_of(worst) not in _STYLES:
        after += f"; {verdict.beside[0]}"
    after += f", {verdict.at_level}" if verdict.at_level else ""
    return text.append(f"  {record.case.name}: {after}", style="default not bold")


def _row(label: str, value: str) -> Text:
    return Text(f"  {label:<12}", style="dim").append(value, style="default not dim")


def terminal_table(content: TerminalTable) -> Table:
    """A table as it is printed."""
    table = Table(box=None, pad_edge=False, padding=(0, 2))
    for i, head in enumerate(content.heads):
        name = head.removeprefix(">")
        table.add_column(name if i else f"  {name}", justify="right" if name != head else "left")
    for first, *cells in content.rows:
        table.add_row(Text(f"  {_not_a_command(first)}"), *map(Text, cells))
    return table


def _not_a_command(name: str) -> str:
    """A name that begins a line, so that no build server takes it for a command of its own."""
    return repr(name) if name.startswith(("::", "##")) else name
