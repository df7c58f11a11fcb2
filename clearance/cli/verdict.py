"""The answer for a person at a terminal: verdict first, then the worst moment, then what else
matters. What puts the clearance in doubt, and what was not checked, stands right below the headline.

Lengths are in millimetres and rounded down; coordinates in metres, world frame. Colour only in a
terminal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from clearance.errors import shown
from clearance.findings.verdict import Verdict, contact_line, moment_line, profile_text
from clearance.record.levels import Interval
from clearance.record.names import LINK_AND_OBSTACLE
from clearance.record.record import CrossCheck, Disagreement, PairMinimum, Record
from clearance.record.wording import (
    certified_text,
    contact_text,
    count,
    depth_text,
    limit_mm,
    limits_text,
    mm,
    moment_text,
    other_time,
    seconds,
    span_text,
    step_text,
)
from clearance.report.actors import carried_of, paddings_of
from clearance.report.contact import HEADS, contact_of
from clearance.report.summary import certified_of, notes_of, tessellation_bound
from clearance.run import Run
from clearance.run.session import RunSession
from clearance.world.notice import KINDS, Notice, listed

_STYLES = {"clear": "bold green", "near": "bold yellow"}
_LEVELS = {"contact": "contact", "below_fail": "below fail", "below_warn": "below warn"}
_MOST_INTERVALS, _MOST_NOTES, _MOST_PAIRS, _MOST_DISAGREEMENTS = 4, 8, 5, 5
_MOST_CARRIES, _MOST_PADDINGS = 6, 6
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
    record, session, verdict = run.record, run.session, run.verdict
    lines: list[Text | Table | Callable[[], list[Text]]] = [_headline(record, verdict)]
    lines += [*_beside(verdict), *_worst(record), *_rules(record, session), *_carried(record)]
    lines += _paddings(record)
    lines += _where_asked(run)
    if record.need != "minimum":
        lines += [_row(_LEVELS[level], _interval_text(session, level)) for level in _LEVELS]
    lines.append(partial(_deepest, record))
    nearest = session.motion_minima(_MOST_PAIRS)
    if nearest:
        lines.append(_pair_table(record, nearest))
    lines += [_row("profile", profile_text(answer)) for answer in record.profiles]
    lines += _certified(record)
    lines += _facets(record)
    if run.cross_check is not None:
        lines += _cross_check(run.cross_check)
    lines.append(partial(_notes, run))
    if out is not None:
        lines.append(_row("report", shown(str(out / "report.html"))))
    return lines


def _headline(record: Record, verdict: Verdict) -> Text:
    """Verdict and least clearance, or the most critical moment and its rule, or the deepest contact."""
    text = Text(verdict.text(str.upper), style=_STYLES.get(verdict.status, "bold red"))
    limits = record.case.limits
    if record.worst.touches:
        told = (
            f"{', ' if ' ' in text.plain else ' '}{contact_line(record.worst)} ({record.case.name})"
        )
    elif limits.rules:
        told = f": {moment_line(record, record.worst)} ({record.case.name})"
    else:
        told = f"  {record.case.name}: least clearance {mm(record.worst.clearance)} mm"
        told += f" ({limits_text(limits.fail, limits.warn)})"
    told += f", {verdict.at_level}" if verdict.at_level else ""
    return text.append(told, style="default not bold")


def _beside(verdict: Verdict) -> list[Text]:
    """What a reader must know beside the clearance: right below the headline."""
    lines = [_row("", "; ".join(verdict.scope))] if verdict.scope else []
    lines += [_row("nearest", verdict.nearest)] if verdict.nearest else []
    lines += [_row("waived", text) for text in verdict.waived]
    lines += [_row("waivers", text) for text in verdict.stale]
    lines += [_row("violated", text) for text in verdict.broken]
    lines += [_row("tolerances", text) for text in verdict.with_tolerances]
    lines += [_row("unproven", verdict.unproven)] if verdict.unproven else []
    lines += [_row("suspect", _suspect(one)) for one in verdict.suspects]
    return lines + [_row("warning", text) for text in verdict.warnings]


def _suspect(notice: Notice) -> str:
    return f"{notice.text} (--accept {notice.kind})" if notice.kind in KINDS else notice.text


def _worst(record: Record) -> list[Text]:
    worst = record.worst
    a, b = ("link", "obstacle") if record.sides[:2] == LINK_AND_OBSTACLE else ("a", "b")
    points = f"{a} {_point(worst.point_link)}, {b} {_point(worst.point_obstacle)} m"
    n_steps = count(record.steps.num_rows, "step")
    between = f"between the steps {worst.step} and {worst.step + 1}"
    where = between if worst.between else f"step {worst.step}"
    told = f"{where} of {n_steps}, {seconds(worst.time)}{other_time(worst.obstacle, worst.time_b)}"
    told += f": {worst.link} - {worst.obstacle}"
    return [_row("worst", told), _row("points", points)]


def _paddings(record: Record) -> list[Text]:
    """What clearances are less by, if any body is padded."""
    told = [f"{name} {limit_mm(padding)} mm" for name, padding in paddings_of(record).items()]
    less = f"clearances are less that of both bodies: {listed(told, _MOST_PADDINGS)}"
    return [_row("padding", less)] if told else []


def _rules(record: Record, session: RunSession) -> list[Text]:
    """One line for each rule of the case, if it has any: how it stands, and its worst moment."""
    limits = record.case.limits
    if not limits.rules:
        return []
    answers = {answer.name: answer for answer in record.rules}
    lines = []
    for i, name in enumerate(limits.rule_names):
        own, answer = limits.of_rule(i), answers.get(name)
        told = f"{name} ({limits_text(own.fail, own.warn)}): "
        if answer is None:
            told += "judges nothing"
        elif answer.worst is None:
            told += f"{answer.status}, nothing nearer was asked for"
        else:
            worst = session.worst_among([answer]) or answer.worst
            near = depth_text(worst.depth) if worst.touches else f"{mm(worst.clearance)} mm"
            told += f"{answer.status}, {near}, {worst.link} - {worst.obstacle}"
            told += f" at {moment_text(worst)}"
        lines.append(_row("rule", told))
    return lines


def _carried(record: Record) -> list[Text]:
    """Who carries what from when until when."""
    return [
        _row("carried", f"{row['part']} by {row['by']}, {span_text(row['from'], row['until'])}")
        for row in carried_of(record)[:_MOST_CARRIES]
    ]


def _where_asked(run: Run) -> list[Text | Callable[[], list[Text]]]:
    """What is told of a recorded run, of tolerances, and of gaps for people, where a case has them."""
    record, session = run.record, run.session
    lines: list[Text | Callable[[], list[Text]]] = []
    if record.commanded is not None:
        from clearance.report.recordings import recording_lines

        lines += _rows("recorded", recording_lines(record))
    if record.budget is not None:
        lines.append(partial(_tolerances, run))
    if record.body_gaps:
        from clearance.report.body_gaps import body_gaps_of, gap_lines

        found = body_gaps_of(session.motion_minima(), session.standing_bodies)
        lines += _rows("body gaps", gap_lines(found))
    return lines


def _tolerances(run: Run) -> list[Text]:
    """Where the tolerances leave least, what takes most of it, and where their numbers come from."""
    from clearance.report.tolerances import MOST_SOURCES, source_lines

    record, session = run.record, run.session
    found = [(one, session.least_left(one)) for one in record.budget or ()]
    known = [(one, left[0].proven - one.limits.fail) for one, left in found if left]
    lines: list[str] = []
    if known:
        worst = min(known, key=lambda pair: pair[1])[0]
        lines += source_lines(record, worst, session.error_sources(worst, 0, MOST_SOURCES))
    assert record.case.tolerance is not None
    return _rows("tolerances", [*lines, *record.case.tolerance.sources])


def _rows(label: str, lines: Iterable[str]) -> list[Text]:
    """Lines under one label."""
    return [_row(label if i == 0 else "", line) for i, line in enumerate(lines)]


def _certified(record: Record) -> list[Text]:
    if record.certificate is None:
        return [_row("certified", "no: nothing is said about the motion between the samples")]
    lines = [_row("certified", certified_text(certified_of(record, record.certificate)))]
    sample = record.worst_sample
    if record.worst is not sample:
        told = f"{mm(sample.clearance)} mm at step {sample.step}, {seconds(sample.time)}"
        lines.append(_row("samples", f"{told}: {sample.link} - {sample.obstacle}"))
    return lines


def _facets(record: Record) -> list[Text]:
    """By how much facets can make the clearance too small, wherever that is more than a hundredth of it."""
    bound = tessellation_bound(record)
    if bound <= 0.01 * record.worst.clearance or bound == 0.0:
        return []
    told = f"round shapes stand up to {bound * 1000:.3g} mm outside the true surfaces: a clearance can be "
    return [_row("facets", f"{told}too small by that much, never too large")]


def _deepest(record: Record) -> list[Text]:
    """The deepest overlap: where, how deep, which way out of the link."""
    found = contact_of(record)
    if found is None:
        return []
    told = found["deepest"]
    way = ", ".join(f"{value:.4f}" for value in told["direction"])
    text = f"step {told['step']}, {told['link']} in {told['obstacle']}: {contact_text(told)}"
    mover = "the link" if record.sides[:2] == LINK_AND_OBSTACLE else told["link"]
    return [_row("deepest", f"{text}; way out of {mover} ({way})")]


def _point(point: Sequence[float]) -> str:
    return f"({', '.join(f'{value:.6f}' for value in point)})"


def _interval_text(session: RunSession, level: str) -> str:
    found: list[Interval] = session.intervals[level]
    if not found:
        return "never"
    n_intervals, n_steps = session.extent(level)
    times = [span_text(part.start, part.end) for part in found[:_MOST_INTERVALS]]
    more = n_intervals - len(times)
    tail = f" and {more} more" if more else ""
    what = count(n_steps, "step") if n_steps else "between the steps"
    return f"{what}: {', '.join(times)}{tail}"


def _pair_table(record: Record, nearest: Sequence[PairMinimum]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2))
    first, second = HEADS[record.sides[0]]
    proven = all(pair.proven is not None for pair in nearest)
    table.add_column(f"  closest{'' if proven else ' at the samples'}: {first.lower()}")
    table.add_column(second.lower())
    for name in ("clearance mm", "step", "time s"):
        table.add_column(name, justify="right")
    if record.case.limits.rules:
        table.add_column("rule")
    for pair in nearest:
        cells = [
            f"  {_not_a_command(pair.link)}",
            pair.obstacle,
            mm(pair.clearance),
            step_text(pair),
            f"{pair.time:.3f}",
        ]
        cells += [pair.rule] if record.case.limits.rules else []
        table.add_row(*(Text(cell) for cell in cells))
    return table


def _not_a_command(name: str) -> str:
    """A name that begins a line, so that no build server takes it for a command of its own."""
    return repr(name) if name.startswith(("::", "##")) else name


def _cross_check(check: CrossCheck) -> list[Text]:
    figures = (
        f"greatest difference {check.greatest_difference:.2e} m, witness points within "
        f"{check.worst_witness_error:.2e} m, tolerance {check.tolerance:.2e} m"
    )
    if check.n_settled:
        figures += (
            f"; it is off by up to {check.greatest_settled:.2e} m at {count(check.n_settled, 'step')}, "
            "where exact arithmetic settles it for us"
        )
    if check.agrees:
        told = f"{check.peer} agrees at {_agreeing(check)}: {figures}"
        return [_row("cross-check", told)]
    n_bad = len({row.step for row in check.disagreements})
    lines = [_row("cross-check", f"{check.peer} DISAGREES at {count(n_bad, 'step')}: {figures}")]
    return lines + [_row("", _told(row)) for row in check.disagreements[:_MOST_DISAGREEMENTS]]


def _agreeing(check: CrossCheck) -> str:
    if not check.n_settled:
        return f"all {count(check.n_steps, 'step')}"
    return f"{check.n_steps - check.n_settled} of {count(check.n_steps, 'step')}"


def _told(row: Disagreement) -> str:
    ours = f"{row.clearance:.9g} m ({row.link} - {row.obstacle})"
    peers = f"{row.peer_clearance:.9g} m ({row.peer_link} - {row.peer_obstacle})"
    return f"step {row.step}: {ours}, peer {peers}: {row.reason}"


def _notes(run: Run) -> list[Text]:
    notes = notes_of(run.record, run.session.hints)
    lines = [_row("note", note) for note in notes[:_MOST_NOTES]]
    more = len(notes) - len(lines)
    return [*lines, _row("", f"and {count(more, 'more note')}, see --json")] if more > 0 else lines


def _row(label: str, value: str) -> Text:
    return Text(f"  {label:<12}", style="dim").append(value, style="default not dim")
