"""No errors, drawn anew for every moment at which a part changes hands, bring it nearer than what is proven."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.budget.proven import PairsWithErrors, proven_between, proven_of_steps
from clearance.simulate.measure.measure import measure
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.case import Case
from tests.budget.budget_cases import (
    arm_robot,
    bar,
    cart_table,
    pair_names,
    random_budget,
    sections_of,
    swinging,
)
from tests.budget.sampled_machine import HandlingMachine
from tests.made_cases import at
from tests.strategies import rotations

GAP, ROUNDING = 1e-3, 1e-12

N_STEPS = 7

N_RANDOM = 3
"""Errors that are drawn, the last of which are made worse."""


def handling(seed: int) -> Case:
    """A part goes from the left arm to the right one, lies, and is put on a cart, which drives on with it.

    At first it stands, or rides on a table, on the left arm's own base, or on the cart, by turns.
    """
    rng = np.random.default_rng(seed)
    turned = rotations(rng, 6)
    away = at(0.9, 0.3, 0.2, turned=turned[0])
    robots = (
        swinging(arm_robot("left"), rng, N_STEPS),
        swinging(arm_robot("right"), rng, N_STEPS, away),
    )
    place = at(*rng.uniform(-0.3, 0.3, 3) + [0.5, 0.6, 0.3], turned=turned[1])
    on = (None, "table", "left/base", "cart")[seed % 4]
    first = {"world_from_body": place} if on is None else {"mount": Mount(on, place)}
    obstacles = (
        Obstacle(Body("part", bar(0.12)), **first),
        Obstacle(Body("label", cl.box([0.03] * 3)), mount=Mount("part", at(0.0, 0.1, 0.05))),
        Obstacle(Body("table", cl.box([0.2, 0.2, 0.05])), at(0.2, -0.7, 0.1, turned=turned[2])),
        Obstacle(Body("post", cl.box([0.05, 0.05, 0.4])), at(0.6, -0.4, 0.1, turned=turned[3])),
        Obstacle(
            Body("cart", cl.box([0.2, 0.1, 0.1])),
            moves=cart_table(rng, N_STEPS, turn=0.4, speed=0.3),
        ),
    )
    exact = (rng.random(3) < 0.25).tolist()
    carries = (
        cl.Carry("part", "left/hand", cl.Window(0.1, 0.3), exact_grasp=exact[0]),
        cl.Carry("part", "right/hand", cl.Window(0.3, 0.4), exact_grasp=exact[1]),
        cl.Carry("part", "cart", cl.Window(0.5), exact_grasp=exact[2]),
    )
    case = Case("handling", robots, obstacles, carries=carries)
    return replace(case, tolerance=random_budget(case, rng))


def of_parts(case: Case):
    """Each section with only the nearest pair of something that changes hands, and that pair with errors."""
    for section in sections_of(case):
        pairs = [pair for pair, named in zip(section.pairs, pair_names(case, section), strict=True)
                 if {"part", "label"} & set(named)]  # fmt: skip
        found = measure(replace(section.in_motion, pairs=tuple(pairs)))
        nearest = pairs[int(found.pair[np.argmin(found.clearance)])]
        alone = replace(section.in_motion, pairs=(nearest,))
        yield replace(section, pairs=(nearest,)), PairsWithErrors(alone, case.tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_no_errors_of_any_moment_come_below_what_is_proven(seed):
    case, rng = handling(seed), np.random.default_rng(seed)
    machine, n_apart = HandlingMachine(case), 0
    for section, pairs in of_parts(case):
        (pair,), times = pair_names(case, section), section.phase.times
        steps = proven_of_steps(pairs, measure(pairs.what))
        between = proven_between(pairs, steps, GAP)
        moments = [*machine.moments(times[0]), machine.NOW]
        i = int(rng.integers(len(times) - 1))
        for time, proven in (
            (times[i], steps.proven[i]),
            (rng.uniform(*times[i : i + 2]), between.proven[i]),
        ):
            n_apart += proven > 0.0
            for _ in range(N_RANDOM):
                errors = {moment: machine.random(rng) for moment in moments}
                assert machine.left_in(times[0], time, errors, pair) >= proven - ROUNDING
    assert machine.nearer(times[0], times[i], pair, errors) >= steps.proven[i] - ROUNDING
    assert n_apart
