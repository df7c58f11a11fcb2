"""`clearance pack`: a case, or a report with its receipt, as one zip that needs nothing else.

Not for: the zip (`case.packing`).
"""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from clearance.cli.options import OutputPath

if TYPE_CHECKING:
    from clearance.case.packing import Contents


@click.command()
@click.argument("what", metavar="CASE.yaml|DIR", type=click.Path(path_type=Path))
@click.argument("target", metavar="FILE.zip", type=OutputPath())
@click.option("--force", is_flag=True, help="Overwrite FILE.zip.")
def pack(what: Path, target: Path, force: bool) -> None:
    """Writes a case and all its files into one zip.

    The zip holds robots, meshes, motions, waivers and tolerances, with their sha256 and the
    versions. `clearance check FILE.zip` takes it on any machine. DIR is a report that `clearance
    check --out DIR` has written. The zip then holds the report and, if DIR has a receipt, the
    inputs of its case. `clearance verify FILE.zip` and `clearance view FILE.zip` take it. The same
    input gives the same bytes.
    """
    from clearance.case.packing import case_contents, write_pack
    from clearance.errors import Unwritable
    from clearance.files import refuse_inputs, refuse_there, require_file_place
    from clearance.report.topics.provenance import versions

    if target.suffix.lower() != ".zip":
        raise Unwritable("is no .zip file", where=str(target), valid="pack needs one")
    require_file_place(target, "pack")
    refuse_there([target], force=force)
    contents = _report_contents(what) if what.is_dir() else case_contents(what)
    refuse_inputs([target], [*contents.others, *(one.read_from for one in contents.sources)])
    n_files = write_pack(contents, target, versions())
    click.echo(f"{'written':10}{target}, {n_files} files, {target.stat().st_size / 1e3:.0f} kB")
    takes = "check" if contents.is_case else "verify" if contents.case_file else "view"
    click.echo(f"{'run':10}clearance {takes} {shlex.quote(str(target))}")


def _report_contents(folder: Path) -> Contents:
    """The report in a folder, and the inputs of its case if it has a receipt.

    Raises:
        MissingFile: no report. BadInput: an input has changed since the receipt was written.
    """
    from clearance.case.packing import Contents
    from clearance.cli.run_rows import require_finished
    from clearance.receipt.receipt_file import FILE_NAME
    from clearance.receipt.remade_report import hashes_of
    from clearance.receipt.verifying import inputs_of

    require_finished(folder)
    files = [folder / name for name in (*hashes_of(folder), FILE_NAME)]
    return Contents(folder, *inputs_of(folder), [one for one in files if one.is_file()])
