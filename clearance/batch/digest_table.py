"""Digests and their numbers in little memory: a dict of them takes ten times as much.

Not for: what is known of each, which whoever holds the table keeps in columns of its own, by number.
"""

from __future__ import annotations

import hashlib
from array import array

NONE = -1
"""The number of a digest that is not there."""

TEXT_WIDTH = 16
"""Bytes of a text's digest: two texts of one digest are not to be expected in any batch."""

_FIRST_SLOTS = 64


def digest_of_text(text: str) -> bytes:
    """(TEXT_WIDTH,) A digest of a text that may be no valid Unicode, as names of files are."""
    return hashlib.blake2b(text.encode("utf-8", "surrogatepass"), digest_size=TEXT_WIDTH).digest()


class DigestTable:
    """Digests of one width, 8 bytes at least, numbered in the order in which they came.

    Open addressing with steps of one: a slot holds a number, and a digest's first bytes say where to look first.
    At most two thirds of all slots are taken, so a digest costs its width and 6 to 12 bytes.
    """

    def __init__(self, width: int) -> None:
        self._width = width
        self._digests = bytearray()
        self._slots = array("i", [NONE]) * _FIRST_SLOTS
        self._n = 0

    def __len__(self) -> int:
        return self._n

    def __getitem__(self, number: int) -> bytes:
        start = number * self._width
        return bytes(self._digests[start : start + self._width])

    @property
    def content(self) -> bytearray:
        """All digests, one after another."""
        return self._digests

    def find(self, digest: bytes) -> int:
        """The number of a digest; `NONE` where it is not there."""
        return self._slots[self._slot(digest)]

    def enter(self, digest: bytes) -> int:
        """The number of a digest, which is the next one where it is new."""
        slot = self._slot(digest)
        number = self._slots[slot]
        if number != NONE:
            return number
        number = self._slots[slot] = self._n
        self._digests += digest
        self._n += 1
        if 3 * self._n > 2 * len(self._slots):
            self._grow()
        return number

    def _slot(self, digest: bytes) -> int:
        """Where a digest is, or would be."""
        slots, width, digests = self._slots, self._width, self._digests
        beyond = len(slots) - 1
        slot = int.from_bytes(digest[:8], "little") & beyond
        while (number := slots[slot]) != NONE:
            if digests[number * width : (number + 1) * width] == digest:
                break
            slot = (slot + 1) & beyond
        return slot

    def _grow(self) -> None:
        slots = self._slots = array("i", [NONE]) * (2 * len(self._slots))
        beyond, digests = len(slots) - 1, self._digests
        for number in range(self._n):
            start = number * self._width
            slot = int.from_bytes(digests[start : start + 8], "little") & beyond
            while slots[slot] != NONE:
                slot = (slot + 1) & beyond
            slots[slot] = number
