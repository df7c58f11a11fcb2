"""Runs a batch for the command line: engine, progress, answer, exit code. Not for: its options (`batch`)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from clearance.batch.answer import answer_of
from clearance.batch.cases import Cases
from clearance.batch.engine import Engine, LocalEngine
from clearance.batch.faults import keep_faults
from clearance.batch.listed import write_list
from clearance.batch.outcome import Outcome
from clearance.batch.output import withdraw_answer, write_answer
from clearance.batch.run import Opener, run_batch, shard_of
from clearance.batch.store import Store
from clearance.cli import ExitCode
from clearance.cli.batch_progress import shown_progress
from clearance.cli.batch_verdict import print_answer
from clearance.errors import Unwritable
from clearance.extras import LIBRARIES, is_installed
from clearance.simulate.measure.parts import usable_cores
from clearance.world.waiver import Waiver

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


def run_asked(items: Cases, store: Store, asked: BatchRequest) -> int:
    """Measures, writes the answer and prints it; the exit code.

    Raises:
        Incomplete: some cases are not measured, and why; the others are kept.
    """
    say = _silent if asked.quiet else _say
    if store.n_damaged:
        say(f"damaged rows of {store.n_damaged} segments are dropped, and measured again")
    with store.locked():
        write_list(store.place, items)
    withdraw_answer(store, len(items))
    own = items if asked.shard is None else shard_of(items, asked.shard)
    outcome = Outcome(own, waivers=asked.waivers, whole=asked.shard is None)
    try:
        try:
            with shown_progress(asked.quiet, items.name) as watch:
                opened, fresh = _opener(asked, say), asked.fresh
                run_batch(outcome, store, opened, watch, fresh=fresh, rehash=asked.rehash)
        finally:
            _keep_faults(store, outcome)
        answer = answer_of(outcome, store, strict=asked.strict)
        if asked.shard is None:
            answer = write_answer(answer, store)
    except KeyboardInterrupt:
        _say(f"interrupted: {outcome.n_known:,} of {len(own):,} cases are kept")
        return ExitCode.INTERRUPTED
    if not asked.quiet:
        print_answer(answer, store, outcome.n_cached, asked.shard)
        if asked.baseline is not None:
            _print_since(asked.baseline, store)
    return answer.exit_code


def _print_since(baseline: Path, store: Store) -> None:
    from clearance.batch.compared import compared_batches
    from clearance.cli.batch_comparison import print_batch_comparison

    print_batch_comparison(compared_batches(baseline, store.place))


def _keep_faults(store: Store, outcome: Outcome) -> None:
    """Keeps which cases could not be answered, for `status`; of those that were not tried nothing changes."""
    with suppress(Unwritable), store.locked():  # where there is no room, they count as missing
        keep_faults(store.place, outcome.tried, outcome.faults)


def _opener(asked: BatchRequest, say: Callable[[str], None]) -> Opener:
    """Opens the engine that is asked for."""

    @contextmanager
    def opened(n_cases: int) -> Iterator[Engine]:
        if asked.scheduler is not None:
            from clearance.batch.dask_engine import cluster_at

            with cluster_at(asked.scheduler) as engine:
                yield engine
            return
        jobs = _jobs(asked.jobs, n_cases, say)
        if jobs == 1:
            yield LocalEngine()
            return
        from clearance.batch.dask_engine import local_cluster

        with local_cluster(jobs) as engine:
            yield engine

    return opened


def _jobs(asked: int | None, n_cases: int, say: Callable[[str], None]) -> int:
    """How many processes are of use."""
    if asked is not None:
        return min(asked, n_cases)
    if n_cases <= FEW or usable_cores() == 1:
        return 1
    if not all(map(is_installed, LIBRARIES["batch"])):
        say("one process measures; pip install 'clearance[batch]' brings more")
        return 1
    return usable_cores()


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _silent(line: str) -> None:
    """Says nothing."""
