"""How a clearance stands against its limits: of a step, and of the motion to the next."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from clearance.record.measurement import Measurement
from clearance.world.case import Limits


class Status(StrEnum):
    """How a step stands against the limits, worst last."""

    CLEAR = "clear"
    NEAR = "near"
    VIOLATED = "violated"
    CONTACT = "contact"


STATUSES = tuple(Status)


def status_codes(
    clearance: np.ndarray, limits: Limits, touching: np.ndarray | bool | None = None
) -> np.ndarray:
    """(n,) indices into `STATUSES`: contact, violated below `fail`, near below `warn`; 0 where unknown.

    Args:
        touching: (n,) where bodies touch, if padding has lessened clearances; at 0 and below without it. What
            padding alone brings to 0 is violated.
    """
    is_contact = clearance <= 0.0 if touching is None else touching
    is_violated = limits.below(clearance, limits.fail) | (clearance <= 0.0)
    is_near = limits.below(clearance, limits.warn)
    return np.select([is_contact, is_violated, is_near], [3, 2, 1], default=0)


def status_of(clearance: float, limits: Limits, touches: bool | None = None) -> str:
    """How one clearance [m] stands against the limits."""
    if touches or (touches is None and clearance <= 0.0):
        return str(Status.CONTACT)
    if limits.below(clearance, limits.fail) or clearance <= 0.0:
        return str(Status.VIOLATED)
    return str(Status.NEAR if limits.below(clearance, limits.warn) else Status.CLEAR)


def sample_codes(found: Measurement, limits: Limits, steps: slice | np.ndarray) -> np.ndarray:
    """(k,) the status of each of `steps` by itself; -1 where its bound does not decide."""
    lower = found.lower_bound[steps]
    undecided = (found.pair[steps] < 0) & (limits.below(lower, limits.warn) | (lower <= 0.0))
    touching = None if found.touching is None else found.touching[steps]
    return np.where(undecided, -1, status_codes(found.clearance[steps], limits, touching))
