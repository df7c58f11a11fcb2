"""The pairs in contact at the steps of a run, worked out when they are looked at. Not for: finding them
(`contacts`).
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.simulate.contact.rows_on_demand import RowsOnDemand

if TYPE_CHECKING:
    from clearance.query.contact import Contact


@dataclass(frozen=True, eq=False)
class StepContact:
    """One pair that overlaps at one step; `link` and `obstacle` are its two bodies, whatever they are.

    Attributes:
        known: the overlap in the world frame, `link` its body a; without its region if there is `again`; None
            where the run has not worked it out.
        again: finds all of it once more.
    """

    step: int
    time: float  # [s]
    link: str
    obstacle: str
    known: Contact | None
    again: Callable[[], Contact] | None = None

    @property
    def numbers(self) -> Contact:
        """The overlap, perhaps without its region; worked out now if it is not known."""
        return self.found if self.known is None else self.known

    @cached_property
    def found(self) -> Contact:
        """The overlap with its region."""
        if self.again is not None:
            return self.again()
        assert self.known is not None  # one of the two is always given
        return self.known


class ContactSequence(RowsOnDemand[StepContact]):
    """Every pair in contact at every step, steps first; what the run works out of them waits until it is asked."""

    @property
    @abstractmethod
    def steps(self) -> np.ndarray:
        """(k,) the step of each, not decreasing."""

    def __len__(self) -> int:
        return len(self.steps)

    @property
    @abstractmethod
    def are_asked(self) -> bool:
        """True if the run asks for the depth of any; no more is worked out to say so."""

    @abstractmethod
    def work_out(self, progress: Callable[[int, int], None] | None = None) -> None:
        """Works out what the run asks for, once; `progress` is called with how many of how many."""

    @property
    @abstractmethod
    def worked_out(self) -> Sequence[StepContact]:
        """The rows that the run works out, steps first."""

    @property
    @abstractmethod
    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies in contact, where it is not they themselves; one line each."""
