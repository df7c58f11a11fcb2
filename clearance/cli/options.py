"""What several commands take from the command line: lengths in millimetres, which motion is meant, xacro."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from clearance.world.notice import KINDS


class LengthParamType(click.ParamType):
    """A length in millimetres, finite and not negative; handed on in metres."""

    name = "mm"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The length [m]."""
        try:
            length = float(value)
        except ValueError:
            length = math.nan
        if not (math.isfinite(length) and length >= 0.0):
            self.fail(f"{value!r} is not a length; a number of millimetres, 0 or more", param, ctx)
        return length / 1000.0


class ColumnsParamType(click.ParamType):
    """Columns of a table by what they are: `time,elbow=q3`; one name alone is both."""

    name = "columns"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> dict[str, str]:
        """The column of each joint, and of time."""
        found = {}
        for part in value.split(","):
            name, separator, column = (one.strip() for one in part.partition("="))
            if not name or (separator and not column):
                self.fail(f"{value!r} is not a list of columns such as time,elbow=q3", param, ctx)
            found[name] = column or name
        return found


class OutputPath(click.Path):
    """A place to write; an empty one, mostly a variable that is not set, would be the current folder."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(
        self,
        value: str | os.PathLike[str],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> Path:
        """The path."""
        if not os.fspath(value):
            self.fail(
                "an empty path; a place to write is needed ('.' is the current folder)", param, ctx
            )
        path = super().convert(value, param, ctx)
        assert isinstance(path, Path)  # as `path_type` says
        return path


def in_order(*options: Callable[..., Any]) -> Callable[..., Any]:
    """The decorator that adds the options to a command, in their order."""

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def package_dir_option(told: str) -> Callable[..., Any]:
    """The option for folders of packages; `told` says what is looked for there."""
    return click.option(
        "--package-dir",
        "package_dirs",
        metavar="DIR",
        multiple=True,
        type=click.Path(path_type=Path),
        help=f"Where {told} looked for; may be given again.",
    )


class IncludeParamType(click.ParamType):
    """A model that a scene includes, and what is taken for it: `URI=skip`, `URI=PATH`."""

    name = "include"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str]:
        """Both; the URI may hold the sign too."""
        uri, _, model = value.rpartition("=")
        if not uri or not model:
            self.fail(f"{value!r} is not URI=skip or URI=PATH", param, ctx)
        return uri, model


INCLUDE_OPTION = click.option(
    "--include",
    "includes",
    metavar="URI=skip|PATH",
    multiple=True,
    type=IncludeParamType(),
    help="Leave out a model that the SDF scene includes, or use the one at PATH instead; may be given again.",
)


def accept_option(which: str) -> Callable[..., Any]:
    """The option that takes kinds of suspect input as they are; `which` verdict they then do not decide."""
    return click.option(
        "--accept",
        metavar="KIND",
        multiple=True,
        type=click.Choice(KINDS),
        help=f"Let no suspect input of this kind decide {which} ({', '.join(KINDS)}).",
    )


def motion_option(*more: str, told: str = "") -> Callable[..., Any]:
    """The option that says which motion is meant; `more` kinds of it, and what they are."""
    return click.option(
        "--motion",
        type=click.Choice(["kinematic", "simulated", *more]),
        default="kinematic",
        show_default=True,
        help=f"kinematic: the trajectory itself. simulated: what a controlled robot makes of it.{told}",
    )


class XacroArgumentParamType(click.ParamType):
    """One argument of a xacro file, as xacro's own command line writes it."""

    name = "name:=value"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str]:
        """Name and value."""
        name, separator, given = value.partition(":=")
        if not separator or not name:
            self.fail(f"{value!r} is not an argument; name:=value", param, ctx)
        return name, given


def _by_name(
    ctx: click.Context, param: click.Parameter, given: tuple[tuple[str, str], ...]
) -> dict[str, str]:
    if given and not ctx.params.get("xacro"):
        raise click.UsageError("--xacro-arg says nothing without --xacro")
    return dict(given)


XACRO_OPTIONS = (
    click.option(
        "--xacro-arg",
        "xacro_args",
        metavar="NAME:=VALUE",
        multiple=True,
        type=XacroArgumentParamType(),
        callback=_by_name,
        help="An argument of the xacro file; may be given again.",
    ),
    click.option(
        "--xacro",
        is_flag=True,
        is_eager=True,
        help="Let xacro make URDF of the robot's file. It evaluates the Python in it.",
    ),
)
"""How a robot's file is made into URDF."""
