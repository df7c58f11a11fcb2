"""The answer for a person at a terminal: verdict first, then the worst moment, then what else
matters.

Lengths are in millimetres and rounded down; coordinates in metres, world frame. Colour only in a
terminal.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from clearance.cli.progress import shown_progress
from clearance.report import certified_of, contact_of, notes_of
from clearance.report.intervals import Interval, extent, intervals
from clearance.report.profiles import gap_text, plane_text
from clearance.report.wording import certified_text, contact_text, count, limit_mm, mm, seconds
from clearance.run import Run
from clearance.simulate.record import CrossCheck, Disagreement, PairMinimum, ProfileAnswer, Record

_STYLES = {"clear": "bold green", "near": "bold yellow"}
_LEVELS = {"contact": "contact", "below_fail": "below fail", "below_warn": "below warn"}
_MOST_INTERVALS, _MOST_NOTES, _MOST_PAIRS, _MOST_DISAGREEMENTS = 4, 8, 5, 5
_PLAIN_WIDTH = 160  # columns for tables where the output is not a terminal


def print_verdict(run: Run, out: Path | None, console: Console | None = None) -> None:
    """Prints the answer on stdout, or on `console`."""
    console = console or _stdout()
    for each in _lines(run, out):
        for line in each() if callable(each) else [each]:
            if isinstance(line, Table):
                console.print(line)
            else:
                console.print(line, soft_wrap=True, highlight=False, markup=False)


def _stdout() -> Console:
    console = Console()
    return console if console.is_terminal else Console(width=_PLAIN_WIDTH)


def _lines(run: Run, out: Path | None) -> list[Text | Table | Callable[[], list[Text]]]:
    """The lines; those that look into contacts are made when they are printed, after the verdict."""
    record = run.record
    lines: list[Text | Table | Callable[[], list[Text]]] = [_headline(run), *_worst(run)]
    if record.need != "minimum":
        lines += [_row(_LEVELS[level], _interval_text(record, level)) for level in _LEVELS]
    lines.append(partial(_deepest, record))
    nearest = record.pair_minima[:_MOST_PAIRS]
    if nearest:
        lines.append(_pair_table(nearest))
    lines += [_row("profile", _profile_text(answer)) for answer in record.profiles]
    if record.certificate is not None:
        lines.append(_row("certified", certified_text(certified_of(record))))
    if run.cross_check is not None:
        lines += _cross_check(run.cross_check)
    lines.append(partial(_notes, record))
    if out is not None:
        lines.append(_row("report", str(out / "report.html")))
    return lines


def _headline(run: Run) -> Text:
    worst, limits = run.worst, run.record.case.limits
    text = Text(run.status.upper(), style=_STYLES.get(run.status, "bold red"))
    told = f"  {run.record.case.name}: least clearance {mm(worst['clearance'])} mm"
    told += f" (fail below {limit_mm(limits.fail)} mm, warn below {limit_mm(limits.warn)} mm)"
    return text.append(told, style="default not bold")


def _worst(run: Run) -> list[Text]:
    row = run.worst
    points = [f"{side} {_point(row, side)}" for side in ("link", "obstacle")]
    n_steps = run.record.steps.num_rows
    where = f"step {row['step']} of {count(n_steps, 'step')}, {seconds(row['time'])}"
    return [
        _row("worst", f"{where}: {row['link']} - {row['obstacle']}"),
        _row("points", f"{', '.join(points)} m"),
    ]


def _deepest(record: Record) -> list[Text]:
    """The deepest overlap: where, how deep, which way out of the link; worked out now, with progress."""
    if len(record.contacts):
        with shown_progress(False, ["looking into contacts"]) as progress:
            record.work_out_contacts(progress)
    if record.deepest is None:
        return []
    told = contact_of(record)["deepest"]
    way = ", ".join(f"{value:.4f}" for value in told["direction"])
    text = f"step {told['step']}, {told['link']} in {told['obstacle']}: {contact_text(told)}"
    return [_row("deepest", f"{text}; way out of the link ({way})")]


def _point(row: dict, side: str) -> str:
    coordinates = (row[f"{side}_{axis}"] for axis in "xyz")
    return f"({', '.join(f'{value:.6f}' for value in coordinates)})"


def _interval_text(record: Record, level: str) -> str:
    found: list[Interval] = intervals(record)[level]
    if not found:
        return "never"
    n_intervals, n_steps = extent(record, level)
    times = [f"{part.start:.3f}-{seconds(part.end)}" for part in found[:_MOST_INTERVALS]]
    more = n_intervals - len(times)
    tail = f" and {more} more" if more else ""
    return f"{count(n_steps, 'step')}: {', '.join(times)}{tail}"


def _pair_table(nearest: Sequence[PairMinimum]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2))
    table.add_column("  closest pairs: link")
    table.add_column("obstacle")
    for name in ("clearance mm", "step", "time s"):
        table.add_column(name, justify="right")
    for pair in nearest:
        cells = (
            f"  {pair.link}",
            pair.obstacle,
            mm(pair.clearance),
            str(pair.step),
            f"{pair.time:.3f}",
        )
        table.add_row(*(Text(cell) for cell in cells))
    return table


def _profile_text(answer: ProfileAnswer) -> str:
    known = asdict(answer)
    verdict = "kept" if answer.passed else "NOT KEPT"
    what = "distance" if answer.mode == "nearest" else "gap"
    return (
        f"{answer.name} ({answer.mode}, {plane_text(known)}): {verdict}, {what} {gap_text(known)} mm, "
        f"limit {answer.limit * 1000:g} mm, {answer.link}, step {answer.step}"
    )


def _cross_check(check: CrossCheck) -> list[Text]:
    figures = (
        f"greatest difference {check.greatest_difference:.2e} m, witness points within "
        f"{check.worst_witness_error:.2e} m, tolerance {check.tolerance:.2e} m"
    )
    if check.agrees:
        told = f"{check.peer} agrees at all {count(check.n_steps, 'step')}: {figures}"
        return [_row("cross-check", told)]
    n_bad = len(check.disagreements)
    lines = [_row("cross-check", f"{check.peer} DISAGREES at {count(n_bad, 'step')}: {figures}")]
    return lines + [_row("", _told(row)) for row in check.disagreements[:_MOST_DISAGREEMENTS]]


def _told(row: Disagreement) -> str:
    ours = f"{row.clearance:.9g} m ({row.link} - {row.obstacle})"
    peers = f"{row.peer_clearance:.9g} m ({row.peer_link} - {row.peer_obstacle})"
    return f"step {row.step}: {ours}, peer {peers}: {row.reason}"


def _notes(record: Record) -> list[Text]:
    notes = notes_of(record)
    lines = [_row("note", note) for note in notes[:_MOST_NOTES]]
    more = len(notes) - len(lines)
    return [*lines, _row("", f"and {count(more, 'more note')}, see --json")] if more > 0 else lines


def _row(label: str, value: str) -> Text:
    return Text(f"  {label:<12}", style="dim").append(value, style="default not dim")
