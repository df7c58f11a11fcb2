"""How long the compiler takes does not depend on how deep it was called from."""

from __future__ import annotations

import sys

import pytest

from clearance.compile.interpreter import with_room_for_frames

resource = pytest.importorskip("resource")

CALLS = 200
DEEPEST = 400


def nothing():
    return None


def faults_at(depth: int) -> int:
    """How often the system had to give memory while a function was called in a loop, `depth` frames up."""
    if depth > 0:
        return faults_at(depth - 1)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(CALLS):
        nothing()
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


def most_faults() -> int:
    return max(map(faults_at, range(DEEPEST)))


def test_with_room_no_call_takes_memory_from_the_system():
    assert with_room_for_frames(most_faults) < CALLS


@pytest.mark.skipif(sys.version_info[:2] > (3, 13), reason="frames may be kept in another way")
def test_without_room_some_depths_take_it_at_each_call():
    assert most_faults() >= CALLS


def test_what_is_called_gets_its_arguments_and_its_errors_come_out():
    assert with_room_for_frames(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        with_room_for_frames(divmod, 7, 0)
