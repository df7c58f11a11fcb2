"""`clearance schema`: the case file's keys for editors."""

from __future__ import annotations

import click


@click.command()
def schema() -> None:
    """Prints the JSON Schema of case files, with which editors complete keys and mark faults.

    Keep it in a file and name that in a case file's first line:
    # yaml-language-server: $schema=clearance.schema.json
    """
    import json

    from clearance.formats.schema.json_schema import case_schema

    click.echo(json.dumps(case_schema(), indent=2))
