"""By need `limit` and `minimum` each body is looked at when it may have come near; nothing is missed by that."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box, cylinder
from clearance.world.case import Case, Limits
from tests.made_cases import arm, at, dented, spindle, torus
from tests.strategies import rotations


def swaying_arm(random: np.random.Generator) -> Case:
    """Up to four links whose joints sway each at its own pace, some that rest or jerk, among obstacles."""
    n_links, n_steps = int(random.integers(1, 5)), int(random.integers(2, 500))
    pace = random.choice([0.001, 0.01, 0.1, 1.0], (1, n_links))
    sway = np.sin(np.arange(n_steps)[:, None] * pace + random.uniform(0.0, 6.0, (1, n_links)))
    positions = random.uniform(-2.0, 2.0, (1, n_links)) + random.choice([0.1, 0.5, 2.0]) * sway
    positions += random.choice([0.0, 1e-9, 0.05]) * random.normal(size=positions.shape)
    positions[:, random.integers(n_links)] *= random.choice([0.0, 1.0])
    shapes = {
        "spindle": lambda: spindle(0.05, 0.1, 5),
        "dented": lambda: dented(random, 0, 0.4, 0.08),
        "box": lambda: box(random.uniform(0.02, 0.2, 3)),
        "cylinder": lambda: cylinder(0.04, 0.2),
        "ring": lambda: torus(0.1, 0.04, 9, 5),
    }
    some = [shapes[kind]() for kind in random.choice(list(shapes), n_links + random.integers(1, 5))]
    around = random.choice([0.35, 0.8])
    obstacles = [
        (shape, at(*around * random.normal(size=3), turned=rotations(random, 1)[0]))
        for shape in some[n_links:]
    ]
    warn = random.choice([1e-3, 0.02, 0.1, 0.4])
    return replace(
        arm("swaying", some[:n_links], obstacles, positions), limits=Limits(warn / 2.0, warn)
    )


@pytest.mark.parametrize("seed", range(16))
def test_bodies_with_clocks_of_their_own_miss_nothing(seed):
    case = swaying_arm(np.random.default_rng(seed))
    runs = {
        need: cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=1))
        for need in ("steps", "limit", "minimum")
    }
    truth = runs["steps"].steps["clearance"].to_numpy()
    told = runs["limit"].steps["clearance"].to_numpy()
    known = ~np.isnan(told)
    assert (told[known] == truth[known]).all()
    assert known[truth < case.limits.warn].all()
    assert runs["minimum"].worst["clearance"] == truth.min()
    assert runs["minimum"].worst["step"] == truth.argmin()
    for need in ("limit", "minimum"):
        if "lower_bound" in runs[need].steps.column_names:  # not if every step is known
            assert (runs[need].steps["lower_bound"].to_numpy() <= truth).all()
