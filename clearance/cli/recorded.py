"""Options of a recorded run: which file, whose, its clock. Not for: reading it (`case.recorded_run`)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli.options import ColumnsParamType, in_order, motion_option
from clearance.world.notice import GAPS

if TYPE_CHECKING:
    from clearance.world.case import Case

_OPTIONS = (
    click.argument("recorded", metavar="[RUN]", required=False, type=click.Path(path_type=Path)),
    motion_option(
        "recorded", told=" recorded: what it did, in RUN, a bag of joint states or a CSV."
    ),
    click.option(
        "--recorded-offset",
        metavar="S",
        type=float,
        help="Added to the times of RUN.  [default: 0; none is estimated]",
    ),
    click.option(
        "--recorded-robot",
        metavar="NAME",
        help="Whose run it is, where several robots have trajectories.",
    ),
    click.option(
        "--recorded-gaps",
        type=click.Choice(GAPS),
        help="How joints move in a hole of RUN: hold their position, move straight to the next message, or leave "
        "the hole out of the check.  [default: a hole is suspect input]",
    ),
    click.option(
        "--recorded-columns",
        type=ColumnsParamType(),
        metavar="A,B=C,…",
        help="Columns of the CSV to read, and no others: time, joint names, or joint=column.",
    ),
)


recorded_options = in_order(*_OPTIONS)


def require_recorded(
    motion: str,
    recorded: Path | None,
    offset: float | None,
    robot: str | None,
    gaps: str | None,
    columns: dict[str, str] | None,
) -> None:
    """Nothing, if a recording is given exactly where one is meant.

    Raises:
        UsageError: it is not.
    """
    if motion == "recorded" and recorded is None:
        raise click.UsageError(
            "--motion recorded needs the run: CASE.yaml --motion recorded RUN.csv"
        )
    if motion == "recorded":
        return
    if recorded is not None:
        raise click.UsageError(f"{str(recorded)!r} says nothing without --motion recorded")
    options = {"offset": offset, "robot": robot, "gaps": gaps, "columns": columns}
    for option, given in options.items():
        if given is not None:
            raise click.UsageError(f"--recorded-{option} says nothing without --motion recorded")


def with_recording(
    case: Case,
    path: Path | None,
    offset: float | None,
    robot: str | None,
    gaps: str | None,
    columns: dict[str, str] | None,
) -> Case:
    """The case as it was driven, where a recording is given.

    Raises:
        BadInput: with the file.
    """
    if path is None:
        return case
    from clearance.case.recorded_run import with_recorded

    return with_recorded(case, path, offset or 0.0, robot, gaps, columns)
