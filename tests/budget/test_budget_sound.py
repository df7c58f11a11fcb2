"""No error that a budget allows brings bodies nearer than what is proven: at random, and as bad as found."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.budget.proven import PathMoments, proven_of_steps
from clearance.kernels.budget.sweep import FEW, REFINED_OF_MANY
from tests.budget.budget_cases import pair_names, proven_sections, random_case
from tests.budget.sampled_machine import SampledMachine

ROUNDING = 1e-12

NEAREST = 2
"""Pairs that are measured with errors; brute force takes its time."""


def assert_none_below(
    case, section, time: float, proven: float, rng, n_random: int, *, ascend: bool
):
    """`proven` [m] is not above any sample of the pairs that are nearest."""
    machine, names = SampledMachine(case), pair_names(case, section)
    for pair in sorted(names, key=lambda pair: machine.left(time, {}, pair))[:NEAREST]:
        for _ in range(n_random):
            assert proven <= machine.left(time, machine.random(rng), pair) + ROUNDING
        if ascend:
            left = machine.as_bad_as_found(time, pair, machine.random(rng))
            assert proven <= left + ROUNDING


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


@pytest.mark.slow
@pytest.mark.parametrize("seed", (1, 2))
def test_no_errors_come_below_what_is_proven_of_many_steps(seed):
    """So many that a search goes on from where the one of the step before has ended."""
    case = random_case(seed, n_steps=FEW + 8)
    rng = np.random.default_rng(seed)
    for section, found, _, steps, _ in proven_sections(case):
        free = np.flatnonzero(found.clearance > 0.0)
        for step in free[np.argsort(steps.proven[free])[:2]]:
            time = section.phase.times[step]
            assert_none_below(case, section, time, steps.proven[step], rng, 4, ascend=False)


def test_many_steps_are_no_looser_than_the_stated_share_of_each_alone():
    case = random_case(1, n_steps=FEW + 8)
    for _, found, pairs, steps, _ in proven_sections(case):
        at = pairs.steps
        for i in np.flatnonzero(found.clearance > 0.0):
            one = slice(i, i + 1)
            moment = PathMoments(at.intervals[one], at.shares[one])
            alone = pairs.at(moment, found.pair[one], found.clearance[one]).proven[0]
            taken = found.clearance[i] - alone
            assert steps.proven[i] >= alone - 2.0 * REFINED_OF_MANY * taken


def test_the_least_of_many_steps_is_as_exact_as_each_alone_and_the_same_each_time():
    case = random_case(1, n_steps=FEW + 8)
    for _, found, pairs, steps, _ in proven_sections(case):
        at, alone = pairs.steps, []
        for i in range(len(at)):
            one = slice(i, i + 1)
            moment = PathMoments(at.intervals[one], at.shares[one])
            alone.append(pairs.at(moment, found.pair[one], found.clearance[one]).proven[0])
        assert steps.proven.min() >= min(alone) - 1e-9
        again = proven_of_steps(pairs, found)  # in a scene that others have worked with
        assert (again.proven == steps.proven).all() and (again.pair == steps.pair).all()
