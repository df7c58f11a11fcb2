"""Between samples no joint is farther from its cubic than is proven, and the tool is where the program says."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.programs.inverse import joints_at
from clearance.world.cubic import cubics_of, position_on
from tests.programs.arms import arm, somewhere


@pytest.mark.parametrize("name", ["heron6", "panda", "iiwa"])
@pytest.mark.parametrize("seed", range(4))
def test_no_joint_is_farther_off_than_is_proven(name, seed):
    draw = np.random.default_rng(seed)
    one = arm(name)
    on, follower, samples = somewhere(one, draw)
    proven = np.isfinite(samples.deviations).all(axis=1)
    cubics = cubics_of(samples.times, samples.positions, samples.velocities)
    share, rate, change = samples.intervals.strokes
    found = np.zeros_like(samples.deviations)
    for at in np.linspace(0.05, 0.95, 10):
        near = position_on(cubics, np.array(at))
        passed = (at * samples.intervals.lengths)[:, None]
        strokes = share + passed * (rate + 0.5 * passed * change)
        solved = joints_at(one.tool, on.poses(strokes), near, follower.free)
        found = np.maximum(found, np.abs(solved.positions - near))
    assert (found[proven] <= samples.deviations[proven]).all()
    worst = found[proven].max()
    assert worst > 1e-9 and samples.deviations[proven].max() < 3.0 * worst


def test_the_tool_is_on_its_path_at_the_samples():
    one, draw = arm("heron6"), np.random.default_rng(1)
    on, _, samples = somewhere(one, draw)
    strokes = np.stack([samples.shares, np.zeros_like(samples.shares)], axis=1)
    assert np.abs(one.poses(samples.positions) - on.poses(strokes)).max() < 1e-10
