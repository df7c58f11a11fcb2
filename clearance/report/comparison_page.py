"""Two runs side by side as a page: both curves, and what became of each finding.

Not for: comparing (`findings.comparison`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from clearance.errors import BadInput
from clearance.files import write_file
from clearance.findings.comparison import ComparedFinding, Comparison, FindingChange
from clearance.report.comparison_text import HEADS, comparison_cells, comparison_text, doubt_lines
from clearance.report.markup import element, section, table
from clearance.report.plain_page import ClearanceCurve, CurvesWithLimit, plain_page

if TYPE_CHECKING:
    import pyarrow as pa

FILE_NAME = "comparison.html"

MOST_ROWS = 1000
"""Most findings in the table."""

_TABLE = "steps.parquet"


def write_comparison(comparison: Comparison, before: Path, now: Path, folder: Path) -> None:
    """Writes the page into a folder.

    Args:
        before, now: the report folders, for their curves, or their findings.json, which have none.

    Raises:
        BadInput: a damaged table of steps. Unwritable: there is no way to write there.
    """
    curves = [curve for curve in (_curve("A", before), _curve("B", now)) if curve is not None]
    page = page_of(comparison, curves, (str(before), str(now)))
    write_file(folder / FILE_NAME, page.encode("utf-8"))


def page_of(comparison: Comparison, curves: list[ClearanceCurve], names: tuple[str, str]) -> str:
    """The whole page."""
    text = comparison_text(comparison)
    content = _curves(curves, names) + _findings(comparison)
    fail = max((row.finding.fail for row in comparison.rows), default=0.0)
    chart = CurvesWithLimit(curves, fail) if len(curves) == 2 else None
    return plain_page(f"{comparison.now}: compared", _header(comparison, text), content, chart)


def _header(comparison: Comparison, text: str) -> Markup:
    kicker = element("p", "Clearance comparison", class_="kicker")
    title = element("div", kicker, element("h1", comparison.now))
    badge = "nothing is new or worse" if comparison.passed else "new or worse"
    classes = f"verdict {'clear' if comparison.passed else 'violated'}"
    lines = [text, *doubt_lines(comparison)[:MOST_ROWS]]
    told = element(
        "ul", *(element("li", line[0].upper() + line[1:]) for line in lines), class_="beside"
    )
    return element("div", title, element("p", badge, class_=classes), class_="title") + told


def _curves(curves: list[ClearanceCurve], names: tuple[str, str]) -> Markup:
    key = [
        element("span", element("i"), f"{letter}: {name}", class_=letter.lower())
        for letter, name in zip("AB", names, strict=True)
    ]
    if len(curves) < 2:
        told = "Curves need two report folders, with their steps.parquet; findings.json has none."
        return section(
            "Clearance over time", element("div", *key, class_="key"), element("p", told)
        )
    place = element("div", id="curves", class_="plot")
    return section("Clearance over time", place, element("div", *key, class_="key"))


def _findings(comparison: Comparison) -> Markup:
    if not comparison.rows:
        return section(
            "Findings", element("p", "Neither run has a finding that the other could have.")
        )
    heads = [f">{head}" if head.endswith("mm") else head for head in HEADS]
    heads = [head[:1] + head[1:2].upper() + head[2:] if head[0] == ">" else head.capitalize()
             for head in heads]  # fmt: skip
    rows = [_row(row) for row in comparison.rows[:MOST_ROWS]]
    more = len(comparison.rows) - len(rows)
    notes = [element("p", f"{more} more are not listed.", class_="faint")] if more else []
    return section("Findings", table(heads, rows, class_="findings"), *notes)


def _row(row: ComparedFinding) -> Markup:
    change, before, now, *rest = comparison_cells(row)
    cells = [element("td", element("strong", change) if row.alarms else change)]
    cells += [
        element("td", element("span", told, class_=f"tag {told.partition(',')[0]}") if told else "")
        for told in (before, now)
    ]
    classes = ["number", "number", None, None, None]
    cells += [element("td", text, class_=kind) for text, kind in zip(rest, classes, strict=True)]
    return element("tr", *cells, class_="faint" if row.change is FindingChange.GONE else None)


def _curve(name: str, place: Path) -> ClearanceCurve | None:
    """The curve of a report folder: the clearance of each step, or the bound where only that is known."""
    if not (place / _TABLE).is_file():
        return None
    import pyarrow as pa
    import pyarrow.parquet as parquet

    try:
        steps = parquet.read_table(place / _TABLE)
        return curve_of(name, steps)
    except (pa.ArrowException, KeyError, OSError, TypeError) as error:
        raise BadInput(
            f"no table of steps: {error!s:.100}", where=str(place / _TABLE), valid="a report folder"
        ) from None


def curve_of(name: str, steps: pa.Table) -> ClearanceCurve:
    """The curve of a table of steps: their clearances, or their bounds where only those are known."""
    known = {column: steps[column].to_numpy() for column in ("time", "clearance")}
    if "lower_bound" in steps.column_names:
        bound = steps["lower_bound"].to_numpy()
        known["clearance"] = np.where(np.isnan(known["clearance"]), bound, known["clearance"])
    return ClearanceCurve(
        name, known["time"].astype(np.float64), known["clearance"].astype(np.float64)
    )
