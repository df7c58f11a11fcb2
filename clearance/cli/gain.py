"""`clearance gain`: the least change that was found to make every rule of a case hold, with proof."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.notices import say_notices
from clearance.cli.options import AnsweringCommand, OutputPath, asked_options, said, spelled_by
from clearance.cli.progress import shown_work
from clearance.errors import shown
from clearance.gains.request import KINDS, Request
from clearance.options import made, require_needs

if TYPE_CHECKING:
    from clearance.gains.result import Gain
    from clearance.world.case import Case


def _withdraw_older(
    case: Path | None, kind: str | None, out: Path | None, force: bool | None, **_: Any
) -> None:
    """Marks the gains that are to be overwritten as older, before anything is read.

    Raises:
        Unwritable: one of them cannot be marked, or is the case.
    """
    if case is None or out is None or not force:
        return
    from clearance.files import refuse_inputs
    from clearance.gains.changed_files import CASE
    from clearance.gains.every_kind import SUB_FOLDERS
    from clearance.gains.folder import PAGE, withdraw_gain

    found = [out / PAGE]
    if kind == "all":
        found = [page for each in SUB_FOLDERS for page in (out / each).rglob(PAGE)]
    for page in found:
        refuse_inputs([page.with_name(CASE)], [case])
        withdraw_gain(page.parent)


@click.command(cls=AnsweringCommand, report_unread=_withdraw_older)
@click.argument("case", metavar="CASE", type=click.Path(path_type=Path))
@click.option(
    "--kind", type=click.Choice([*KINDS, "all"]), required=True, help="Kind of change to look for."
)
@click.option("--out", metavar="DIR", type=OutputPath(), help="Folder for the changed case.")
@asked_options(Request)
@click.option("--force", is_flag=True, help="Overwrite an older gain in DIR.")
def gain(case: Path, kind: str, out: Path | None, force: bool, **options: Any) -> int:
    """Searches for the least change that makes a case keep its rules.

    The changed case is proven, and so is a lower bound of the change.

    waypoints: smooth offsets of a robot's joints. obstacle, base: a shift along x, y and z, with --turn a turn,
    all joints as they are. timing: a robot begins later, or is slowed down. all: each of them that applies, for
    each robot, and for the obstacle of the worst pair. DIR gets the changed case, ready to be checked, gain.html
    and gain.json. Exit code: 0 if every rule is proven to hold after the change, 1 if not, 2 for bad input.
    """
    from clearance.case.case_file import load_case
    from clearance.case.packed import refuse_zip
    from clearance.files import refuse_inputs, require_folder_place
    from clearance.gains.changed_files import CASE, OWN
    from clearance.gains.folder import FIGURES, PAGE, refuse_existing

    _withdraw_older(case, kind, out, force)
    asked = said(Request, options)
    spelled = spelled_by(Request)
    if kind == "all":
        require_needs(Request, asked, spelled)
    else:
        made(Request, asked, spelled, kind=kind)
    require_folder_place(out)
    read = load_case(case)
    if out is not None:
        refuse_zip(case)
        folders = _folders(read, out, asked.get("robot", ())) if kind == "all" else [out]
        for folder in folders:
            refuse_existing(folder, (*OWN, FIGURES, PAGE), force=force)
            refuse_inputs([folder / name for name in (CASE, FIGURES, PAGE)], read.files_read)
    say_notices(read)
    if kind == "all":
        return _every_kind(read, case, out, asked, force=force)
    with _shown_search(kind):
        found = _found(read, case, kind, asked)
    _save_and_say(found, out, force=force)
    return _code(found)


def _folders(read: Case, out: Path, robot: tuple[str, ...]) -> list[Path]:
    """Where each kind goes, of each robot where there are several."""
    from clearance.gains.every_kind import name_of, trials_of

    return [out / name_of(kind, who, read) for kind, who in trials_of(read, robot)]


def _code(found: Gain) -> int:
    """That of a check of the changed case, where every clearance is proven to hold by the margin."""
    return found.after.verdict.exit_code if found.clearances_kept else ExitCode.VIOLATED


def _found(read: Case, file: Path, kind: str, options: dict[str, Any]) -> Gain:
    from dataclasses import replace

    from clearance.gains.answer import gain as gain_of

    return replace(gain_of(read, kind, **options), case_file=file)


def _every_kind(
    read: Case, file: Path, out: Path | None, options: dict[str, Any], *, force: bool
) -> int:
    """All kinds one after another, then a table; 0 if any makes every rule hold."""
    from dataclasses import replace

    from clearance.gains.every_kind import every_kind, table_lines

    found = []
    for tried in every_kind(read, options, _shown_search):
        if tried.gain is not None:
            click.echo(f"{tried.name}:")
            own = replace(tried.gain, case_file=file)
            _save_and_say(own, out and out / tried.name, "  ", force=force)
        found.append(tried)
    for line in table_lines(found):
        click.echo(shown(line))
    if all(one.gain is None for one in found):
        return ExitCode.BAD_INPUT
    codes = [_code(one.gain) for one in found if one.gain is not None and one.gain.clearances_kept]
    return min(codes, default=ExitCode.VIOLATED)


def _save_and_say(found: Gain, out: Path | None, before: str = "", *, force: bool) -> None:
    """Writes the gain, before a reader of the lines can leave, and says it, written or not."""
    from clearance.gains.folder import save_gain
    from clearance.gains.sentences import lines_of

    try:
        if out is not None:
            save_gain(found, out, force=force)
    finally:
        for label, line in lines_of(found):
            click.echo(f"{before}{label:10}{shown(line)}")
    if out is not None:
        click.echo(f"{'written':10}{out}: case.yaml, gain.html, gain.json")


def _shown_search(kind: str) -> AbstractContextManager[None]:
    """Says that a search runs, while it does."""
    return shown_work(False, f"searching for the least change: {kind}")
