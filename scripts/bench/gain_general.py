"""The same shifts by a general optimiser: scipy's SLSQP from 20 starts on our exact clearances.

Not for: ours (`clearance.gains`).
"""

from __future__ import annotations

import time

import numpy as np
from gain_cases import Made

import clearance as cl
from clearance.gains.shift import base_shift, obstacle_shift

STARTS = 20

ENOUGH = 2e-7
"""[m] Below the limit by no more is kept, as for ours."""


def general_shift(one: Made, seconds: float) -> float | None:
    """[m] The least shift that it finds within so many seconds of CPU; None if none."""
    from scipy.optimize import minimize

    shift = (obstacle_shift if one.kind == "obstacle" else base_shift)(one.case, one.who)
    rng, ends, best = np.random.default_rng(0), time.process_time() + seconds, None

    def above(x: np.ndarray) -> float:
        run = cl.check(shift.case_of(x), certify=False, contact="none", need="minimum")
        return float(run.record.worst.clearance - one.case.limits.fail)

    for i in range(STARTS):
        if time.process_time() > ends:
            break
        start = np.zeros(3) if i == 0 else rng.normal(size=3) * one.known
        found = minimize(
            lambda x: float(x @ x), start, jac=lambda x: 2.0 * x, method="SLSQP",
            constraints=[{"type": "ineq", "fun": above}], options={"maxiter": 60, "ftol": 1e-12},
        )  # fmt: skip
        size = float(np.linalg.norm(found.x))
        if above(found.x) >= -ENOUGH and (best is None or size < best):
            best = size
    return best
