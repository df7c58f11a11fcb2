"""How far a batch is, in a terminal: cases done, rate and time left, the worst so far, failures as they come.

Silent where stderr is no terminal: then only the answer is printed. Not for: the answer (`batch_verdict`).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from clearance.batch.measuring import Fault, ItemResult
from clearance.batch.run import Watch
from clearance.errors import shown
from clearance.record.wording import mm

if TYPE_CHECKING:
    from rich.progress import Progress

MOST_TOLD = 50
"""Failures that are told as they come; the answer lists the worst, and the page has all."""


class SilentWatch:
    """Nobody watches."""

    def begin(self, items: Sequence[object], n_cached: int) -> None:
        """Tells nothing."""

    def tell(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Tells nothing."""


@contextmanager
def shown_progress(quiet: bool, name: Callable[[int], str]) -> Iterator[Watch]:
    """Who is told how far a batch is: a line in the terminal, or nobody.

    Args:
        name: of a case by its number.
    """
    if quiet or not sys.stderr.isatty():
        yield SilentWatch()
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[worst]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield TerminalWatch(bar, name)


class TerminalWatch:
    """Draws one line, and prints failures above it."""

    def __init__(self, bar: Progress, name: Callable[[int], str]) -> None:
        self._bar = bar
        self._task = bar.add_task("", total=None, rate="", worst="")
        self._name = name
        self._least: ItemResult | None = None
        self._n_told = 0

    def begin(self, items: Sequence, n_cached: int) -> None:
        """Begins to count what is to be measured."""
        self._bar.update(self._task, total=len(items))

    def tell(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Counts, and prints what fails."""
        for fault in faults:
            self._print(f"error     {self._name(fault.number)}: {fault.text}")
        for one in measured:
            if one.exit_code:
                self._print(f"{one.status:<9} {self._name(one.number)}: {one.reason}")
            self._take(one)
        self._bar.update(self._task, advance=len(measured) + len(faults))
        speed = self._bar.tasks[0].speed
        rate = f"{speed:,.0f} cases/s" if speed else ""
        self._bar.update(self._task, rate=rate, worst=self._worst())

    def _take(self, one: ItemResult) -> None:
        least = self._least
        if least is None or _standing(one) < _standing(least):
            self._least = one

    def _worst(self) -> str:
        one = self._least
        if one is None or one.clearance is None:
            return ""
        return f"worst {one.status} {mm(one.clearance)} mm, {shown(self._name(one.number))}"

    def _print(self, line: str) -> None:
        self._n_told += 1
        if self._n_told <= MOST_TOLD:
            self._bar.console.print(shown(line), markup=False, highlight=False, soft_wrap=True)
        elif self._n_told == MOST_TOLD + 1:
            self._bar.console.print("further failures are told at the end", markup=False)


def _standing(one: ItemResult) -> tuple[int, float]:
    return -one.exit_code, float("inf") if one.clearance is None else one.clearance
