"""`clearance explain`: what a code means, why it matters, and what to do. Not for: the table (`codes.toml`)."""

from __future__ import annotations

from typing import NoReturn

import click

from clearance.codes import Entry, codes, entries

WORDS = {
    "clear": ("No pair comes below the warn limit.", "Nothing: exit code 0."),
    "near": ("A pair comes below the warn limit and keeps the fail limit.", "Look at the pair: exit code 0."),
    "violated": (
        "A pair comes below the fail limit, or another rule of the case is broken.",
        "Change the motion or the cell; `clearance gain` finds the least change. Exit code 1.",
    ),
    "contact": (
        "Two bodies touch, overlap, or one is inside the other.",
        "Change the motion, or allow a pair that is meant to touch (`allow`). Exit code 1.",
    ),
    "not proven": (
        "Limits are kept as measured, but not proven: with tolerances, or on a stretch of a program.",
        "Make the error that the line `tolerances` names smaller, or see the stretch. Exit code 1.",
    ),
    "fail": ("A limit is kept as measured, but not proven with the tolerances.", "As for `not proven`."),
    "accepted": (
        "As `fail`, but the case lets limits pass that tolerances leave unproven (`unproven_ok`).",
        "Nothing: exit code 0.",
    ),
    "unused waiver": (
        "All is well, but a waiver has expired or nothing needs it.", "Remove the waiver. Exit code 1.",
    ),
    "warning": (
        "All is well, but for a warning, and `--fail-on-warning` is given.",
        "Mend its cause, or accept its code (`--accept CL420`). Exit code 1.",
    ),
    "suspect": (
        "The input looks wrong, as a mesh in millimetres does; `would be` says what was measured with it.",
        "Correct the input, or accept its kind if it is right (`--accept units`). Exit code 2.",
    ),
    "error": ("A case of a batch cannot be read or answered.", "Correct what its line names."),
    "certified": (
        "A lower bound of the clearance that is proven for the whole motion, between the samples too.",
        "Nothing; `--samples-only` leaves it out.",
    ),
    "at the samples only": (
        "Only the samples were measured: what happens between them is not known.",
        "Leave `--samples-only` and method `paper` out.",
    ),
    "at a single pose": ("The trajectory has one sample: no motion was checked.", "Give a motion."),
}  # fmt: skip
"""The words of headlines: what each means, and what to do."""


@click.command()
@click.argument("code", required=False, nargs=-1)
def explain(code: tuple[str, ...]) -> None:
    """Explains the code of a message, as CL104, or a word of a headline, as suspect.

    A code stands in brackets behind each error and warning. A kind of suspect input, as units, is
    explained too. Without CODE, lists all.
    """
    table, asked = entries(), " ".join(code)
    if not asked:
        for entry in table.values():
            click.echo(f"{entry.code}  {entry.title}  ({entry.of})")
        click.echo("")
        for word, (means, _) in WORDS.items():
            click.echo(f"{word}  {means}")
        return
    found = table.get(asked.upper()) or table.get(codes().get(asked, ""))
    told = WORDS.get(asked.lower())
    if found is None and told is None:
        _refuse(asked)
    if told is not None:
        means, remedy = told
        click.echo(f"{asked.lower()}\n\n  meaning         {means}\n  what to do      {remedy}")
    if found is not None:
        click.echo("\n".join(_lines(found)))


def _refuse(asked: str) -> NoReturn:
    from difflib import get_close_matches

    from clearance.errors import BadInput

    near = get_close_matches(asked.upper(), entries(), 1)
    near = near or get_close_matches(asked, (*codes(), *WORDS), 1)
    hint = f"did you mean {near[0]!r}?" if near else "`clearance explain` lists all"
    raise BadInput(f"there is no code, kind or word {asked!r}", valid=hint)


def _lines(entry: Entry) -> list[str]:
    return [
        f"{entry.code}  {entry.title}  ({entry.group.lower()}: {entry.of})",
        "",
        f"  meaning         {entry.means}",
        f"  why it matters  {entry.matters}",
        f"  what to do      {entry.remedy}",
        f"  example         {entry.example} [{entry.code}]",
    ]
