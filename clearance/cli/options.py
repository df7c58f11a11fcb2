"""What several commands take from the command line: options that are declared once, places to write, xacro."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

import click

from clearance.codes import code_of_error, coded
from clearance.errors import BadInput, Unwritable
from clearance.options import SWITCH, Option, Sort, Spelling, flag_of, options_in


class SortParamType(click.ParamType):
    """A value of a sort of options."""

    def __init__(self, sort: Sort) -> None:
        self.sort, self.name = sort, sort.form.lower()

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The value."""
        if not isinstance(value, str):
            return value
        try:
            return self.sort.read(value)
        except BadInput as error:
            self.fail(str(error), param, ctx)


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


def line_of(error: Exception) -> str:
    """One line on what is wrong, with its code."""
    text = error.format_message() if isinstance(error, click.ClickException) else str(error)
    return coded(" ".join(text.split()) or type(error).__name__, code_of_error(type(error)))


class AnsweringCommand(click.Command):
    """A command of which no older answer outlasts a command line that is not understood.

    Args:
        report_unread: is called with what is wrong as `error`, and the parameters, as far as they are understood.
    """

    def __init__(
        self,
        *given: Any,
        report_unread: Callable[..., None],
        **more: Any,
    ) -> None:
        super().__init__(*given, **more)
        self._report_unread = report_unread

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """The arguments."""
        given = [*args]
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            lenient = {
                name: True
                for name in ("resilient_parsing", "ignore_unknown_options", "allow_extra_args")
            }
            understood = self.make_context(ctx.info_name, given, ctx.parent, **lenient).params
            with suppress(Unwritable):
                self._report_unread(error=error, **understood)
            raise


def in_order(*options: Callable[..., Any]) -> Callable[..., Any]:
    """The decorator that adds the options to a command, in their order."""

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def package_dir_option(what: str) -> Callable[..., Any]:
    """The option for folders of packages; `what` says what is looked for there."""
    return click.option(
        "--package-dir",
        "package_dirs",
        metavar="DIR",
        multiple=True,
        type=click.Path(path_type=Path),
        help=f"Where {what} looked for; may be given again.",
    )


def _include(value: str) -> tuple[str, str]:
    """A model that a scene includes, and what is taken for it; the URI may hold the sign too."""
    uri, _, model = value.rpartition("=")
    if not uri or not model:
        raise click.BadParameter(f"{value!r} is not URI=skip or URI=PATH")
    return uri, model


INCLUDE_OPTION = click.option(
    "--include",
    "includes",
    metavar="URI=skip|PATH",
    multiple=True,
    type=_include,
    help="Leave out a model that the SDF scene includes, or use the one at PATH instead; may be given again.",
)


Command = TypeVar("Command", bound=Callable[..., Any])


def asked_options(
    kind: type, usual: Mapping[str, Any] = {}, arguments: Mapping[str, str] = {}
) -> Callable[[Command], Command]:
    """The decorator that adds the options of a dataclass to a command; `said` takes them from what it is given.

    Args:
        usual: defaults that are others here. arguments: options that are arguments, and what help calls them.
    """
    known = {name: one for name, one in options_in(kind).items() if one.said}
    made = [
        click.argument(
            name, metavar=f"[{arguments[name]}]", required=False, type=SortParamType(one.sort)
        )
        if name in arguments
        else _option(name, one, usual.get(name, one.default))
        for name, one in known.items()
    ]
    return in_order(*made)


def _option(name: str, known: Option, default: Any) -> Callable[..., Any]:
    is_switch = known.sort is SWITCH
    flag = f"--{flag_of(name, known)}"
    shown = {True: known.off and flag[2:], False: "", None: "", (): ""}.get(default)
    shown = known.sort.shown(default) if shown is None else shown
    again = "  May be given again." if known.many else ""
    more: dict[str, Any] = {} if is_switch or known.sort.choices else {"metavar": known.sort.form}
    choices = known.sort.choices
    return click.option(
        f"{flag}/--{known.off.replace('_', '-')}" if known.off else flag,
        name,
        default=None,
        is_flag=is_switch,
        multiple=known.many,
        type=bool if is_switch else click.Choice(choices) if choices else SortParamType(known.sort),
        help=f"{known.help}{again}{f'  [default: {shown}]' if shown else ''}",
        **more,
    )


def said(kind: type, given: dict[str, Any]) -> dict[str, Any]:
    """Takes the options of a dataclass out of what a command is given; those that were said."""
    chosen = {name: given.pop(name) for name in options_in(kind) if name in given}
    return {name: one for name, one in chosen.items() if one is not None and one != ()}


def spelled_by(kind: type, arguments: Mapping[str, str] = {}) -> Spelling:
    """How the command line spells the options of a dataclass."""

    def spelled(name: str, value: object) -> str:
        if name in arguments:
            return arguments[name]
        known = options_in(kind)[name]
        if value is False and known.off:
            return f"--{known.off.replace('_', '-')}"
        flag = f"--{flag_of(name, known)}"
        return flag if value is None or value is True else f"{flag} {value}"

    return spelled


def _xacro_argument(value: str) -> tuple[str, str]:
    """Name and value of one argument, as xacro's own command line writes it."""
    name, separator, given = value.partition(":=")
    if not separator or not name:
        raise click.BadParameter(f"{value!r} is not an argument; name:=value")
    return name, given


def _by_name(
    ctx: click.Context, param: click.Parameter, given: tuple[tuple[str, str], ...]
) -> dict[str, str]:
    if given and not ctx.params.get("xacro"):
        raise click.UsageError("--xacro-arg says nothing without --xacro")
    return dict(given)


xacro_options = in_order(
    click.option(
        "--xacro",
        is_flag=True,
        is_eager=True,
        help="Let xacro make URDF of the robot's file. It evaluates the Python in it.",
    ),
    click.option(
        "--xacro-arg",
        "xacro_args",
        metavar="NAME:=VALUE",
        multiple=True,
        type=_xacro_argument,
        callback=_by_name,
        help="An argument of the xacro file; may be given again.",
    ),
)
"""How a robot's file is made into URDF."""
