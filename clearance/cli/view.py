"""`clearance view`: a report's replay in the browser."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
def view(folder: Path) -> None:
    """Shows the replay of a report folder in the browser: robot, scene and connecting line.

    DIR is what `clearance check --out DIR` has written.
    """
    from clearance.view import show

    show(folder)
