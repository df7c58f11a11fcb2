"""Damage to binary files where it counts: numbers that look like counts, lengths and offsets, and headers of text.

Not for: bytes anywhere (`anywhere.damaged`), nor text (`lines`).
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable
from random import Random

from tests.formats.damaged.lines import lines_damaged
from tests.formats.damaged.trees import json_damaged

Damage = Callable[[bytes, Random], bytes]


def counts_damaged(valid: bytes, random: Random) -> bytes:
    """A file of which one to three whole numbers are others, for the most part such as may be counts."""
    data = bytearray(valid)
    for _ in range(random.randint(1, 3)):
        size = random.choice((1, 2, 4, 4, 4, 8))
        places = _counts(data, size) if random.random() < 0.7 else []
        if len(data) >= size:
            at = random.choice(places) if places else random.randrange(len(data) - size + 1)
            data[at : at + size] = _another(data[at : at + size], len(data), random)
    return bytes(data)


def _counts(data: bytearray, size: int) -> list[int]:
    """Where a whole number is that may count, measure or point into the file."""
    if size == 1:
        return [i for i in range(len(data)) if 0 < data[i] < 32]
    found = []
    for at in range(len(data) - size + 1):
        if data[at + size // 2 : at + size] == bytes(size - size // 2):
            if 0 < int.from_bytes(data[at : at + size], "little") <= len(data):
                found.append(at)
    return found


def _another(held: bytearray, n_bytes: int, random: Random) -> bytes:
    size, order = len(held), random.choice(("little", "little", "little", "big"))
    value, most = int.from_bytes(held, "little"), 256 ** len(held)
    chosen = random.choice(
        (0, 1, value + 1, value - 1, 2 * value, n_bytes, n_bytes - 1, most - 1, most // 2, most // 2 - 1,
         most // 16, random.randrange(most))
    )  # fmt: skip
    return (chosen % most).to_bytes(size, "little" if order == "little" else "big")


def parts_damaged(valid: bytes, random: Random) -> bytes:
    """A file of which pieces are left out, repeated or put elsewhere, or with other counts."""
    data = valid
    for _ in range(random.randint(1, 2)):
        data = random.choice((counts_damaged, counts_damaged, _piece_damaged))(data, random)
    return data


def _piece_damaged(data: bytes, random: Random) -> bytes:
    if not data:
        return data
    begin = random.randrange(len(data))
    end = min(len(data), begin + random.choice((1, 2, 4, 8, 12, 50, 500)))
    piece, to = data[begin:end], random.randrange(len(data))
    return random.choice(
        (data[:begin], data[:begin] + data[end:], data[:end] + piece + data[end:], data[:to] + piece + data[to:],
         data + piece, data + bytes(random.choice((1, 4, 100))))
    )  # fmt: skip


def after_header(end: bytes) -> Damage:
    """Damage to a file that begins with lines of text, up to one that begins with `end`, and goes on in bytes."""
    line = re.compile(rb"^" + re.escape(end) + rb"[^\n]*\n", re.MULTILINE)

    def damaged(valid: bytes, random: Random) -> bytes:
        found = line.search(valid)
        begin = found.end() if found else len(valid)
        header, body = valid[:begin], valid[begin:]
        if random.random() < 0.6:
            header = lines_damaged(header, random)
        return header + (parts_damaged(body, random) if random.random() < 0.6 else body)

    return damaged


def glb_damaged(valid: bytes, random: Random) -> bytes:
    """A GLB of which the document, the counts or both are others; the lengths are right for the most part."""
    length = struct.unpack_from("<I", valid, 12)[0]
    text, rest = valid[20 : 20 + length], valid[20 + length :]
    json.loads(text)
    if random.random() < 0.8:
        text = json_damaged(text, random)
        text += b" " * (-len(text) % 4)
    if random.random() < 0.3:
        rest = parts_damaged(rest, random)
    whole = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    made = whole + text + rest
    return counts_damaged(made, random) if random.random() < 0.15 else made
