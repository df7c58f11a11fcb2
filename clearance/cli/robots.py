"""`clearance robots`: what installed packages bring, by the names that `--robot` and case files take."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from clearance.cli import ExitCode

if TYPE_CHECKING:
    from clearance.formats.robot.listing import BroughtRobot


@click.command()
@click.argument("words", metavar="[WORD]…", nargs=-1)
def robots(words: tuple[str, ...]) -> int:
    """Lists the robots of installed packages.

    With WORDs, only robots with each of them in their name.

    Use a name in a case file (`urdf: example-robot-data:ur5`) or after --robot. Triangles are
    counted in collision meshes; a file without a moving joint is no robot.
    Packages that bring robots: pybullet_data, example-robot-data, robot_descriptions. Nothing is
    fetched: robot_descriptions shows what its own loader has fetched before.
    """
    from clearance.formats.files.brought import PROVIDERS
    from clearance.formats.robot.listing import brought_robots

    asked = [word.lower() for word in words]
    found = [one for one in brought_robots() if all(word in one.given.lower() for word in asked)]
    width = max((len(one.given) for one in found), default=0)
    for one in found:
        click.echo(f"{one.given:{width}}  {one.n_links:4} links  {_collision(one)}")
    missing = [provider for provider in PROVIDERS if provider.folder is None]
    for provider in missing:
        click.echo(f"not here: {provider.name} ({provider.remedy})", err=True)
    if not found and len(missing) < len(PROVIDERS):
        click.echo("no robot has such a name", err=True)
    return ExitCode.CLEAR


def _collision(one: BroughtRobot) -> str:
    """What is measured of a robot."""
    from clearance.record.wording import count

    parts = []
    if one.n_triangles is None:
        parts.append("meshes that cannot be read")
    elif one.n_triangles:
        parts.append(count(one.n_triangles, "triangle"))
    if one.n_shapes:
        parts.append(count(one.n_shapes, "round or box shape"))
    if one.n_missing:
        parts.append(f"{count(one.n_missing, 'mesh file')} missing")
    return ", ".join(parts) or "no collision shapes"
