"""`clearance new`: from a robot, a motion and a scene, in whatever formats they are, to a case."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from clearance.cli import ExitCode
from clearance.cli.new_given import (
    given_of,
    keys_in,
    merged,
    motion_of,
    names_in,
    naming_options,
    start_in,
)
from clearance.cli.notices import say_notices
from clearance.cli.options import INCLUDE_OPTION, OutputPath, SortParamType, xacro_options
from clearance.errors import shown
from clearance.extras import LIBRARIES, is_installed
from clearance.options import LENGTH
from clearance.run.options import COLUMNS

if TYPE_CHECKING:
    from clearance.case.new_case.files import NewCase
    from clearance.case.new_case.robot import NewCaseRequest

_MOST_NOTES = 8

_UNITS = {"rad": "angle", "deg": "angle", "m": "length", "mm": "length"}


@click.command()
@click.argument("out_dir", metavar="OUT_DIR", type=OutputPath())
@click.option(
    "--robot",
    required=True,
    metavar="FILE",
    help="Robot: URDF, a xacro file, or a name that `clearance robots` lists.",
)
@click.option(
    "--trajectory", metavar="FILE", help="Motion: CSV, JointTrajectory in YAML or JSON, or a bag."
)
@click.option("--topic", help="Topic of the bag to read.")
@click.option(
    "--which",
    type=click.IntRange(min=1),
    help="Number of the trajectory to read, from 1, if the file has several.",
)
@click.option(
    "--units",
    multiple=True,
    type=click.Choice([*_UNITS]),
    help="Unit of a CSV whose header names none. May be given again.",
)
@click.option(
    "--period",
    type=click.FloatRange(min=0, min_open=True),
    help="Time from row to row of a CSV without times [s].",
)
@click.option(
    "--joints",
    type=names_in,
    metavar="A,B,…",
    help="Joints of the columns of a CSV without a header, in order.",
)
@click.option(
    "--columns",
    type=SortParamType(COLUMNS),
    metavar="A,B=C,…",
    help="Columns of the CSV to read, no others: time, joint names, or joint=column.",
)
@click.option(
    "--states",
    type=names_in,
    metavar="A,B,…",
    help="Move through these states of the SRDF (or keyframes of MJCF), in place of a trajectory.",
)
@click.option(
    "--program",
    metavar="FILE",
    help="Robot program to follow: ours, URScript, RAPID, KRL or FANUC LS.",
)
@click.option("--entry", metavar="NAME", help="Procedure of the program to run.")
@click.option(
    "--flange", metavar="LINK", help="Link that is the controller's flange.  [default: tool0]"
)
@click.option(
    "--skip",
    multiple=True,
    metavar="NAME",
    help="Instruction of the program to leave out, one that moves nothing. May be given again.",
)
@click.option(
    "--program-keys",
    multiple=True,
    type=keys_in,
    metavar="YAML",
    help="Other keys of the program: 'axes_as: abb, zones: {CNT: 0.05}'. May be given again.",
)
@click.option(
    "--start",
    type=start_in,
    metavar="JOINT=VALUE,…|STATE",
    help="Joint positions at the start of the program [rad or m], or a state of the SRDF.",
)
@click.option("--scene", metavar="FILE", help="Obstacles: YAML, SDF, or a MoveIt scene.")
@INCLUDE_OPTION
@click.option(
    "--srdf",
    metavar="FILE",
    help="SRDF: measure self-clearance, except for the pairs that it excuses.",
)
@click.option(
    "--rest",
    multiple=True,
    metavar="STATE",
    help="State of the SRDF or MJCF for joints that nothing moves. May be given again.",
)
@click.option(
    "--fail-mm",
    "fail",
    type=SortParamType(LENGTH),
    help="Fail limit; without it only contact fails.",
)
@click.option(
    "--warn-mm",
    "warn",
    type=SortParamType(LENGTH),
    help="Warn limit: steps closer than this are near misses.",
)
@click.option("--joint-limits", metavar="FILE", help="Joint limits: joint_limits.yaml of MoveIt.")
@click.option("--controllers", metavar="FILE", help="Tracking tolerances: ros2_controllers.yaml.")
@click.option(
    "--package-dir",
    "package_dirs",
    metavar="DIR",
    multiple=True,
    help="Folder to search for package://. May be given again.",
)
@click.option(
    "--geometry",
    type=click.Choice(["collision", "visual", "collision_or_visual"]),
    help="Shapes of the links to measure.  [default: collision; visual where there are no others]",
)
@xacro_options
@click.option("--check", "at_once", is_flag=True, help="Run the printed `clearance check` at once.")
@click.option("--force", is_flag=True, help="Overwrite the files of a case in OUT_DIR.")
def new(out_dir: Path, at_once: bool, force: bool, **given: Any) -> int:
    """Writes a case from a robot, a motion and a scene.

    OUT_DIR gets case.yaml to edit, trajectory.csv and scene.yaml.

    Robot and meshes stay where they are. A line is printed for each input taken and each
    assumption made, then the command that checks the case. Exit code: 0, or 2 for bad input; with --check
    that of the check.
    """
    from clearance.case.new_case.robot import NewCaseRequest

    def of(*names: str) -> dict[str, Any]:
        return {name: given[name] for name in names}

    robot = {"urdf": given["robot"], **of("xacro", "xacro_args", "package_dirs", "geometry")}
    robot |= of("srdf", "joint_limits", "controllers")
    motion = {
        "file": given["trajectory"],
        **of("topic", "which"),
        "units": {_UNITS[unit]: unit for unit in given["units"]},
        **of("period", "joints"),
        "columns": dict(given["columns"] or ()),
    }
    program = {"file": given["program"], **of("entry"), "link": given["flange"]}
    program |= of("skip", "start")
    states = given["states"]
    asked = motion_of(given_of(motion), merged([given_of(program), *given["program_keys"]]), states)
    request = NewCaseRequest(
        given_of(robot),
        asked or None,
        states=states or (),
        rest=given["rest"],
        scene=given["scene"],
        includes=dict(given["includes"]),
        limits={level: given[level] for level in ("fail", "warn")},
    )
    made = _made(request, out_dir)
    _write(made, out_dir, force)
    _print(made, out_dir, at_once)
    return _checked(_command(out_dir)) if at_once else ExitCode.CLEAR


def _made(given: NewCaseRequest, out_dir: Path) -> NewCase:
    from clearance.case.new_case.files import new_case

    with naming_options():
        return _proposing(new_case(given, out_dir))


def _proposing(made: NewCase) -> NewCase:
    """The case with pairs that touch at every step as a comment, as a base on its floor."""
    from clearance.errors import ClearanceError
    from clearance.run import check
    from clearance.simulate.answers.standing import touching_throughout

    try:
        run = check(made.case, certify=False, contact="none")
    except ClearanceError:  # the check says so when the case is asked
        return made
    return made.proposing(touching_throughout(run.record))


def _write(made: NewCase, out_dir: Path, force: bool) -> None:
    """Writes all files or none."""
    from clearance.case.new_case.files import CASE, TRAJECTORY
    from clearance.case.new_case.text import SCENE
    from clearance.errors import Unwritable
    from clearance.files import write_files

    if out_dir.exists() and not out_dir.is_dir():
        raise Unwritable("is a file", where=str(out_dir), valid="a folder is needed")
    read = [one.read_from for one in made.sources]
    write_files(out_dir, made.files, read, force=force, others=(CASE, TRAJECTORY, SCENE))


def _print(made: NewCase, out_dir: Path, at_once: bool) -> None:
    """What was taken, what was assumed, what is to be known, what was written, and what checks it.

    Args:
        at_once: a check follows, which tells what it reads itself.
    """
    if not at_once:
        say_notices(made.case)
    notes = [*made.lost, *(() if at_once else made.notes)]
    if len(notes) > _MOST_NOTES:
        n_more = len(notes) - _MOST_NOTES
        notes = [*notes[:_MOST_NOTES], f"and {n_more} more; `clearance check` prints them"]
    for label, lines in (
        ("took", made.taken),
        ("assumed", made.assumed),
        ("note", notes),
        ("written", [", ".join(str(out_dir / name) for name in made.files)]),
    ):
        for line in lines:
            click.echo(f"{label:10}{shown(line)}")
    click.echo(f"{'run':10}clearance check {shlex.join(_command(out_dir))}")


def _command(out_dir: Path) -> list[str]:
    """What follows `clearance check`; a report only where what makes it is installed."""
    makes_pages = all(is_installed(library) for library in LIBRARIES["report"])
    return [
        str(out_dir / "case.yaml"),
        *(["--out", str(out_dir / "report")] if makes_pages else []),
    ]


def _checked(command: list[str]) -> int:
    """The exit code of a check."""
    from clearance.cli.check import check

    with check.make_context("check", [*command]) as context:
        return check.invoke(context)
