"""`clearance convert`: a trajectory from one format to another."""

from __future__ import annotations

from pathlib import Path

import click

from clearance.cli import ExitCode
from clearance.cli.options import OutputPath


@click.command()
@click.argument("in_file", metavar="IN", type=click.Path(path_type=Path))
@click.argument("out_file", metavar="OUT", type=OutputPath())
@click.option(
    "--which",
    metavar="N",
    type=click.IntRange(min=1),
    help="Which trajectory of a file that holds several, from 1.",
)
@click.option("--topic", help="Which topic of a bag.")
@click.option("--force", is_flag=True, help="Overwrite OUT where it is there.")
def convert(
    in_file: Path, out_file: Path, which: int | None, topic: str | None, force: bool
) -> int:
    """The trajectory IN as OUT: a CSV table, or a JointTrajectory message in YAML or JSON, by suffix.

    IN may be a bag, too. Every number comes back bit for bit; times of messages are whole
    nanoseconds, and a note says where they were not. Exit code: 0, or 2 for bad input.
    """
    from clearance.cli.places import refuse_inputs, require_file_place
    from clearance.errors import Unwritable, at, unwritable
    from clearance.load.timed_files import load_trajectory
    from clearance.load.trajectory_request import Choice
    from clearance.load.trajectory_writer import written

    require_file_place(out_file)
    refuse_inputs([out_file], [in_file])
    if out_file.exists() and not force:
        raise Unwritable("is there already", where=str(out_file), valid="--force overwrites it")
    trajectory, notes = load_trajectory(in_file, Choice(which, topic=topic))
    with at(in_file.name):
        content, changes = written(trajectory, out_file.name)
    with unwritable(out_file):
        out_file.write_bytes(content)
    for note in (*notes, *(f"{out_file.name}: {change}" for change in changes)):
        click.echo(f"note: {note}")
    n_joints = len(trajectory.joint_names)
    click.echo(f"written {out_file}: {trajectory.n_steps} samples of {n_joints} joints")
    return ExitCode.CLEAR
