"""What a batch comes to, for a person at a terminal: counts first, then the worst cases. Not for: progress."""

from __future__ import annotations

from typing import Any

import click

from clearance.batch.answer import BatchAnswer
from clearance.batch.output import PAGE
from clearance.batch.status import BatchStatus
from clearance.batch.store import Store
from clearance.errors import shown
from clearance.record.wording import count, depth_mm, near_mm
from clearance.world.notice import listed


def print_answer(
    answer: BatchAnswer, store: Store, n_cached: int, shard: tuple[int, int] | None
) -> None:
    """Prints the answer on stdout."""
    n_cases = answer.n_cases
    part = "" if shard is None else f" (part {shard[0]} of {shard[1]})"
    click.echo(f"{_headline(answer)}{part}")
    _print_facts(answer)
    click.echo(f"  cached      {n_cached:,} of {n_cases:,}")
    _print_worst(answer)
    if shard is None:
        click.echo(f"  page        {shown(str(store.place / PAGE))}")
    else:
        click.echo(
            "  page        the same command without --shard writes it once all parts are done"
        )


def print_status(status: BatchStatus) -> None:
    """Prints how far a batch is on stdout."""
    answer = status.answered
    click.echo(f"{status.n_done:,} of {count(status.n_cases, 'case')} done")
    click.echo(f"  missing     {status.n_missing:,}")
    tried = ", when last tried" if status.n_unreadable else ""
    click.echo(f"  unreadable  {status.n_unreadable:,}{tried}")
    click.echo(f"  failed      {answer.n_failing - status.n_unreadable:,}")
    click.echo(f"  kept        {count(status.n_rows, 'row')} in all")
    if status.n_parts:
        click.echo(
            f"  parts       {count(status.n_parts, 'file')} not merged yet; `clearance batch merge` does"
        )
    if not status.has_answer:
        click.echo(
            "  answer      not written yet; the same `clearance batch` does, without --shard"
        )
    _print_facts(answer)
    _print_worst(answer)


def _headline(answer: BatchAnswer) -> str:
    worst = answer.status.upper() if answer.counts else "NOTHING"
    if answer.exit_code == 0 and answer.n_waived:
        worst += " with waivers"
    return f"{worst}  {count(answer.n_cases, 'case')}: {answer.counted}"


def _print_facts(answer: BatchAnswer) -> None:
    for text in answer.reservations:
        click.echo(shown(f"              {text}"))
    for text in answer.waiver_faults:
        click.echo(shown(f"  waivers     {text}"))
    if n_waived := answer.n_waived:
        click.echo(
            f"  waived      {count(n_waived, 'case')} with what breaks a rule and a waiver lets pass"
        )
    if warned := answer.warned:
        line = f"  warnings    {count(len(warned), 'case')}, see the page: {listed(warned)}"
        click.echo(shown(line))
    critical = answer.critical
    if critical is not None:
        near = near_mm(critical["clearance"], critical["measured"], " mm")
        if critical["penetration"] is not None:
            near = f"contact, at most {depth_mm(critical['penetration'])} mm deep"
        near += f", {critical['body_a']} - {critical['body_b']}"
        click.echo(shown(f"  critical    {critical['case']}: {near} at {critical['time']:.3f} s"))


def _print_worst(answer: BatchAnswer) -> None:
    for row in answer.worst:
        click.echo(shown(f"  {row['status']:<10}  {row['case']}: {_reason(row)}"))
    if answer.n_failing > len(answer.worst):
        n_more = answer.n_failing - len(answer.worst)
        click.echo(f"              and {n_more:,} more, see the page")


def _reason(row: dict[str, Any]) -> str:
    """What the headline of a case says beside its status, and why it does not pass: of suspect input what is
    suspect, whatever is measured with it."""
    reasons = row["reasons"] or [row["text"]]
    decisive = (one for one in reasons if one.startswith(f"{row['status']} "))
    reason = next(decisive, reasons[0])
    return reason if row["text"] in (row["status"], reason) else f"{row['text']}; {reason}"
