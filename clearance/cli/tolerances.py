"""Options of a case's tolerances. Not for: reading them (`case.tolerance.tolerance_file`)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli.options import in_order

if TYPE_CHECKING:
    from clearance.world.case import Case

_OPTIONS = (
    click.option(
        "--tolerance",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Tolerances instead of the case's: how far the real machine may differ from it.",
    ),
    click.option(
        "--unproven-ok",
        is_flag=True,
        help="A limit that is kept, but not proven to be with the tolerances, does not fail the run.",
    ),
)


tolerance_options = in_order(*_OPTIONS)


def with_tolerances(case: Case, path: Path | None) -> Case:
    """The case with the tolerances of a file, if one is given.

    Raises:
        BadInput: with the field and the file.
    """
    if path is None:
        return case
    from clearance.case.tolerance.tolerance_file import with_tolerance

    return with_tolerance(case, path)


def with_leniency(case: Case, unproven_ok: bool) -> Case:
    """The case in which limits that are not proven with its tolerances may pass, if that is wanted.

    Raises:
        UsageError: it has no tolerances to be lenient with.
    """
    if not unproven_ok:
        return case
    if case.tolerance is None:
        raise click.UsageError("--unproven-ok says nothing without tolerances")
    return replace(case, tolerance=replace(case.tolerance, unproven_ok=True))
