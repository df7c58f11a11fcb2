"""`clearance view`: a report in the browser, or the report of one case of a batch."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("folder", metavar="DIR|CASE.yaml|ZIP|STORE", type=click.Path(path_type=Path))
@click.argument("case", metavar="[CASE]", required=False)
def view(folder: Path, case: str | None) -> None:
    """Shows a report in the browser.

    It shows the verdict, robot, scene and the line between the nearest points.

    DIR is a report that `clearance check --out DIR` has written. A case file is checked first. ZIP
    is what `clearance pack` made of either. With STORE, which `clearance batch` has written, and
    the name of a CASE in it, writes that case's full report and prints its place.
    """
    if case is not None:
        _write_case(folder, case)
        return
    from clearance.case.packed import unpacked
    from clearance.progress import doing
    from clearance.report.withdrawn import is_withdrawn
    from clearance.view import PAGE, page_in, show

    folder = folder.parent if folder.name == PAGE else folder
    with unpacked(folder) as packed:
        place = folder if packed is None else packed.entry
        if is_withdrawn(place):
            click.echo(
                "a later run into this folder has not come to its end: what is shown is older",
                err=True,
            )
        page = _checked(folder).encode() if place.is_file() else page_in(place)
        with doing(lambda: ""):
            show(str(folder), page)


def _checked(case_file: Path) -> str:
    """The page of a case; its verdict and warnings are printed."""
    from clearance.report.terminal import print_answer
    from clearance.run import check

    run = check(case_file)
    print_answer(run.report, None)
    return run.page()


def _write_case(place: Path, name: str) -> None:
    from clearance.extras import require

    require("report", "the page of a case")
    from clearance.batch.case_page import write_case_page
    from clearance.batch.listed import item_called, read_list
    from clearance.batch.output import rewrite_page
    from clearance.batch.store import open_store
    from clearance.cli.progress import shown_progress
    from clearance.report.terminal import print_answer

    with open_store(place, make=False) as store:
        item = item_called(read_list(store), name)
    with shown_progress(False, ["measuring", "certifying"]) as progress:
        run, folder = write_case_page(place, item, progress)
    rewrite_page(place)
    print_answer(run.report, folder)
