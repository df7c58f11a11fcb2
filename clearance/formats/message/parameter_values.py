"""Values of ROS parameter files, checked where they stand. Not for: which parameters there are."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from clearance.errors import BadInput, BadSyntax, UnknownKey, nearest_name
from clearance.formats.message.documents import Fields, described, yaml_documents

_WORDS = {"true": True, "false": False}


_FACTORS = {"!degrees": math.pi / 180.0, "!radians": 1.0}
"""Units that xacro knows as tags, and files of limits use."""


def parameters(data: bytes) -> Fields:
    """The one mapping in a file.

    Raises:
        BadSyntax: not YAML, or something else.
    """
    documents = yaml_documents(data, _FACTORS)
    if len(documents) != 1 or not isinstance(documents[0], Fields):
        what = described(documents[0]) if len(documents) == 1 else f"{len(documents)} documents"
        raise BadSyntax(f"{what} is given", valid="one mapping")
    return documents[0]


def number(given: Fields, key: str) -> float:
    """The finite number at a key, which is there.

    Raises:
        BadInput: something else.
    """
    value = given[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadInput(f"{described(value)} is given", where=key, valid="a finite number")
    return float(value)


def truth(given: Fields, key: str) -> bool:
    """Whether true stands at a key; not where the key is not there.

    Raises:
        BadInput: neither true nor false.
    """
    value = given.get(key, "false")
    word = value.lower() if isinstance(value, str) else ""
    if word not in _WORDS:
        raise BadInput(f"{described(value)} is given", where=key, valid="true or false")
    return _WORDS[word]


def mapping(value: Any) -> Fields:
    """A mapping.

    Raises:
        BadInput: something else.
    """
    if not isinstance(value, Fields):
        raise BadInput(f"{described(value)} is given", valid="a mapping")
    return value


def require_keys(given: Fields, known: Collection[str]) -> None:
    """Nothing, if all keys are known.

    Raises:
        UnknownKey: with the nearest one.
    """
    for key in given:
        if key not in known:
            raise UnknownKey(f"unknown key {key!r:.60}", valid=nearest_name(key, known))
