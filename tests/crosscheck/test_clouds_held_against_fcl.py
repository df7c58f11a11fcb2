"""FCL about clouds of points: what is right agrees, and a point that was overlooked is a disagreement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clearance import PointCloud
from tests.crosscheck.sliding import box, cross_check, rail_record
from tests.query.test_clouds import GRID, KINDS, answer, scan, solid_of

pytestmark = pytest.mark.peer


def record_of(given, near):
    """A record of one step: the solid on a rail, a cloud beside it, and what was found of them."""
    cloud = PointCloud(given.points / GRID, given.radius / GRID)
    row = (near.distance, "cloud", near.point_b, near.point_a)
    return rail_record(solid_of(given.boxes), {"cloud": (cloud, (0, 0, 0))}, [0.0], [row])


@pytest.mark.parametrize("n", [1, 7, 60, 400])
@pytest.mark.parametrize("kind", KINDS)
def test_right_answers_agree_and_wrong_ones_do_not(n, kind):
    """The other way round as well: a distance where a point is inside, contact where none is."""
    for seed in range(2):
        given = scan(np.random.default_rng(seed), n, kind)
        true, near = answer(given, np.eye(4))
        record = record_of(given, near)
        check = cross_check(record)
        assert check.agrees and check.n_settled == 0, (seed, check)
        assert near.distance == pytest.approx(true, abs=1e-12)
        for wrong in (near.distance + 1e-6, max(0.0, near.distance - 1e-6)):
            if abs(wrong - true) >= 1e-6:
                rows = record.rows.with_columns({"clearance": np.array([wrong])})
                assert not cross_check(replace(record, table=rows)).agrees, (seed, wrong)


def test_a_point_wholly_inside_that_is_called_apart_is_a_disagreement():
    """FCL alone says 246 mm for a point in the middle of a box of 0.5 m, and is asked what is inside besides."""
    cloud = PointCloud([[0.002, -1.03, 0.345], [0.0, 0.0, 0.0]], 0.004)
    row = (0.246, "cloud", (0.0, 0.0, -0.25), (0.0, 0.0, -0.004))
    record = rail_record(box(0.5, 0.5, 0.5), {"cloud": (cloud, (0, 0, 0))}, [0.0], [row])
    (found,) = cross_check(record).disagreements
    assert (found.peer_clearance, found.reason) == (0.0, "the peer says contact")
