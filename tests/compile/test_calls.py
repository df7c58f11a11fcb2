"""What a kernel is given lies in memory as declared, and what it gives is read so; anything else is refused."""

from __future__ import annotations

import ctypes
import gc
import struct
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from clearance.compile.calls import KernelFault, Written
from clearance.compile.declared import Flags, Floats, Floats2, Integers, LentTo
from tests.compile.spoken import answered, take, words_of_array, write_words


class Point(NamedTuple):
    x: float
    is_real: bool


class Cloud(NamedTuple):
    points: Floats2
    n: int


class Owner(NamedTuple):
    first: Point
    cloud: Annotated[Cloud, LentTo]
    marks: Flags


class Found(NamedTuple):
    point: Point
    rows: Floats2
    n: int


def words_at(place: int, form: str) -> tuple:
    return struct.unpack(form, ctypes.string_at(place, struct.calcsize(form)))


def test_numbers_and_tuples_are_given_by_value():
    def declared(n: int, is_so: bool, points: tuple[Point, Point], x: float) -> None: ...

    seen = []
    with answered(
        declared, lambda given, _: seen.append(words_at(given, "=q?7xd?7xd?7xd")) or 0
    ) as kernel:
        assert kernel(-3, True, (Point(0.5, False), Point(1.5, True)), 2) is None
    assert seen == [(-3, True, 0.5, False, 1.5, True, 2.0)]


def test_an_array_is_written_where_it_lies():
    def declared(numbers: Integers) -> None: ...

    def answer(given: int, _: int) -> int:
        size, width, data, length, stride = words_at(given, "=16x5q")
        assert (size, width, length, stride) == (3, 8, 3, 8)
        write_words(data, [7, 8, 9])
        return 0

    numbers = np.zeros(3, np.int64)
    with answered(declared, answer) as kernel:
        kernel(numbers)
    assert numbers.tolist() == [7, 8, 9]


def test_a_named_tuple_with_arrays_is_given_by_its_address_and_so_is_what_it_lends():
    def declared(owner: Owner, scale: float) -> float: ...

    points = np.arange(6.0).reshape(3, 2)

    def answer(given: int, result: int) -> int:
        owner, scale = words_at(given, "=qd")
        x, is_real, cloud, n_marks = words_at(owner, "=d?7xq16xq")
        n_points, data, rows, columns, n = words_at(cloud, "=16xq8x3q16xq")
        last = words_at(data, "=6d")[-1]
        found = struct.pack(
            "=d", scale * (x + is_real + n_marks + n_points + rows + columns + n + last)
        )
        ctypes.memmove(result, found, 8)
        return 0

    owner = Owner(Point(0.5, True), Cloud(points, 100), np.zeros(4, np.bool_))
    with answered(declared, answer) as kernel:
        expected = 2.0 * (0.5 + 1 + 4 + 6 + 3 + 2 + 100 + 5.0)
        assert kernel(owner, 2.0) == expected
        assert kernel(Written(owner, Owner), 2.0) == expected
        lent = owner._replace(cloud=Written(owner.cloud, Cloud))
        assert kernel(lent, 2.0) == expected


@pytest.mark.parametrize(
    "given",
    [
        np.zeros((2, 2), np.float32), np.zeros((2, 2), np.int64), np.zeros(4), np.zeros((1, 2, 2)),
        np.zeros((2, 2), order="F"), np.zeros((4, 2))[::2], np.zeros((2, 4))[:, ::2],
        np.zeros((2, 2), np.dtype(np.float64).newbyteorder()),
    ],
    ids=["singles", "integers", "one axis", "three axes", "F order", "rows", "columns", "bytes swapped"],
)  # fmt: skip
def test_an_array_that_lies_otherwise_is_refused(given):
    def declared(rows: Floats2) -> None: ...

    def inside(cloud: Cloud) -> None: ...

    for function, argument in ((declared, given), (inside, Cloud(given, 1))):
        with (
            answered(function, lambda *_: pytest.fail("it was called")) as kernel,
            pytest.raises(TypeError, match="needed is float64 with 2 axes in C order"),
        ):
            kernel(argument)


def test_too_few_arguments_and_items_are_refused():
    def declared(point: Point, n: int) -> None: ...

    with answered(declared, lambda *_: pytest.fail("it was called")) as kernel:
        with pytest.raises(TypeError, match="given 1 arguments and takes 2"):
            kernel(Point(0.0, True))
        with pytest.raises(TypeError, match="1 values are given"):
            kernel((0.0,), 1)


def test_an_argument_without_an_annotation_is_refused():
    def undeclared(n: int, rows) -> None: ...

    with (
        answered(undeclared, lambda *_: 0) as kernel,
        pytest.raises(TypeError, match="declare rows"),
    ):
        kernel(1, 2)


@pytest.mark.parametrize(
    ("kind", "form", "value"),
    [
        (int, "=q", -(2**62)),
        (float, "=d", 0.1),
        (bool, "=?", True),
        (Point, "=d?7x", Point(0.5, True)),
    ],
)
def test_a_result_without_arrays_is_read(kind, form, value):
    def declared() -> None: ...

    declared.__annotations__["return"] = kind
    block = struct.pack(form, *(value if kind is Point else [value]))
    with answered(
        declared, lambda _, result: ctypes.memmove(result, block, len(block)) and 0
    ) as kernel:
        found = kernel()
    assert found == value and type(found) is kind


def test_arrays_of_a_result_are_read_by_their_strides():
    def declared(n: int) -> tuple[Found, Floats]: ...

    def answer(_: int, result: int) -> int:
        data = take(8 * 12)
        write_words(data, list(np.arange(12.0).view(np.int64)))
        ctypes.memmove(result, struct.pack("=d?7x", 0.25, True), 16)
        write_words(result + 16, words_of_array(data, (2, 3), (48, 8)))
        write_words(result + 16 + 72, [5, *words_of_array(0, (0,), (8,))])
        return 0

    with answered(declared, answer) as kernel:
        found, rest = kernel(1)
    assert isinstance(found, Found) and found.point == (0.25, True) and found.n == 5
    assert found.rows.tolist() == [[0.0, 1.0, 2.0], [6.0, 7.0, 8.0]]
    assert rest.shape == (0,) and rest.dtype == np.float64


def test_a_kernel_that_stops_is_a_fault():
    def declared(n: int) -> int: ...

    with answered(declared, lambda *_: 1) as kernel, pytest.raises(KernelFault, match="declared"):
        kernel(1)


def test_a_prepared_call_reads_the_same_arrays_each_time():
    def declared(points: Floats) -> float: ...

    def answer(given: int, result: int) -> int:
        ctypes.memmove(result, words_at(given, "=32xq")[0], 8)
        return 0

    with answered(declared, answer) as kernel:
        points = np.array([1.5])
        ask = kernel.prepared(points)
        assert ask() == 1.5
        points[0] = 2.5
        assert ask() == 2.5
        del points
        gc.collect()
        assert ask() == 2.5
