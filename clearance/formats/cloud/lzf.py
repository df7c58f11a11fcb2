"""LZF, the compression of PCD files: runs of bytes as they are, and copies of what came before.

Not for: the fields that are compressed (`pcd_file`). Source: M. Lehmann, LibLZF.
"""

from __future__ import annotations

from clearance.errors import BadSyntax

MOST_TIMES = 264
"""A copy of three bytes makes so many at most."""

_LITERALS = 32


def decompressed(data: bytes, n_bytes: int) -> bytes:
    """The `n_bytes` that `data` stands for.

    Raises:
        BadSyntax: it stands for another number of bytes, ends within a run, or copies what is not there.
    """
    if n_bytes > MOST_TIMES * len(data):
        raise _damaged("it is too short")
    made = bytearray()
    place, end = 0, len(data)
    while place < end:
        control = data[place]
        place += 1
        if control < _LITERALS:
            made += data[place : place + control + 1]
            place += control + 1
            if place > end:
                raise _damaged("it ends within a run")
        else:
            place = _copied(data, place, control, made)
        if len(made) > n_bytes:
            raise _damaged("it is longer than its header says")
    if len(made) != n_bytes:
        raise _damaged("it is cut off")
    return bytes(made)


def _copied(data: bytes, place: int, control: int, made: bytearray) -> int:
    """Adds a copy of what came before to `made`; the place in `data` after it."""
    length = control >> 5
    if length == 7 and place < len(data):
        length += data[place]
        place += 1
    if place >= len(data):
        raise _damaged("it ends within a copy")
    back = ((control & 31) << 8) + data[place] + 1
    length += 2
    if back > len(made):
        raise _damaged("it copies what is not there")
    part = bytes(made[len(made) - back : len(made) - back + length])
    made += (part * (length // len(part) + 1))[:length]  # a copy may run into itself
    return place + 1


def _damaged(why: str) -> BadSyntax:
    return BadSyntax(f"the compressed points cannot be read: {why}")
