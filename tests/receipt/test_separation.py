"""Bounds on the distance of parts in motion, against distances in rational arithmetic."""

import math

import numpy as np
import pytest

from clearance.receipt.case_data import case_data
from clearance.receipt.fronts import codes_of
from clearance.receipt.nearest import nearest_directions
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.proving import SIZES
from clearance.receipt.proof.separation import BYTE, directions
from clearance.receipt.proof.stage import by_balls, by_directions
from tests import cells
from tests.oracle.polyhedra import polyhedron_distance_sq
from tests.receipt.receipts import everything_moves, stage_of

CLAIM = 2.0**-20


def some_items(stage, rng, n=24):
    """Random parts of bodies over random pieces of time."""
    bodies = stage.stretch.pairs
    pair = rng.integers(0, len(bodies), n)
    depth = rng.integers(0, 4, n)
    nodes = [
        np.where(
            stage.halves.sizes(bodies[pair, k], np.zeros(n, int)) >= 8, rng.integers(0, 7, n), 0
        )
        for k in (0, 1)
    ]
    start = rng.integers(0, stage.stretch.n_intervals, n)
    one = np.ones(n, dtype=np.int64)
    return Items(pair, *nodes, start, one, rng.integers(0, 2**depth), depth)


def true_distance(case, stage, items, i, t):
    """[m] of the parts of an item at a share of its time, by other kinematics and exact arithmetic."""
    share = (items.part[i] + t) * 0.5 ** items.depth[i]
    times = stage.stretch.times[items.start[i] : items.start[i] + 2]
    time = (1.0 - share) * times[0] + share * times[1]
    sides = []
    for k, node in ((0, items.node_a[i]), (1, items.node_b[i])):
        body = stage.stretch.pairs[items.pair[i], k]
        at = stage.halves.first_node[body] + node
        corners = stage.halves.corners[:, :, stage.halves.start[at] : stage.halves.stop[at]]
        pose = cells.pose_at(case, stage.shapes[body].name, float(time), left=share == 1.0)
        points = corners.transpose(2, 1, 0).reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
        sides += [points, np.arange(len(points)).reshape(-1, 3)]
    return math.sqrt(polyhedron_distance_sq(*sides))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_no_bound_is_above_the_distance_at_any_moment_of_its_piece(seed):
    case, rng = everything_moves(seed), np.random.default_rng(seed)
    data = case_data(case)
    n_tight = 0
    for i_stretch in range(len(data.stretches)):
        stage = stage_of(data, i_stretch, CLAIM)
        items = some_items(stage, rng)
        u, _ = nearest_directions(stage, items)
        away = rng.normal(size=u.shape)
        bounds = [by_balls(stage, items), by_directions(stage, items, away)]
        bounds += [by_directions(stage, items, directions(codes_of(u, m), m)) for _, m in SIZES]
        wanted = stage.wanted[items.pair, items.start]
        best = np.max(bounds, axis=0) + wanted
        for i in rng.permutation(len(items.pair))[:8]:
            true = min(true_distance(case, stage, items, i, t) for t in (0.0, rng.random(), 1.0))
            assert best[i] <= true + 1e-9
            n_tight += best[i] > 0.8 * true > 0.0
    assert n_tight > 0


def test_codes_stand_for_all_directions():
    rng = np.random.default_rng(0)
    u = rng.normal(size=(3, 500))
    u /= np.linalg.norm(u, axis=0)
    for most, loss in ((BYTE, 2e-4), (2**15 - 1, 3e-9), (2**31 - 1, 1e-15)):
        found = directions(codes_of(u, most), most)
        assert (np.abs(found).sum(axis=0) == most).all()
        assert ((u * found).sum(axis=0) / np.linalg.norm(found, axis=0) >= 1.0 - loss).all()
    axes = np.concatenate([np.eye(3), -np.eye(3)], axis=1)
    assert (directions(codes_of(axes, BYTE), BYTE) == BYTE * axes).all()
