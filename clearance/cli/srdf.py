"""`clearance srdf`: which links of a robot may touch; `audit` a file, or `make` one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from clearance.cli import ExitCode
from clearance.cli.options import OutputPath, in_order, package_dir_option, xacro_options


@click.group()
def srdf() -> None:
    """Checks or makes the list of excused link pairs."""


_robot_options = in_order(
    xacro_options,
    package_dir_option("package:// is"),
    click.option(
        "--geometry",
        type=click.Choice(["collision", "visual", "collision_or_visual"]),
        default="collision",
        show_default=True,
        help="Shapes of the links to measure.",
    ),
    click.option(
        "--collada-up-axis",
        type=click.Choice(["ros", "file"]),
        default="ros",
        show_default=True,
        help="Whether COLLADA meshes are turned as their files say.",
    ),
)
"""How a URDF file is read, as the keys of a case's `robot` say it."""


@srdf.command()
@click.argument("urdf", metavar="ROBOT.urdf", type=click.Path(path_type=Path))
@click.argument("srdf_file", metavar="ROBOT.srdf", type=click.Path(path_type=Path))
@_robot_options
@click.option("--json", "as_json", is_flag=True, help="Print the findings as one JSON object only.")
def audit(urdf: Path, srdf_file: Path, as_json: bool, **given: Any) -> int:
    """Proves that excused pairs never meet.

    The pairs are those of ROBOT.srdf, at all joint positions within the limits of ROBOT.urdf.

    Each pair is proven separate, found to meet (with the joint positions), or left undecided. Exit
    code: 0 all pairs excused as Never are proven separate, 1 one of them is not, 2 bad input. A pair
    excused as Adjacent that lies apart at home and can meet gives 1 too.
    """
    from clearance.cli.progress import shown_progress
    from clearance.formats.robot.request import load_robot
    from clearance.formats.robot.srdf import load_srdf
    from clearance.report.srdf import audit_headline, audit_rows, audit_summary, narrowed
    from clearance.report.summary import json_text
    from clearance.simulate.answers.audit.pair import audit as audited

    robot = load_robot(urdf, **given)
    matrix = load_srdf(srdf_file, robot)
    with shown_progress(as_json, ["auditing"]) as progress:
        pairs = audited(robot, matrix, progress)
    if as_json:
        click.echo(json_text(audit_summary(robot, pairs)), nl=False)
    else:
        click.echo(audit_headline(pairs))
        _print_rows(list(audit_rows(robot, pairs)))
        _print_notes(
            [*(f"checked: {line}" for line in narrowed(robot)), *matrix.notes, *robot.notes]
        )
    wrong = any(pair.refuted or pair.unproven or pair.hides_contact for pair in pairs)
    return ExitCode.VIOLATED if wrong else ExitCode.CLEAR


@srdf.command()
@click.argument("urdf", metavar="ROBOT.urdf", type=click.Path(path_type=Path))
@_robot_options
@click.option("--out", metavar="FILE", type=OutputPath(), help="Write it here, not on stdout.")
def make(urdf: Path, out: Path | None, **given: Any) -> int:
    """Writes an SRDF for ROBOT.urdf.

    Excused are pairs that are proven never to meet, and neighbours that lie together at home or never meet.

    Comments list the pairs that can meet and those that are undecided. Exit code: 0, or 2 for bad input.
    """
    from clearance.cli.progress import shown_progress
    from clearance.errors import unwritable
    from clearance.files import refuse_inputs, require_file_place
    from clearance.formats.robot.request import load_robot
    from clearance.report.srdf import narrowed, proposal_headline, proposed_srdf
    from clearance.simulate.answers.audit.pair import propose

    require_file_place(out)
    if out is not None:
        refuse_inputs([out], [urdf])
    robot = load_robot(urdf, **given)
    with shown_progress(False, ["proving"]) as progress:
        pairs = propose(robot, progress)
    text = proposed_srdf(robot, pairs, given["geometry"])
    if out is None:
        click.echo(text, nl=False)
    else:
        with unwritable(out):
            out.write_text(text, encoding="utf-8")
        click.echo(f"written {out}")
    click.echo(proposal_headline(pairs), err=True)
    for line in narrowed(robot):
        click.echo(f"note: checked: {line}", err=True)
    return ExitCode.CLEAR


def _print_rows(rows: list[tuple[str, str, str]]) -> None:
    widths = [max((len(row[i]) for row in rows), default=0) for i in range(2)]
    for pair, reason, finding in rows:
        click.echo(f"  {pair:{widths[0]}}  {reason:{widths[1]}}  {finding}")


def _print_notes(notes: list[str]) -> None:
    for note in notes:
        click.echo(f"note: {note}")
