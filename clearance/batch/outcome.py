"""What has become of the cases of a batch so far: the row of each that has one, the faults of others.

Not for: measuring them (`run`), and what is written of them (`answer`).
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

from clearance.batch.cases import SomeOrAll
from clearance.batch.digest_table import NONE
from clearance.batch.measuring import Fault
from clearance.world.waiver import Waiver


@dataclass(eq=False)
class Outcome:
    """What has become of the cases of a batch so far.

    Attributes:
        items: in order. faults: of those that cannot have a row, by number.
        n_known: how many have a row. n_cached: of these, how many the store had. waivers: that the cases share.
        whole: False for a part of a batch.
    """

    items: SomeOrAll
    faults: dict[int, Fault] = field(default_factory=dict)
    n_known: int = 0
    n_cached: int = 0
    waivers: tuple[Waiver, ...] = ()
    whole: bool = True
    _rows: array[int] = field(default_factory=lambda: array("i"))

    def note(self, number: int, row: int) -> None:
        """Notes the row that a case has in the store, by the numbers of both."""
        if number >= len(self._rows):
            self._rows.extend([NONE] * (number + 1 - len(self._rows)))
        self.n_known += self._rows[number] == NONE
        self._rows[number] = row

    def row(self, number: int) -> int:
        """The row of a case; `NONE` where it has none."""
        return self._rows[number] if number < len(self._rows) else NONE

    def is_tried(self, number: int) -> bool:
        """True if a case has a row or a fault."""
        return self.row(number) != NONE or number in self.faults

    @property
    def tried(self) -> SomeOrAll:
        """The cases that have a row or a fault."""
        if self.n_known == len(self.items):
            return self.items
        numbers = enumerate(self.items.numbers)
        return self.items.among(i for i, one in numbers if self.is_tried(one))

    @property
    def is_answered(self) -> bool:
        """True if it is whole and each case has a row."""
        return self.whole and self.n_known == len(self.items)
