"""How far the last batch of a store is: what of it is done, failed, unreadable or missing.

Not for: the answer (`answer`).
"""

from __future__ import annotations

from dataclasses import dataclass

from clearance.batch.answer import BatchAnswer, answer_of
from clearance.batch.file_hashes import FileHashes
from clearance.batch.listed import read_list
from clearance.batch.outcome import Outcome
from clearance.batch.plan import faults_as_before, planned
from clearance.batch.rows import ERROR
from clearance.batch.store import Store
from clearance.batch.store_files import CASES, parts_in


@dataclass(frozen=True, eq=False)
class BatchStatus:
    """What the store has of its last batch, as its files are now.

    Attributes:
        n_cases: of the batch. n_rows: all that the store keeps, of other batches and versions too.
        has_answer: whether page and tables of it are there. n_parts: files of parts that are not merged yet.
        answered: those that are done, and those that could not be read or answered when they were last tried.
    """

    n_cases: int
    n_rows: int
    has_answer: bool
    n_parts: int
    answered: BatchAnswer

    @property
    def n_missing(self) -> int:
        """Cases that are to be measured, for the first time or since a file is another."""
        return self.n_cases - self.answered.n_cases

    @property
    def n_unreadable(self) -> int:
        """Cases that could not be read or answered when they were last tried."""
        return self.answered.counts.get(ERROR, 0)

    @property
    def n_done(self) -> int:
        """Cases that have a row."""
        return self.answered.n_cases - self.n_unreadable


def status_of(store: Store) -> BatchStatus:
    """The status of the last batch.

    Raises:
        MissingFile: there was none.
    """
    items, hashes = read_list(store), FileHashes(store.known_hash)
    outcome = Outcome(items)
    todo = planned(outcome, store, hashes)
    outcome.faults.update(faults_as_before(store, todo, hashes))
    answered = answer_of(outcome, store)
    has_answer = (store.place / CASES).is_file()
    n_parts = len(parts_in(store.place))
    return BatchStatus(len(items), len(store), has_answer, n_parts, answered)
