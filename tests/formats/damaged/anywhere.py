"""Damage to any file, byte by byte: flipped, cut off, doubled, moved, numbers replaced."""

from __future__ import annotations

import re

import numpy as np

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:e-?\d+)?")

_VALUES = (
    b"0", b"-0", b"1", b"-1", b"2", b"255", b"65536", b"4294967295", b"-4294967298", b"99999999999999999999",
    b"1e18", b"1e308", b"1e400", b"1e-320", b"nan", b"inf", b"-inf", b"1_0", b"0x10", b"0,01", b"", b"\xd9\xa1",
    b"1" * 5000, b"true", b"[]", b"x", b"\x00", b"1e160", b"-1e18", b"0.1",
)  # fmt: skip


def damaged(valid: bytes, seed: int) -> bytes:
    """The file with one to three kinds of damage that the seed draws."""
    rng = np.random.default_rng(seed)
    data = bytearray(valid)
    for _ in range(rng.integers(1, 4)):
        if data:
            data = bytearray(_DAMAGES[rng.integers(len(_DAMAGES))](data, rng))
    return bytes(data)


def _span(data: bytearray, rng: np.random.Generator) -> tuple[int, int]:
    begin = int(rng.integers(len(data)))
    return begin, begin + int(rng.integers(1, max(2, min(200, len(data) - begin) + 1)))


def _flipped(data: bytearray, rng: np.random.Generator) -> bytes:
    for _ in range(rng.integers(1, 9)):
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
    return bytes(data)


def _overwritten(data: bytearray, rng: np.random.Generator) -> bytes:
    begin = int(rng.integers(len(data)))
    word = (
        b"\xff" * 4,
        b"\0" * 4,
        b"\xff\xff\xff\x7f",
        b"\0\0\0\x80",
        b"\0\0\xc0\x7f",
        b"\1\0\0\0",
    )
    data[begin : begin + 4] = word[rng.integers(len(word))]
    return bytes(data)


def _cut_off(data: bytearray, rng: np.random.Generator) -> bytes:
    return bytes(data[: rng.integers(len(data))])


def _without(data: bytearray, rng: np.random.Generator) -> bytes:
    begin, end = _span(data, rng)
    return bytes(data[:begin] + data[end:])


def _doubled(data: bytearray, rng: np.random.Generator) -> bytes:
    begin, end = _span(data, rng)
    return bytes(data[:end] + data[begin:end] * int(rng.integers(1, 20)) + data[end:])


def _moved(data: bytearray, rng: np.random.Generator) -> bytes:
    begin, end = _span(data, rng)
    to = int(rng.integers(len(data)))
    return bytes(data[:to] + data[begin:end] + data[to:])


def _renumbered(data: bytearray, rng: np.random.Generator) -> bytes:
    found = list(_NUMBER.finditer(bytes(data)))
    if not found:
        return bytes(data)
    at = found[rng.integers(len(found))]
    return bytes(data[: at.start()] + _VALUES[rng.integers(len(_VALUES))] + data[at.end() :])


def _swapped(data: bytearray, rng: np.random.Generator) -> bytes:
    lines = bytes(data).split(b"\n")
    i, j = rng.integers(len(lines), size=2)
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


_DAMAGES = (
    _flipped, _overwritten, _cut_off, _without, _doubled, _moved, _renumbered, _renumbered, _renumbered, _swapped,
)  # fmt: skip
