"""Runs a batch for the command line: engine, progress, answer, exit code. Not for: its options (`batch`).

Progress is one line that is drawn again in a terminal; on a pipe a line now and then.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clearance.batch.answer import answer_of, reach_of
from clearance.batch.engine import Engine, LocalEngine
from clearance.batch.item import Item
from clearance.batch.listed import write_list
from clearance.batch.measuring import Fault, ItemResult
from clearance.batch.outcome import Outcome
from clearance.batch.output import UNFINISHED, withdraw_answer, write_answer
from clearance.batch.run import Opener, Watch, run_batch, shard_of
from clearance.batch.store import Store, merge, open_store
from clearance.batch.workers import local_workers
from clearance.cli import ExitCode
from clearance.cli.batch_verdict import print_answer
from clearance.errors import shown
from clearance.progress import doing
from clearance.record.wording import count, depth_mm, near_mm
from clearance.simulate.measure.parts import usable_cores
from clearance.world.waiver import Waiver

if TYPE_CHECKING:
    from rich.progress import Progress


MOST_LISTED = 50
"""Failures that are told as they come; the answer lists the worst, and the page has all."""

FEW = 32
"""Cases that one process has measured before others are ready to help."""


@dataclass(frozen=True)
class BatchRequest:
    """What the command line says beside the cases."""

    jobs: int | None
    scheduler: str | None
    shard: tuple[int, int] | None
    fresh: bool
    rehash: bool
    strict: bool
    quiet: bool
    waivers: tuple[Waiver, ...] = ()
    baseline: Path | None = None


def run_asked(items: Sequence[Item], place: Path, asked: BatchRequest) -> int:
    """Measures, writes the answer and prints it; the exit code.

    Raises:
        Incomplete: some cases are not measured, and why; the others are kept.
    """
    notify = _silent if asked.quiet else say
    with open_store(place, shard=asked.shard) as store, store.locked(notify):
        n_cases = f"of {count(len(items), 'case')} some are"
        withdraw_answer(store.place, UNFINISHED.format(n_cases))
        if asked.shard is None:
            merge(store, (), notify)
        write_list(store, items)
        own = items if asked.shard is None else shard_of(items, asked.shard)
        outcome = Outcome(own, waivers=asked.waivers, whole=asked.shard is None)
        try:
            return _run(items, store, outcome, asked, notify)
        except KeyboardInterrupt:
            say(f"interrupted: {len(outcome.keys):,} of {len(own):,} cases are kept")
            return ExitCode.INTERRUPTED


def _run(
    items: Sequence[Item],
    store: Store,
    outcome: Outcome,
    asked: BatchRequest,
    notify: Callable[[str], None],
) -> int:
    with shown_progress(asked.quiet, lambda number: items[number].name) as watch:
        opened = _opener(asked)
        run_batch(outcome, store, opened, watch, fresh=asked.fresh, rehash=asked.rehash)
    if store.n_damaged:
        notify(f"damaged rows of {count(store.n_damaged, 'case')} are measured again")
    answer = answer_of(outcome, store, strict=asked.strict)
    if asked.shard is None:
        write_answer(answer, store)
    if not asked.quiet:
        print_answer(answer, store, outcome.n_cached, asked.shard)
        if asked.baseline is not None:
            _print_since(asked.baseline, store)
    return answer.exit_code


def _print_since(baseline: Path, store: Store) -> None:
    from clearance.batch.compared import compared_batches
    from clearance.report.comparison import print_batch_comparison

    print_batch_comparison(compared_batches(baseline, store.place))


def _opener(asked: BatchRequest) -> Opener:
    """Opens the engine that is asked for."""

    @contextmanager
    def opened(n_cases: int) -> Iterator[Engine]:
        if asked.scheduler is not None:
            from clearance.batch.dask_engine import cluster_at

            with cluster_at(asked.scheduler) as engine:
                yield engine
            return
        jobs = _jobs(asked.jobs, n_cases)
        if jobs == 1:
            yield LocalEngine()
            return
        with local_workers(jobs) as workers:
            yield workers

    return opened


def _jobs(asked: int | None, n_cases: int) -> int:
    """How many processes are of use."""
    if asked is not None:
        return min(asked, n_cases)
    return 1 if n_cases <= FEW else usable_cores()


def say(line: str) -> None:
    """Says something on stderr."""
    print(line, file=sys.stderr, flush=True)


def _silent(line: str) -> None:
    """Says nothing."""


class SilentWatch:
    """Nobody watches."""

    def begin(self, items: Sequence[object], n_cached: int) -> None:
        """Tells nothing."""

    def note(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Tells nothing."""


