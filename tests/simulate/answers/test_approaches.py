"""What clearances change by, against differences of exact distances."""

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.answers.approaches import approaches
from tests.cells import cell

STEP = 1e-6


def near_rows(case, beyond=0.3):
    run = cl.check(case, certify=False)
    return run.record, [
        one for one in approaches(run.session.rules, beyond) if (one.clearances > 1e-3).any()
    ]


def moved_by(case, approach, row, column):
    """(2,) the distance of the pair with a column a little less and a little more, measured anew."""
    from clearance.world.forest import forest_of, joined_positions

    phase = approach.section.phase
    own = np.array([approach.steps[row] - phase.first])
    found = []
    for sign in (-1.0, 1.0):
        positions = joined_positions(phase.case, phase.motions, own)
        positions[0, column] += sign * STEP
        poses = forest_of(phase.case).poses(positions)
        a, b = approach.pair
        near = cl.distance(
            a.shape_in(phase.case),
            b.shape_in(phase.case),
            pose_a=a.poses_in(phase.case, poses)[0],
            pose_b=b.poses_in(phase.case, poses)[0],
        )
        found.append(near.distance)
    return found


@pytest.mark.parametrize("seed", range(2))
def test_joints_change_clearances_as_exact_differences_do(seed):
    _, rows = near_rows(cell(seed))
    compared = 0
    for approach in rows:
        by_columns = approach.by_columns()
        for row in np.flatnonzero(approach.clearances > 1e-3)[:3]:
            for column in np.flatnonzero(by_columns[row]):
                less, more = moved_by(approach.case, approach, row, column)
                here = approach.clearances[row] + approach.section.padding
                one_sided = sorted([(more - here) / STEP, (here - less) / STEP])
                low, high = one_sided[0] - 1e-4, one_sided[1] + 1e-4
                assert low <= by_columns[row, column] <= high
                compared += 1
    assert compared > 3
