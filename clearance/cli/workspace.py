"""`clearance workspace`: what several robots of one cell share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.options import AnsweringCommand, OutputPath, SortParamType
from clearance.options import LENGTH

if TYPE_CHECKING:
    from clearance.record.workspace import Workspace

MOST_LINKS = 8


def _withdraw_older(out: Path | None, case_files: Sequence[Path] | None, **_: Any) -> None:
    """Marks an older answer, before anything is read.

    Raises:
        Unwritable: it cannot be marked, or is one of the cases.
    """
    if out is None:
        return
    from clearance.files import refuse_inputs
    from clearance.report.workspace import OWN, withdraw_workspace

    refuse_inputs([out / name for name in OWN], case_files or ())
    withdraw_workspace(out)


@click.command(cls=AnsweringCommand, report_unread=_withdraw_older)
@click.argument(
    "case_files", metavar="CASE.yaml...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@click.option(
    "--out",
    metavar="DIR",
    type=OutputPath(),
    help="Write the region (STL, GLB), a picture (SVG) and the figures (JSON) here.",
)
@click.option(
    "--within-mm",
    type=SortParamType(LENGTH),
    help="Size of the pieces of the sweep; smaller is tighter and slower.  [default: 5]",
)
@click.option(
    "--convex-parts",
    is_flag=True,
    help="Cut the links whose hulls meet into convex parts: tighter, slower.",
)
@click.option(
    "--limit-litres",
    type=click.FloatRange(min=0.0),
    help="Exit with 1 where the shared volume is above this.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the figures as one JSON object only.")
def workspace(
    case_files: tuple[Path, ...],
    out: Path | None,
    within_mm: float | None,
    convex_parts: bool,
    limit_litres: float | None,
    as_json: bool,
) -> int:
    """Finds the region that robots share.

    More than one robot passes there, whatever the timing of their trajectories.

    The robots are those of one CASE.yaml, or of several cases of one cell, in one world frame.
    Carried parts belong to their robot. Space shared with a robot that it stands on is not
    counted. The volume is an upper bound. Exit code: 0 done, 1 above the limit given, 2 bad or
    suspect input.
    """
    from clearance.extras import require

    _withdraw_older(out, case_files)
    require("contact", "a shared workspace", "manifold3d")
    from clearance.case.case_file import load_case
    from clearance.cli.notices import say_notices
    from clearance.files import refuse_inputs, require_folder_place
    from clearance.report.workspace import OWN
    from clearance.simulate.answers.workspace.workspace import WITHIN, shared_workspace

    require_folder_place(out)
    cases = [load_case(path) for path in case_files]
    if out is not None:
        read = [path for case in cases for path in case.files_read]
        refuse_inputs([out / name for name in OWN], read)
    is_suspect = any([say_notices(case) for case in cases])
    found = shared_workspace(
        cases,
        within=WITHIN if within_mm is None else within_mm,
        cut_concave=convex_parts,
    )
    if out is not None:
        from clearance.report.workspace import write_workspace

        write_workspace(found, out)
    _print(found, out, as_json)
    if is_suspect:
        return ExitCode.BAD_INPUT
    above = limit_litres is not None and found.volume * 1e3 > limit_litres
    return ExitCode.VIOLATED if above else ExitCode.CLEAR


def _print(found: Workspace, out: Path | None, as_json: bool) -> None:
    if as_json:
        from clearance.report.summary import json_text
        from clearance.report.workspace import workspace_summary

        click.echo(json_text(workspace_summary(found)), nl=False)
        return
    for line in _lines(found, out):
        click.echo(line)


def _lines(found: Workspace, out: Path | None) -> list[str]:
    pieces = ", ".join(
        f"{n} of {name}" for n, name in zip(found.n_pieces, found.names, strict=True)
    )
    if found.region.is_empty:
        lines = [f"nothing is shared by {', '.join(found.names)}"]
    else:
        import numpy as np

        from clearance.record.wording import litres

        x, y, z = np.round(found.region.centroid, 3) + 0.0  # no -0.000
        lines = [
            f"shared at most {litres(found.volume)} litres, about ({x:.3f}, {y:.3f}, {z:.3f}) m",
            *(
                f"  {p.robot_a}/{p.link_a} - {p.robot_b}/{p.link_b}"
                for p in found.links[:MOST_LINKS]
            ),
        ]
        more = len(found.links) - MOST_LINKS
        lines += [f"  and {more} more pairs of links, see --json"] if more > 0 else []
    lines.append(
        f"an upper bound: convex pieces ({pieces}) hold the sweeps, "
        f"made wider by up to {found.leaves * 1e3:.3g} mm for the motion between the samples"
    )
    if found.uncounted:
        lines[0] += f", without the {found.uncounted} of the cases"
    lines += [
        f"not counted: what {a} shares with {b}, on which it stands" for a, b in found.carried
    ]
    if found.excluded:
        lines.append(f"left out, as the cases say: {', '.join(found.excluded)}")
    return lines if out is None else [*lines, f"written to {out}"]
