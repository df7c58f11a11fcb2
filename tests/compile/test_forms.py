"""The types of a call, told without the compiler: as the compiler's own are told, and never alike for two."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
import pytest

from clearance.compile.forms import form_of

pytestmark = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled here")


class Pair(NamedTuple):
    a: object
    b: object


def fixed(array: np.ndarray) -> np.ndarray:
    array.setflags(write=False)
    return array


CUBE = np.zeros((2, 3, 4))
VALUES = [
    1, 1.0, True, np.float32(1.0), np.int32(1), np.uint8(1), np.zeros(3), np.zeros(3, dtype=np.float32),
    np.zeros(3, dtype=bool), np.zeros((3, 2), dtype=np.int32), CUBE, CUBE.T, CUBE[:, ::2], fixed(np.zeros(3)),
    (1, 2.0), (1, 1), Pair(1, 2.0), Pair(np.zeros(2), (1.0, Pair(1, 2))),
]  # fmt: skip


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_it_is_told_as_the_compiler_tells_it(value):
    from clearance.compile.numba_types import form_of_types

    form = form_of((value,))
    assert form is not None and form == form_of_types((numba.typeof(value),))


def test_different_types_are_told_differently():
    kinds = {str(numba.typeof(value)): form_of((value,)) for value in VALUES}
    assert len(set(kinds.values())) == len(kinds)


@pytest.mark.parametrize(
    "value",
    [2**63, -(2**63) - 1, "text", None, np.zeros(3, dtype=">f8"), np.zeros(3, dtype="c16"),
     np.frombuffer(bytes(17), dtype=np.uint8)[1:].view(np.float64), [1.0], Pair(1, "text")],
)  # fmt: skip
def test_what_only_the_compiler_can_type_is_left_to_it(value):
    assert form_of((1.0, value)) is None
