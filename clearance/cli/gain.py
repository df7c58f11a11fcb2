"""`clearance gain`: the least change that was found to make every rule of a case hold, with proof."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.gain_options import (
    PointParamType,
    ShiftRangeParamType,
    TimeWindowParamType,
    ToolToleranceParamType,
)
from clearance.cli.notices import say_notices
from clearance.cli.options import LengthParamType, OutputPath
from clearance.errors import BadInput, shown

if TYPE_CHECKING:
    from clearance.gains.answer import Gain
    from clearance.world.case import Case

AXES = ("x", "y", "z")

_KINDS = ("waypoints", "obstacle", "base", "timing", "all")


@click.command()
@click.argument("case", metavar="CASE", type=click.Path(path_type=Path))
@click.option("--kind", type=click.Choice(_KINDS), required=True, help="What may be changed.")
@click.option("--out", metavar="DIR", type=OutputPath(), help="Where the changed case goes.")
@click.option(
    "--margin-mm", "margin", type=LengthParamType(), default="0", help="Above the fail limits."
)
@click.option(
    "--robot",
    metavar="NAME",
    multiple=True,
    help="Which; needed where there are several. Of waypoints given again: paths that are changed together.",
)
@click.option("--obstacle", metavar="NAME", help="Which; needed where there are several.")
@click.option(
    "--keep",
    metavar="START:END",
    multiple=True,
    type=TimeWindowParamType(),
    help="[s of the run] In which a path stays as it is, with the samples next to it; may be given again.",
)
@click.option(
    "--keep-ends/--free-ends", default=True, show_default=True, help="Whether a path's ends stay."
)
@click.option(
    "--keep-tool",
    metavar="TIME=MM,DEG",
    multiple=True,
    type=ToolToleranceParamType(),
    help="How far the tool may move and turn at a time of the run, as 12.0=2mm,1deg; may be given again.",
)
@click.option(
    "--tool", metavar="LINK", help="Which; else the first link that all joints of the path move."
)
@click.option(
    "--most-delay",
    metavar="S",
    type=click.FloatRange(min=0.0),
    default=60.0,
    show_default=True,
    help="[s] That is looked at.",
)
@click.option(
    "--within-mm",
    "within",
    metavar="X,Y,Z",
    type=ShiftRangeParamType(),
    help="How far a shift may go, either way; as LOW:HIGH one way more than the other, as 50,0:100,0.",
)
@click.option(
    "--turn", type=click.Choice(AXES), help="A turn beside the shift, about an axis of the world."
)
@click.option(
    "--about-mm",
    "about",
    metavar="X,Y,Z",
    type=PointParamType(),
    help="A point of that axis in the world; else the origin of what is moved.",
)
@click.option(
    "--most-turn-deg", metavar="DEG", type=float, help="Of the turn, either way; else 180."
)
@click.option(
    "--tool-path",
    type=click.Choice(("moved", "kept")),
    help="Of a base: its joints as they are; or its tool where it was, by joints that make up for the base.",
)
@click.option("--slow-down", is_flag=True, help="Of timing: go slower in place of beginning later.")
@click.option("--force", is_flag=True, help="Overwrite an older gain in DIR.")
def gain(case: Path, kind: str, out: Path | None, force: bool, **options: Any) -> int:
    """The least change found with which every rule of CASE holds, proven at every moment, and what none can beat.

    waypoints: smooth offsets of a robot's joints. obstacle, base: a shift along x, y and z, with --turn a turn,
    all joints as they are. timing: a robot begins later, or is slowed down. all: each of them that applies, of
    each robot, and the obstacle of the worst pair. DIR gets the changed case, ready to be checked, gain.html and
    gain.json. Exit code: 0 if every rule is proven to hold then, 1 if not, 2 for bad input.
    """
    from clearance.case.case_file import load_case
    from clearance.cli.places import require_folder_place
    from clearance.files import refuse_inputs
    from clearance.gains.changed_files import CASE, OWN
    from clearance.gains.folder import FIGURES, PAGE, refuse_taken

    options = _with_turn(options) | {"robot": _robot(options["robot"])}
    require_folder_place(out)
    read = load_case(case)
    if out is not None:
        sources = [one.read_from for one in read.sources if one.is_file]
        folders = _folders(read, out, options["robot"]) if kind == "all" else [out]
        for folder in folders:
            refuse_taken(folder, (*OWN, FIGURES, PAGE), force=force)
            refuse_inputs([folder / name for name in (CASE, FIGURES, PAGE)], sources)
    say_notices(read)
    if kind == "all":
        return _every_kind(read, case, out, options, force=force)
    with _shown_search(kind):
        found = _found(read, case, kind, options)
    _say(found)
    _save(found, out, force=force)
    return _code(found)


def _robot(names: tuple[str, ...]) -> str | tuple[str, ...] | None:
    """The one that is named, or several."""
    return names if len(names) > 1 else next(iter(names), None)


def _folders(read: Case, out: Path, robot: str | tuple[str, ...] | None) -> list[Path]:
    """Where each kind goes, of each robot where there are several."""
    from clearance.gains.every_kind import name_of, trials_of

    return [out / name_of(kind, who, read) for kind, who in trials_of(read, robot)]


def _with_turn(options: dict[str, Any]) -> dict[str, Any]:
    """The options with the turn that some of them say.

    Raises:
        BadInput: more is said of a turn that is not asked for.
    """
    from clearance.gains.turn import Turn

    axis, about, most = (options.pop(name) for name in ("turn", "about", "most_turn_deg"))
    if axis is None:
        if about is not None or most is not None:
            raise BadInput("a turn is spoken of that is not asked for", valid="--turn x, y or z")
        return {**options, "turn": None}
    most = math.pi if most is None else math.radians(most)
    return {**options, "turn": Turn(axis, about, most)}


def _code(found: Gain) -> int:
    """That of a check of the changed case, where every rule is proven to hold by the margin."""
    return found.after.verdict.exit_code if found.kept else ExitCode.VIOLATED


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
            _say(tried.gain, "  ")
            _save(replace(tried.gain, case_file=file), out and out / tried.name, force=force)
        found.append(tried)
    for line in table_lines(found):
        click.echo(shown(line))
    if all(one.gain is None for one in found):
        return ExitCode.BAD_INPUT
    kept = [_code(one.gain) for one in found if one.gain is not None and one.kept]
    return min(kept, default=ExitCode.VIOLATED)


def _say(found: Gain, before: str = "") -> None:
    from clearance.gains.sentences import lines_of

    for label, line in lines_of(found):
        click.echo(f"{before}{label:10}{shown(line)}")


def _save(found: Gain, out: Path | None, *, force: bool) -> None:
    from clearance.gains.folder import save_gain

    if out is not None:
        save_gain(found, out, force=force)
        click.echo(f"{'written':10}{out}: case.yaml, gain.html, gain.json")


@contextmanager
def _shown_search(kind: str) -> Iterator[None]:
    """Says on a terminal that a search runs, while it does."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(f"searching for the least change: {kind}"):
        yield
