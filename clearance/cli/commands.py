"""The group that holds every command, each imported when it is asked for.

Not for: what a command does (a file each).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import click

from clearance import __version__

COMMANDS: dict[str, Callable[[], click.Command]] = {
    "batch": lambda: import_module("clearance.cli.batch").batch,
    "check": lambda: import_module("clearance.cli.check").check,
    "compare": lambda: import_module("clearance.cli.comparison").compare,
    "compile": lambda: import_module("clearance.cli.compile_kernels").compile_kernels,
    "convert": lambda: import_module("clearance.cli.convert").convert,
    "gain": lambda: import_module("clearance.cli.gain").gain,
    "new": lambda: import_module("clearance.cli.new").new,
    "pre-commit": lambda: import_module("clearance.cli.pre_commit").pre_commit,
    "profile": lambda: import_module("clearance.cli.profile").profile,
    "schema": lambda: import_module("clearance.cli.schema").schema,
    "srdf": lambda: import_module("clearance.cli.srdf").srdf,
    "verify": lambda: import_module("clearance.cli.verify").verify,
    "view": lambda: import_module("clearance.cli.view").view,
    "workspace": lambda: import_module("clearance.cli.workspace").workspace,
}


class Commands(click.Group):
    """The commands of the table; help on all of them imports all."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Their names, sorted."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name; None for no such name."""
        return COMMANDS[cmd_name]() if cmd_name in COMMANDS else None


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="clearance", message="%(prog)s %(version)s")
def clearance() -> None:
    """How close a robot's path comes to anything, where, when, and how sure that is."""
