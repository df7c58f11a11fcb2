"""`clearance convert`: a trajectory, a scene or poses from one format to another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli import ExitCode
from clearance.cli.options import INCLUDE_OPTION, OutputPath, package_dir_option
from clearance.errors import shown

if TYPE_CHECKING:
    from clearance.formats.conversion import ConvertedFiles

_KINDS = ("trajectory", "scene", "poses")


@click.command()
@click.argument("in_file", metavar="IN", type=click.Path(path_type=Path))
@click.argument("out_file", metavar="OUT", type=OutputPath())
@click.option(
    "--kind",
    type=click.Choice(_KINDS),
    help="Content of IN.  [default: by its suffix and its first lines]",
)
@click.option(
    "--which",
    metavar="N",
    type=click.IntRange(min=1),
    help="Number of the trajectory to read, from 1, if IN has several.",
)
@click.option("--topic", help="Topic of the bag to read.")
@package_dir_option("package:// and model:// of a scene are")
@INCLUDE_OPTION
@click.option("--force", is_flag=True, help="Overwrite OUT and the meshes beside it.")
def convert(
    in_file: Path,
    out_file: Path,
    kind: str | None,
    which: int | None,
    topic: str | None,
    package_dirs: tuple[Path, ...],
    includes: tuple[tuple[str, str], ...],
    force: bool,
) -> int:
    """Converts IN into OUT, by the suffix of OUT.

    A trajectory becomes a CSV table, or a JointTrajectory message in YAML or JSON; poses become a CSV table,
    or stamped poses in YAML or JSON; a scene becomes this package's YAML. IN may also be a bag, or a scene in
    SDF, MJCF or of MoveIt. Numbers stay the same bit for bit; times of messages are rounded to nanoseconds,
    with a note. A line names each thing that OUT cannot hold. Warnings are written into a scene, so that each
    check repeats them. Meshes inside a scene get files beside OUT. Exit code: 0, or 2 for bad input.
    """
    from clearance.files import refuse_there, write_files
    from clearance.formats.conversion import Conversion, converted, kind_of
    from clearance.formats.files.input_files import InputFiles
    from clearance.formats.known_formats import Kind
    from clearance.formats.scene.request import includes_of
    from clearance.formats.schema.timed import Choice

    _require_place(in_file, out_file)
    refuse_there([out_file], force=force)
    files = InputFiles(in_file.parent)
    choice = Choice.model_construct(which=which, topic=topic)
    said = includes_of(dict(includes), Path())
    asked = Conversion(in_file, out_file, files, choice, package_dirs, said)
    found = kind_of(in_file, asked.files) if kind is None else Kind(kind)
    made = converted(asked, found)
    read: list[str | Path] = [in_file, *(one.read_from for one in asked.files.sources)]
    write_files(out_file.parent, made.files, read, force=force)
    _print(out_file, made)
    return ExitCode.CLEAR


def _require_place(in_file: Path, out_file: Path) -> None:
    from clearance.errors import Unwritable
    from clearance.files import refuse_inputs, require_file_place

    if not out_file.absolute().parent.is_dir():
        raise Unwritable(
            "cannot write here: there is no such folder", where=str(out_file), valid="make it first"
        )
    require_file_place(out_file, "OUT")
    refuse_inputs([out_file], [in_file])


def _print(out_file: Path, made: ConvertedFiles) -> None:
    for warning in made.warnings:
        click.echo(f"warning: {shown(warning)}", err=True)
    for note in made.notes:
        click.echo(f"note: {shown(note)}")
    others = [str(out_file.parent / name) for name in made.files if name != out_file.name]
    click.echo(f"written {out_file}: {made.amount}" + (f"; {', '.join(others)}" if others else ""))
