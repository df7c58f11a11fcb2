"""Runs a batch for the command line: engine, progress, answer, exit code. Not for: its options (`batch`).

Progress is one line that is drawn again in a terminal; on a pipe a line now and then.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import click

from clearance.batch.answer import answer_of
from clearance.batch.engine import Engine, LocalEngine
from clearance.batch.item import Item
from clearance.batch.listed import write_list
from clearance.batch.outcome import Outcome
from clearance.batch.output import UNFINISHED, withdraw_answer, write_answer
from clearance.batch.run import BatchWatch, Opener, run_batch, shard_of
from clearance.batch.store import Store, merge, open_store
from clearance.batch.workers import local_workers
from clearance.cli import ExitCode
from clearance.cli.batch_verdict import print_answer
from clearance.progress import doing
from clearance.record.wording import count
from clearance.simulate.measure.resources import usable_cores
from clearance.world.rules import Waiver

say = partial(click.echo, err=True)
"""Says a line on stderr."""

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
    notify = (lambda line: None) if asked.quiet else say
    with open_store(place, shard=asked.shard) as store, store.locked(notify):
        n_cases = f"of {count(len(items), 'case')} some are"
        withdraw_answer(store.place, UNFINISHED.format(n_cases))
        if asked.shard is None:
            merge(store, (), notify)
        write_list(store, items)
        own = items if asked.shard is None else shard_of(items, asked.shard)
        outcome = Outcome(own, waivers=asked.waivers, whole=asked.shard is None)
        try:
            return _run(store, outcome, asked, notify)
        except KeyboardInterrupt:
            say(f"interrupted: {len(outcome.keys):,} of {len(own):,} cases are kept")
            return ExitCode.INTERRUPTED


def _run(store: Store, outcome: Outcome, asked: BatchRequest, notify: Callable[[str], None]) -> int:
    with shown_progress(asked.quiet) as watch:
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


@contextmanager
def shown_progress(quiet: bool) -> Iterator[BatchWatch]:
    """A watch that tells how far a batch is: a terminal, a pipe, or nobody."""
    if quiet:
        yield BatchWatch()
        return
    if not sys.stderr.isatty():
        watch = BatchWatch()
        with doing(lambda: watch.line):
            yield watch
        return
    from rich.console import Console

    with Console(stderr=True).status("") as status, doing(lambda: ""):
        yield BatchWatch(status)
