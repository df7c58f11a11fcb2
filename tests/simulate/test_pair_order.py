"""The pairs of each body stay in the order of their bounds, whichever of them change."""

import numpy as np
import pytest

from clearance.compile.jit import kernel
from clearance.kernels.motion.pair_order import (
    fill_order,
    new_pair_order,
    sort_all,
    sort_first,
    sort_one,
)


@kernel
def ordered(body_pairs, bounds, order):
    fill_order(body_pairs, order)
    sort_all(bounds, order)


@kernel
def ordered_again(bounds, order, body, stop, pair):
    """`sort_one` for a pair, or where that is -1 `sort_first`."""
    if pair >= 0:
        sort_one(bounds, order, body, pair)
    else:
        sort_first(bounds, order, body, stop)


def lists_of(order, n_bodies):
    return [order.pairs[order.starts[k] : order.starts[k + 1]].tolist() for k in range(n_bodies)]


@pytest.mark.parametrize("seed", range(20))
def test_each_list_is_in_order_and_holds_its_pairs(seed):
    random = np.random.default_rng(seed)
    n_bodies, n_pairs = int(random.integers(1, 6)), int(random.integers(1, 60))
    body_pairs = np.column_stack(
        [random.integers(0, n_bodies, n_pairs), np.full(n_pairs, n_bodies)]
    )
    bounds = random.choice(
        [random.normal(size=n_pairs), random.integers(0, 4, n_pairs).astype(float)]
    )
    order = new_pair_order(n_bodies, n_pairs)
    ordered(body_pairs, bounds, order)
    for _ in range(50):
        held = lists_of(order, n_bodies)
        for body, pairs in enumerate(held):
            assert sorted(pairs) == np.flatnonzero(body_pairs[:, 0] == body).tolist()
            assert (np.diff(bounds[pairs]) >= 0.0).all()
        body = int(random.choice(body_pairs[:, 0]))
        if random.random() < 0.5:
            pair = int(random.choice(held[body]))
            bounds[pair] += random.normal()
            ordered_again(bounds, order, body, 0, pair)
        else:
            n_changed = int(random.integers(0, len(held[body]) + 1))
            bounds[held[body][:n_changed]] += random.normal(size=n_changed)
            ordered_again(bounds, order, body, int(order.starts[body]) + n_changed, -1)
    assert order.starts[n_bodies + 1] - order.starts[n_bodies] == 1  # the pair that is asked first
