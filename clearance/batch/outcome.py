"""What has become of the cases of a batch so far: the key of each that has a row, the faults of others.

Not for: measuring them (`run`), and what is written of them (`answer`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from clearance.batch.item import Item
from clearance.batch.measuring import Fault
from clearance.world.rules import Waiver


@dataclass(eq=False)
class Outcome:
    """What has become of the cases of a batch so far.

    Attributes:
        items: in order. keys: of those that have a row, by number. faults: of those that cannot have one.
        n_cached: how many rows the store had. waivers: that the cases share.
        whole: False for a part of a batch.
    """

    items: Sequence[Item]
    keys: dict[int, str] = field(default_factory=dict)
    faults: dict[int, Fault] = field(default_factory=dict)
    n_cached: int = 0
    waivers: tuple[Waiver, ...] = ()
    whole: bool = True

    @property
    def tried(self) -> list[Item]:
        """The cases that have a row or a fault."""
        return [
            item for item in self.items if item.number in self.keys or item.number in self.faults
        ]

    @property
    def is_answered(self) -> bool:
        """True if it is whole and each case has a row."""
        return self.whole and len(self.keys) == len(self.items)
