"""Occurrences are counted by what parts for good, not by noise about a limit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.findings.occurrences import NearCourse, release_level
from clearance.world.case import Limits

FAIL = 0.005
LEVEL = release_level(Limits(FAIL))


def course(clearances, between=None, bridges=()) -> NearCourse:
    """Of the clearances at the steps, and by step of those seen between it and the next; as a rule knows them."""
    seen = {2 * i: c for i, c in enumerate(clearances)}
    seen |= {2 * i + 1: c for i, c in (between or {}).items()}
    near = sorted((position, c) for position, c in seen.items() if c < LEVEL)
    positions, found = (np.array([row[i] for row in near]) for i in (0, 1))
    return NearCourse(
        positions.astype(np.int64), found, found <= 0.0, 2 * np.array(bridges, np.int64)
    )


def spans(found: NearCourse) -> list[tuple[int, int]]:
    return [
        (int(found.positions[rows.start]), int(found.positions[rows.stop - 1]))
        for rows in found.broken(Limits(FAIL))
    ]


FAR, OUT, AT, IN = 0.1, LEVEL + 1e-9, FAIL, FAIL - 1e-9


@pytest.mark.parametrize(
    ("clearances", "between", "expected"),
    [
        ([FAR, FAR], {}, []),
        ([AT, AT], {}, []),
        ([FAR, IN, FAR], {}, [(2, 2)]),
        ([IN, AT, IN, AT, IN], {}, [(0, 8)]),
        ([IN, OUT, IN], {}, [(0, 0), (4, 4)]),
        ([IN, FAR, FAR, IN], {}, [(0, 0), (6, 6)]),
        ([AT, IN, AT], {}, [(0, 4)]),
        ([FAR, FAR], {0: IN}, [(1, 1)]),
        ([FAR, FAR, FAR], {0: IN, 1: IN}, [(1, 1), (3, 3)]),
        ([FAR, AT, FAR], {0: IN, 1: IN}, [(1, 3)]),
        ([AT, FAR], {0: IN}, [(0, 1)]),
        ([AT, FAR, AT], {1: IN}, [(3, 4)]),
        ([0.0], {}, [(0, 0)]),
    ],
)
def test_stretches_are_counted_where_the_pair_parts_for_good(clearances, between, expected):
    assert spans(course(clearances, between)) == expected


IN_FOR = st.integers(0, 5).map(lambda n: [0.001] + [FAIL] * n)
"""Well below the limit once, then at it, where noise takes it to both sides."""


@given(st.lists(IN_FOR | st.just([0.2]), min_size=1, max_size=12), st.integers(0, 2**32 - 1))
def test_noise_below_the_hysteresis_changes_no_number(parts, seed):
    clearances = np.concatenate(parts)
    noise = np.random.default_rng(seed).uniform(-0.0004, 0.0004, len(clearances))
    assert spans(course(clearances)) == spans(course(clearances + noise))


@given(st.lists(st.floats(0.0, 0.02), min_size=1, max_size=60))
def test_occurrences_are_apart_and_hold_all_that_is_below_the_limit(clearances):
    found = spans(course(clearances))
    below = {2 * i for i, c in enumerate(clearances) if c < FAIL or c <= 0.0}
    held = {p for first, last in found for p in range(first, last + 1)}
    assert below <= held
    for (_, last), (first, _) in zip(found, found[1:], strict=False):
        parted = [clearances[i] for i in range(last // 2 + 1, first // 2)]
        assert parted and max(parted) >= LEVEL
