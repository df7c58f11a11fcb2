"""`clearance demo`: a case that comes with the package, checked, with a report; or copied, to be edited.

The files are in `clearance/demo`: a case file for each scene, the files that it names, and the arm of all scenes.
"""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path

import click

from clearance.cli import ExitCode
from clearance.cli.options import OutputPath
from clearance.errors import Unavailable, Unwritable
from clearance.extras import require

FOLDER = Path(__file__).parents[1] / "demo"
ROBOT = "heron6"
SCENES = {
    "seam": "a robot program leads the tool round a nozzle between clamps: clear",
    "post": "four samples are far from a post, and the motion between two of them meets it: violated",
}


@click.command()
@click.argument("scene", default="seam", metavar="[SCENE]", type=click.Choice([*SCENES]))
@click.option(
    "--out",
    metavar="DIR",
    type=OutputPath(),
    help="Folder of the report.  [default: clearance_demo]",
)
@click.option("--list", "as_list", is_flag=True, help="List the scenes, and check nothing.")
@click.option(
    "--copy",
    "copy_to",
    metavar="DIR",
    type=OutputPath(),
    help="Copy the scene into a new folder, to be edited, and check nothing.",
)
def demo(scene: str, out: Path | None, as_list: bool, copy_to: Path | None) -> int:
    """Checks a scene that comes with the package.

    Writes a report. SCENE is seam unless given.

    It needs no other files and no network. Without the extra 'report' the scene is checked, and
    no report is written. Exit code: that of the check, so 1 for the scene 'post'.
    """
    if as_list + (copy_to is not None) + (out is not None) > 1:
        raise click.UsageError("--list, --copy and --out exclude each other")
    if as_list:
        for name, about in SCENES.items():
            click.echo(f"{name:10}{about}")
        return ExitCode.CLEAR
    if copy_to is not None:
        _copy(scene, copy_to)
        click.echo(
            f"{'written':10}{copy_to / 'case.yaml'}, with robot, meshes and motion beside it"
        )
        click.echo(f"{'run':10}clearance check {shlex.quote(str(copy_to / 'case.yaml'))}")
        return ExitCode.CLEAR
    return _checked(scene, out)


def _copy(scene: str, folder: Path) -> None:
    """Copies the files of a scene into a folder, all or none.

    Raises:
        Unwritable: something is there already, or there is no way to write there.
    """
    from clearance.files import fill_folder, require_folder_place

    require_folder_place(folder, "--copy")
    if folder.is_dir() and any(folder.iterdir()):
        raise Unwritable("is not empty", where=str(folder), valid="--copy needs a new folder")

    def fill(fresh: Path) -> None:
        for path in FOLDER.glob(f"{scene}*"):
            name = "case.yaml" if path.stem == scene else path.name
            shutil.copyfile(path, fresh / name)
        shutil.copytree(FOLDER / ROBOT, fresh / ROBOT, copy_function=shutil.copyfile)

    fill_folder(folder, fill, own=())


def _checked(scene: str, out: Path | None) -> int:
    """The exit code of a check; without what a report needs, one line says so where no place for it was given."""
    from clearance.cli.check import check

    missing = ""
    if out is None:
        try:
            require("report", "the report")
            out = Path("clearance_demo")
        except Unavailable as error:
            missing = str(error)
    command = [str(FOLDER / f"{scene}.yaml"), *(["--out", str(out)] if out else [])]
    with check.make_context("check", command) as context:
        code = check.invoke(context)
    if missing:
        click.echo(f"  {'no report':<11} {missing}")
    return code