@contextmanager
def shown_progress(quiet: bool, name: Callable[[int], str]) -> Iterator[Watch]:
    """Who is told how far a batch is: a terminal, a pipe, or nobody.

    Args:
        name: of a case by its number.
    """
    if quiet:
        yield SilentWatch()
        return
    if not sys.stderr.isatty():
        lines = PipeWatch(name)
        with doing(lambda: lines.line):
            yield lines
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
    bars = Progress(*columns, console=Console(stderr=True), transient=True)
    with bars as bar, doing(lambda: ""):
        yield TerminalWatch(bar, name)


class _Worst:
    """The worst case so far: of those in contact the deepest.

    Args:
        name: of a case by its number.
    """

    def __init__(self, name: Callable[[int], str]) -> None:
        self._name = name
        self._least: ItemResult | None = None

    def take(self, measured: Sequence[ItemResult]) -> None:
        """Takes some cases into account."""
        before = () if self._least is None else (self._least,)
        self._least = min((*before, *measured), key=_standing, default=None)

    def __str__(self) -> str:
        one = self._least
        if one is None or one.row["clearance"] is None:
            return ""
        near = _length(one.row).removeprefix(one.row["status"])  # which may be "contact"
        return f"worst {one.row['status']} {near}".rstrip() + f", {shown(self._name(one.number))}"


class PipeWatch:
    """Counts, and says in one line how far it is."""

    def __init__(self, name: Callable[[int], str]) -> None:
        self._worst = _Worst(name)
        self._n, self._done, self._n_failing = 0, 0, 0
        self._begun = time.monotonic()

    def begin(self, items: Sequence[object], n_cached: int) -> None:
        """Begins to count what is to be measured."""
        self._n, self._begun = len(items), time.monotonic()

    def note(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Counts."""
        self._done += len(measured) + len(faults)
        self._n_failing += sum(bool(one.row["exit_code"]) for one in measured) + len(faults)
        self._worst.take(measured)

    @property
    def line(self) -> str:
        """How far it is."""
        if not self._done:
            return f"0 of {self._n:,} cases measured"
        rate = self._done / max(time.monotonic() - self._begun, 1e-9)
        pace = f"{rate:,.1f} cases/s, {(self._n - self._done) / rate:,.0f} s left"
        parts = (pace, f"{self._n_failing:,} failed", str(self._worst))
        state = ", ".join(part for part in parts if part)
        return f"{self._done:,} of {self._n:,} cases measured, {state}"


class TerminalWatch:
    """Draws one line, and prints failures above it."""

    def __init__(self, bar: Progress, name: Callable[[int], str]) -> None:
        self._bar = bar
        self._task = bar.add_task("", total=None, rate="", worst="")
        self._name, self._worst = name, _Worst(name)
        self._n_listed = 0

    def begin(self, items: Sequence, n_cached: int) -> None:
        """Begins to count what is to be measured."""
        self._bar.update(self._task, total=len(items))

    def note(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Counts, and prints what fails."""
        for fault in faults:
            self._print(f"error     {self._name(fault.number)}: {fault.text}")
        for one in measured:
            if one.row["exit_code"]:
                why = (one.row["reasons"] or [""])[0]
                self._print(f"{one.row['status']:<9} {self._name(one.number)}: {why}")
        self._worst.take(measured)
        self._bar.update(self._task, advance=len(measured) + len(faults))
        speed = self._bar.tasks[0].speed
        rate = f"{speed:,.0f} cases/s" if speed else ""
        self._bar.update(self._task, rate=rate, worst=str(self._worst))

    def _print(self, line: str) -> None:
        self._n_listed += 1
        if self._n_listed <= MOST_LISTED:
            self._bar.console.print(shown(line), markup=False, highlight=False, soft_wrap=True)
        elif self._n_listed == MOST_LISTED + 1:
            self._bar.console.print("further failures are listed at the end", markup=False)


def _standing(one: ItemResult) -> tuple[int, float]:
    reach = reach_of(one.row["clearance"], one.row["penetration"])
    return -one.row["exit_code"], float("inf") if reach is None else reach


def _length(row: dict[str, Any]) -> str:
    """The clearance of a case, or how deep its contact is, as far as that is known."""
    depth = row["penetration"]
    if depth is not None:
        return f"{depth_mm(depth)} mm deep"
    return near_mm(row["clearance"], row["measured"], " mm")
