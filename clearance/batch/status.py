"""How far the last batch of a store is: what of it is done, missing or failed. Not for: the answer (`answer`)."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.batch.answer import BatchAnswer, answer_of
from clearance.batch.file_hashes import FileHashes
from clearance.batch.listed import read_list
from clearance.batch.plan import planned
from clearance.batch.run import Outcome
from clearance.batch.store import Store


@dataclass(frozen=True, eq=False)
class BatchStatus:
    """What the store has of its last batch, as its files are now.

    Attributes:
        n_cases: of the batch. n_rows: all that the store keeps, of other batches and versions too.
        answered: those that are done.
    """

    n_cases: int
    n_rows: int
    answered: BatchAnswer

    @property
    def n_missing(self) -> int:
        """Cases that are to be measured, for the first time or since a file is another; bad input is among
        them."""
        return self.n_cases - self.answered.cases.num_rows


def status_of(store: Store) -> BatchStatus:
    """The status of the last batch.

    Raises:
        MissingFile: there was none.
    """
    items = read_list(store.place)
    plan = planned(items, store, FileHashes(store.hashes()))
    answered = answer_of(Outcome(items, plan.keys), store)
    return BatchStatus(len(items), len(store), answered)
