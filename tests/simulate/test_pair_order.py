"""The pairs of each body stay in the order of their bounds, whichever of them change."""

import numpy as np
import pytest

from clearance.kernels.motion.pair_order import (
    fill_order,
    new_pair_order,
    sort_all,
    sort_first,
    sort_one,
)


def ordered(body_pairs, frames, bounds, order):
    fill_order(body_pairs, frames, order)
    sort_all(bounds, order)


def ordered_again(bounds, order, body, stop, pair):
    """`sort_one` for a pair, or where that is -1 `sort_first`."""
    if pair >= 0:
        sort_one(bounds, order, body, pair)
    else:
        sort_first(bounds, order, body, stop)


def lists_of(order, n_bodies):
    """What is in order of each body's list, and what is behind that."""
    return [
        (
            order.pairs[order.starts[k] : order.ends[k]].tolist(),
            order.pairs[order.ends[k] : order.starts[k + 1]].tolist(),
        )
        for k in range(n_bodies)
    ]


@pytest.mark.parametrize("seed", range(20))
def test_each_list_is_in_order_and_holds_its_pairs(seed):
    random = np.random.default_rng(seed)
    n_bodies, n_pairs = int(random.integers(1, 6)), int(random.integers(1, 60))
    others = random.integers(0, n_bodies + 2, n_pairs)  # the last two stand
    body_pairs = np.column_stack([random.integers(0, n_bodies, n_pairs), others])
    frames = np.where(np.arange(n_bodies + 2) < n_bodies, 0, -1)
    bounds = random.choice(
        [random.normal(size=n_pairs), random.integers(0, 4, n_pairs).astype(float)]
    )
    order = new_pair_order(n_bodies + 2, n_pairs)
    ordered(body_pairs, frames, bounds, order)
    for _ in range(50):
        held = lists_of(order, n_bodies)
        for body, (pairs, between) in enumerate(held):
            assert sorted(pairs + between) == np.flatnonzero(body_pairs[:, 0] == body).tolist()
            assert (np.diff(bounds[pairs]) >= 0.0).all()
            assert between == sorted(between) and (others[between] < n_bodies).all()
        body = int(random.choice(body_pairs[:, 0]))
        if random.random() < 0.5:
            pair = int(random.choice([*held[body][0], *held[body][1]]))
            bounds[pair] += random.normal()
            ordered_again(bounds, order, body, 0, pair)
        else:
            n_changed = int(random.integers(0, len(held[body][0]) + 1))
            bounds[held[body][0][:n_changed]] += random.normal(size=n_changed)
            ordered_again(bounds, order, body, int(order.starts[body]) + n_changed, -1)
    assert (
        order.starts[n_bodies + 3] - order.starts[n_bodies + 2] == 1
    )  # the pair that is asked first
