"""Layouts of what kernels take and give are a C compiler's: `ctypes` lays out the same structures."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.compile.declared import (
    ArrayOf,
    Floats,
    Floats3,
    Integers2,
    LentTo,
    fields_of,
    format_of,
    holds_arrays,
    is_lent,
    layout_of,
    lent_kind,
    row_of,
)
from tests.examples import examples


class Point(NamedTuple):
    x: float
    is_real: bool


class Cloud(NamedTuple):
    is_open: bool
    points: Floats
    n: int
    first: Point


class Owner(NamedTuple):
    is_ours: bool
    cloud: Annotated[Cloud, LentTo]


NUMBERS = {int: ctypes.c_int64, float: ctypes.c_double, bool: ctypes.c_bool}


def structure_of(kind: Any) -> Any:
    """What a C compiler makes of a value of this kind."""
    if kind in NUMBERS:
        return NUMBERS[kind]
    if lent_kind(kind) is not None:
        return ctypes.c_void_p
    fields = fields_of(kind)
    if fields is not None:
        return structure_with(map(structure_of, fields))
    n_axes = next(each.n_axes for each in kind.__metadata__ if isinstance(each, ArrayOf))
    word = ctypes.c_int64
    head = [ctypes.c_void_p, ctypes.c_void_p, word, word, ctypes.c_void_p]
    return structure_with([*head, *[word] * (2 * n_axes)])


def structure_with(items: Any) -> type[ctypes.Structure]:
    named = [(f"item{i}", item) for i, item in enumerate(items)]
    return type("Made", (ctypes.Structure,), {"_fields_": named})


def offsets(structure: Any, at: int = 0) -> Iterator[int]:
    """Where each number of it lies."""
    if not isinstance(structure, type) or not issubclass(structure, ctypes.Structure):
        yield at
        return
    for name, item in structure._fields_:
        yield from offsets(item, at + getattr(structure, name).offset)


kinds = st.recursive(
    st.sampled_from([int, float, bool, Floats, Floats3, Integers2, Point, Cloud, Owner]),
    lambda inner: st.lists(inner, min_size=1, max_size=4).map(lambda items: tuple[tuple(items)]),
    max_leaves=8,
)


@examples(200)
@given(kinds)
def test_values_lie_where_c_puts_them(kind):
    layout, structure = layout_of(kind), structure_of(kind)
    assert layout.size == ctypes.sizeof(structure)
    assert layout.alignment == ctypes.alignment(structure)
    assert [offset for offset, _ in layout.leaves] == list(offsets(structure))
    assert struct.calcsize(format_of(layout)) == layout.size


@examples(100)
@given(st.lists(kinds, max_size=4))
def test_arguments_lie_like_the_members_of_a_structure(row):
    layout = row_of([layout_of(kind) for kind in row])
    structure = structure_with(map(structure_of, row))
    assert layout.size == ctypes.sizeof(structure)
    assert [offset for offset, _ in layout.leaves] == list(offsets(structure))


def test_a_bool_before_a_number_is_followed_by_padding():
    assert layout_of(tuple[bool, float, bool]).leaves == ((0, "?"), (8, "d"), (16, "?"))
    assert layout_of(tuple[bool, float, bool]).size == 24


def test_named_tuples_with_arrays_go_by_their_address():
    assert [is_lent(kind) for kind in (Cloud, Point, tuple[Floats, int], Floats)] == [
        True, False, False, False,
    ]  # fmt: skip
    assert holds_arrays(tuple[int, tuple[Floats, int]]) and not holds_arrays(Owner)


@pytest.mark.parametrize("kind", [np.ndarray, str, list[int], None, tuple[int, np.ndarray]])
def test_an_annotation_that_says_too_little_is_refused(kind):
    with pytest.raises(TypeError, match="no array, number or tuple"):
        layout_of(kind)
