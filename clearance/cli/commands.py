"""The group that holds every command.

Not for: what a command does (a file each).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from clearance import __version__
from clearance.cli.batch import batch
from clearance.cli.check import check
from clearance.cli.comparison import compare
from clearance.cli.convert import convert
from clearance.cli.demo import demo
from clearance.cli.explain import explain
from clearance.cli.gain import gain
from clearance.cli.new import new
from clearance.cli.pack import pack
from clearance.cli.pre_commit import pre_commit
from clearance.cli.profile import profile
from clearance.cli.robots import robots
from clearance.cli.srdf import srdf
from clearance.cli.verify import verify
from clearance.cli.view import view
from clearance.cli.workspace import workspace


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="clearance", message="%(prog)s %(version)s")
def clearance() -> None:
    """How close a robot's path comes to anything, where, when, and how sure that is."""


RESULTS = ("summary", "findings", "gain", "workspace", "comparison", "audit")
"""The results that have a JSON Schema."""


def made_schema(results: str | None) -> dict[str, Any]:
    """The JSON Schema of one of `RESULTS`, or of case files."""
    from clearance.formats.schema.json_schema import case_schema
    from clearance.gains.figures import figures_schema
    from clearance.report.answers_schema import audit_schema, comparison_schema, workspace_schema
    from clearance.report.results_schema import findings_schema, summary_schema

    of_results = (
        summary_schema, findings_schema, figures_schema, workspace_schema, comparison_schema, audit_schema,
    )  # fmt: skip
    made: dict[str | None, Callable[[], dict[str, Any]]] = {None: case_schema}
    return (made | dict(zip(RESULTS, of_results, strict=True)))[results]()


@click.command()
@click.option(
    "--results",
    is_flag=False,
    flag_value="summary",
    type=click.Choice(RESULTS),
    help="Print the schema of this result file instead (summary.json, …), or of `srdf audit --json`.",
)
def schema(results: str | None) -> None:
    """Prints the JSON Schema of case or result files.

    With it editors complete keys and mark faults.

    Keep it in a file and name that in a case file's first line:
    # yaml-language-server: $schema=clearance.schema.json
    """
    import json

    click.echo(json.dumps(made_schema(results), indent=2))


for command in (
    batch,
    check,
    compare,
    convert,
    demo,
    explain,
    gain,
    new,
    pack,
    pre_commit,
    profile,
    robots,
    schema,
    srdf,
    verify,
    view,
    workspace,
):
    clearance.add_command(command)
