"""Where bodies are and how far they move in a piece, against kinematics that share no code with the package."""

import numpy as np
import pytest

from clearance.receipt.case_data import case_data
from clearance.receipt.proof.joint_paths import IntervalPieces
from clearance.receipt.proof.motion_data import NONE
from clearance.receipt.proof.views import links_above
from tests import cells
from tests.examples import first_fast
from tests.receipt.receipts import everything_moves, stage_of


@pytest.mark.parametrize("seed", first_fast([0, 2], 1))
def test_no_point_is_farther_off_than_its_bounds_say(seed):
    case, rng = everything_moves(seed), np.random.default_rng(seed)
    data = case_data(case)
    for i_stretch, stretch in enumerate(data.stretches):
        stage = stage_of(data, i_stretch)
        views = stage.views
        for interval in range(stretch.n_intervals):
            low = rng.integers(0, 4) / 4
            piece = IntervalPieces(np.array([interval]), np.array([low]), np.array([low + 0.25]))
            wanted = np.ones(len(views.frames), dtype=bool)
            at = stage._placed(piece, wanted)
            for view, body in enumerate(views.bodies):
                if in_world(stretch, views, view):
                    inside(case, data, stretch, at, view, int(body), piece, rng)


def in_world(stretch, views, view):
    """True if a view is from the world: its topmost frame hangs on a root."""
    frame = int(views.frames[view])
    if frame == NONE:
        return int(stretch.carriers[views.bodies[view]]) == NONE
    while views.above[frame] != NONE:
        frame = int(views.above[frame])
    return stretch.joints.parents[views.links[frame]] == NONE


def inside(case, data, stretch, at, view, body, piece, rng):
    """Asserts that random points at random moments of a piece are where the bounds say."""
    shape, i = data.shapes[body], int(piece.interval[0])
    points = shape.points[rng.integers(0, len(shape.points), 4)]
    middle = points @ at.turn[:, :, view].T + at.at[:, view]
    swing = at.v0[:, view] + np.cross(at.omega[:, view], middle)
    for t in (-1.0, *rng.uniform(-1.0, 1.0, 2), 1.0):
        share = 0.5 * (piece.low[0] + piece.high[0]) + 0.5 * t * (piece.high[0] - piece.low[0])
        time = (1.0 - share) * stretch.times[i] + share * stretch.times[i + 1]
        pose = cells.pose_at(case, shape.name, float(time), left=share == 1.0)
        moved = points @ pose[:3, :3].T + pose[:3, 3]
        slack = 1e-9
        off = np.linalg.norm(moved - middle - t * swing, axis=1)
        assert (off <= at.rest[view] + at.rounding[view] + slack).all()
        assert (np.linalg.norm(moved - middle, axis=1) <= at.way[view] + slack).all()


def test_rounding_is_far_below_a_nanometre_of_what_is_claimed():
    data = case_data(everything_moves(0))
    assert all(stage_of(data, i).whole.rounding.max() < 1e-11 for i in range(len(data.stretches)))


def test_what_both_bodies_stand_on_does_not_count():
    data = case_data(everything_moves(0))
    stretch = data.stretches[0]
    stage = stage_of(data, 0)
    for pair, views in zip(stretch.pairs, stage.views.pairs, strict=True):
        links = [int(stretch.carriers[body]) for body in pair]
        shared = set(links_above(stretch.joints, links[0])) & set(
            links_above(stretch.joints, links[1])
        )
        for view in views:
            frame = int(stage.views.frames[view])
            while frame != NONE:
                assert int(stage.views.links[frame]) not in shared
                frame = int(stage.views.above[frame])
