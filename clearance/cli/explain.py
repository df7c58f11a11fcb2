"""`clearance explain`: what a code means, why it matters, and what to do. Not for: the table (`codes.toml`)."""

from __future__ import annotations

import click

from clearance.codes import Entry, codes, entries


@click.command()
@click.argument("code", required=False)
def explain(code: str | None) -> None:
    """Explains the code of a message, as CL104.

    A code stands in brackets behind each error and warning. A kind of suspect input, as units, is
    explained too. Without CODE, lists all.
    """
    table = entries()
    if code is None:
        for entry in table.values():
            click.echo(f"{entry.code}  {entry.title}  ({entry.of})")
        return
    found = table.get(code.upper()) or table.get(codes().get(code, ""))
    if found is None:
        from difflib import get_close_matches

        from clearance.errors import BadInput

        near = get_close_matches(code.upper(), table, 1) or get_close_matches(code, codes(), 1)
        hint = f"did you mean {near[0]!r}?" if near else "`clearance explain` lists all"
        raise BadInput(f"there is no code or kind {code!r}", valid=hint)
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
