"""`clearance explain`: what a code means, why it matters, and what to do. Not for: the table (`codes.toml`)."""

from __future__ import annotations

import click

from clearance.codes import Entry, entries


@click.command()
@click.argument("code", required=False)
def explain(code: str | None) -> None:
    """Explain CODE, as CL104; without it, list all codes.

    A code stands in brackets behind each error, warning and note.
    """
    table = entries()
    if code is None:
        for entry in table.values():
            click.echo(f"{entry.code}  {entry.title}")
        return
    found = table.get(code.upper())
    if found is None:
        from clearance.errors import BadInput, nearest_name

        raise BadInput(f"there is no code {code!r}", valid=nearest_name(code.upper(), table))
    click.echo("\n".join(_lines(found)))


def _lines(entry: Entry) -> list[str]:
    return [
        f"{entry.code}  {entry.title}  ({entry.group.lower()}: {entry.of})",
        "",
        f"  meaning         {entry.means}",
        f"  why it matters  {entry.matters}",
        f"  what to do      {entry.remedy}",
        f"  example         {entry.example} [{entry.code}]",
    ]
