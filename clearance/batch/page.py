"""The page of a batch: all cases in one table that sorts and filters, in one file that needs no network.

Numbers go as columns, curves as one byte a number, and only the rows that are in view are drawn: 10,000 cases are
2 MB and open at once. Not for: its data (`page_data`), and the page of one case (`report.page`).
"""

from __future__ import annotations

from pathlib import Path

from clearance.batch.answer import BASES, BatchAnswer
from clearance.batch.page_data import page_data
from clearance.record.wording import count
from clearance.report.rendering import render


def page_of(answer: BatchAnswer, place: Path) -> str:
    """The whole page.

    Args:
        place: the store's folder; a case whose own page lies in it is linked.
    """
    return render(
        "batch.html",
        title=f"{place.name}: {_counted(answer)}",
        name=place.name,
        verdict=_counted(answer),
        worst=answer.status.split()[0],
        basis="; ".join([_basis(answer), *answer.stale]),
        data=page_data(answer, place),
    )


def unfinished_page(name: str, text: str) -> str:
    """The page of a batch that has no answer yet."""
    return render("batch_unfinished.html", title=f"{name}: not finished", name=name, text=text)


def _counted(answer: BatchAnswer) -> str:
    told = ", ".join(f"{n:,} {status}" for status, n in reversed(answer.counts.items()))
    return f"{count(answer.n_cases, 'case')}: {told or 'none'}"


def _basis(answer: BatchAnswer) -> str:
    parts = [f"{n:,} {BASES[basis]}" for basis, n in answer.bases.items()] or ["nothing measured"]
    for n, what in ((answer.n_waived, "with waivers"), (answer.n_warned, "with warnings")):
        if n:
            parts.append(f"{n:,} {what}")
    return ", ".join(parts)
