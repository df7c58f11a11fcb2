"""Damage to the structure of documents of YAML and JSON: values, keys and parts exchanged, and still a document.

Bytes that are damaged anywhere end in the parser for the most part; what comes through here is asked of the
reader itself. Not for: elements of XML (`markup`), nor bytes (`bytes`).
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from random import Random
from typing import Any

from ruamel.yaml import YAML


class Bare(str):
    """Text that is written as it is, without quotes."""


ODD: tuple[Any, ...] = (
    None, True, "", " ", "x", "nan", "1e400", "٣", "a\nb", "../..", "*", "x" * 3000, 0, -1, -0.0, 0.5, -2.5,
    float("nan"), float("inf"), float("-inf"), 1e308, -1e308, 1e160, 1e-320, 1e18, 2**31, 2**63, -(2**64), 10**40,
    [], {}, [[]], [None], [0] * 300, {"x": {}}, {"": 1},
)  # fmt: skip
"""What may stand where anything else does."""

YAML_ONLY = tuple(
    map(
        Bare,
        ("1_0", "0x1F", "0o17", "2020-01-01", "2020-01-01T00:00:00Z", "!!set {a}", "!!binary aGk=", "!!bool maybe",
         "!!int ''", "!!omap [a: 1]", "&b [*b]", "*nowhere", "1e400", ".5", "1" * 5000, "-1e-400", "!x y", "no",
         "&c [&d [1, 1], *d, *d]", "{[1]: 2}", "{<<: {x: 1}}", "!degrees 90", "12:30:45", "|\n  text\n"),
    )
)  # fmt: skip
JSON_ONLY = tuple(
    map(
        Bare,
        ("1e400", "-", "01", "1" * 5000, "[" * 200 + "]" * 200, '"\\ud800"', "NaN", "-0", "'a'"),
    )
)

Slot = tuple[Any, Any]
"""A list or mapping, and the index or key of a value in it."""


def yaml_damaged(valid: bytes, random: Random) -> bytes:
    """A YAML file of which values, keys or parts are exchanged, in all its documents."""
    damaged = tree_damaged(_documents(valid), random, ODD + YAML_ONLY)
    return "---\n".join(_block(one) for one in damaged).encode()


@cache
def _documents(valid: bytes) -> list[Any]:
    """What a file of YAML holds; aliases are values of their own."""
    read = YAML(typ="safe", pure=True).load_all(valid.decode())
    return json.loads(json.dumps([one for one in read if one is not None], default=str))


def json_damaged(valid: bytes, random: Random) -> bytes:
    """The same for a JSON file."""
    [damaged] = tree_damaged([json.loads(valid)], random, ODD + JSON_ONLY) or [None]
    return _flow(damaged).encode()


def tree_damaged(documents: list[Any], random: Random, odd: tuple[Any, ...]) -> list[Any]:
    """The documents with one to three kinds of damage."""
    held = copy.deepcopy(documents)
    for _ in range(random.randint(1, 3)):
        slots = list(_slots(held))
        if slots:
            random.choice(_DAMAGES)(slots, random, odd)
    return held[: len(documents)] if len(documents) == 1 else held


def _slots(held: Any) -> list[Slot]:
    """Every value in lists and mappings, down to twenty levels."""
    found: list[Slot] = []
    level = [held]
    for _ in range(20):
        inner = []
        for one in level:
            keys = range(len(one)) if isinstance(one, list) else list(one)
            found += [(one, key) for key in keys]
            inner += [one[key] for key in keys if isinstance(one[key], list | dict)]
        level = inner
    return found[:2000]


def _replace(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    held, key = random.choice(slots)
    held[key] = copy.deepcopy(random.choice(odd))


def _change_number(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    numbers = [(held, key) for held, key in slots if isinstance(held[key], int | float)]
    held, key = random.choice(numbers or slots)
    value = held[key] if isinstance(held[key], int | float) else 0
    factors = (-value, value + 1, value - 1, value / 1000, value * 1000.0, value * 1e6)
    changed = (*factors, str(value), [value])
    held[key] = random.choice(changed)


def _drop(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    held, key = random.choice(slots)
    del held[key]


def _rename(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    keyed = [(held, key) for held, key in slots if isinstance(held, dict)]
    if not keyed:
        return _replace(slots, random, odd)
    held, key = random.choice(keyed)
    others = sorted({str(other) for _, other in keyed}) + ["", "x", f"{key}s", "nan", "a/b", "٣"]
    held[random.choice(others)] = held.pop(key)


def _repeat(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    held, key = random.choice(slots)
    times = random.choice((2, 2, 3, 40))
    if isinstance(held, list):
        held[key:key] = [copy.deepcopy(held[key]) for _ in range(times - 1)]
    else:
        held[key] = [copy.deepcopy(held[key]) for _ in range(times)]


def _nest(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    held, key = random.choice(slots)
    name = key if isinstance(key, str) else "x"
    for _ in range(random.choice((1, 1, 2, 60))):
        held[key] = random.choice(([held[key]], {name: held[key]}))


def _graft(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    (held, key), (other, name) = random.choice(slots), random.choice(slots)
    held[key] = copy.deepcopy(other[name])


def _swap(slots: list[Slot], random: Random, odd: tuple[Any, ...]) -> None:
    (held, key), (other, name) = random.choice(slots), random.choice(slots)
    held[key], other[name] = copy.deepcopy(other[name]), copy.deepcopy(held[key])


_DAMAGES: tuple[Callable[[list[Slot], Random, tuple[Any, ...]], None], ...] = (
    _replace, _replace, _replace, _change_number, _change_number, _drop, _rename, _repeat, _nest, _graft, _swap,
)  # fmt: skip


def _block(document: Any) -> str:
    """A document, its outermost mapping or list with a line for each entry."""
    if isinstance(document, dict) and document:
        return "".join(f"{_key(key)}: {_flow(value)}\n" for key, value in document.items())
    if isinstance(document, list) and document:
        return "".join(f"- {_flow(value)}\n" for value in document)
    return f"{_flow(document)}\n"


def _key(key: object) -> str:
    text = str(key)
    return text if text.isidentifier() and text.isascii() else json.dumps(text)


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{json.dumps(str(key))}: {_flow(one)}' for key, one in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_flow, value))}]"
    if isinstance(value, Bare):
        return value
    if isinstance(value, float) and value - value != 0.0:
        return {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}[repr(value)]
    return json.dumps(value)
