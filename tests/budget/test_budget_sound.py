"""No error that a budget allows brings bodies nearer than what is proven: at random, and as bad as found."""

from __future__ import annotations

import numpy as np
import pytest

from tests.budget.budget_cases import pair_names, proven_sections, random_case
from tests.oracle.perturbed import Perturbed, ascended, random_errors, sizes

ROUNDING = 1e-12

NEAREST = 2
"""Pairs that are measured with errors; brute force takes its time."""


def assert_none_below(
    case, section, time: float, proven: float, rng, n_random: int, *, ascend: bool
):
    """`proven` [m] is not above any sample; the least of them."""
    machine = Perturbed(case, pair_names(case, section))
    found = sizes(case)
    nominal = machine.each(time, {})
    machine.pairs = sorted(nominal, key=nominal.__getitem__)[:NEAREST]
    least = np.inf
    for _ in range(n_random):
        left = machine.left(time, random_errors(found, rng))
        assert proven <= left + ROUNDING
        least = min(least, left)
    if ascend:
        left, _ = ascended(lambda e: machine.left(time, e), found, random_errors(found, rng))
        assert proven <= left + ROUNDING
        least = min(least, left)
    return least


@pytest.mark.slow
@pytest.mark.parametrize("seed", (0, 1, 2, 8))
def test_no_errors_come_below_what_is_proven_of_the_worst_step(seed):
    case = random_case(seed)
    rng = np.random.default_rng(seed)
    for section, found, _, steps, _ in proven_sections(case):
        worst = int(np.argmin(steps.proven))
        if found.clearance[worst] <= 0.0:
            continue
        time = section.phase.times[worst]
        assert steps.proven[worst] < found.clearance[worst]
        assert_none_below(case, section, time, steps.proven[worst], rng, 8, ascend=True)
