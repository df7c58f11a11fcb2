"""The joints that bring a tool to given poses, by damped least squares from where they are.

Sources: Wampler 1986 (damped least squares); Sugihara 2011 (damping by the square of what is left). Not for: which
poses are wanted (`tool_path`).
"""

from __future__ import annotations

import numpy as np

from clearance.gains.tool import Tool, apart

MOST_STEPS = 60

REACHED = 1e-9
"""[m] and [rad]: a pose that is this near is reached."""

DAMPING = 1e-12
"""[-] Of what is linear, and the least of any step."""


def joints_for(tool: Tool, wanted: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, float]:
    """(n, k) joints that bring the tool to each pose (n, 4, 4), seen from the root, and what is left at worst.

    Args:
        start: (n, k) [rad or m] where the joints are. Of several solutions the one that steps of least length
            lead to.
    """
    at = start.copy()
    for _ in range(MOST_STEPS):
        poses, rates = tool.poses_and_rates(at)
        off = apart(wanted, poses)
        left = np.abs(off).max(axis=1)
        if left.max() <= REACHED:
            break
        damping = DAMPING + (off**2).sum(axis=1)
        at = at + least_squares(rates, off[:, :, None], damping)[:, :, 0]
    return at, float(left.max())


def least_squares(
    rates: np.ndarray, aims: np.ndarray, damping: np.ndarray | float = DAMPING
) -> np.ndarray:
    """(n, k, m) of least length that (n, 6, k) rates make the aims (n, 6, m) of, but for the damping."""
    turned = np.swapaxes(rates, 1, 2)
    n_joints = rates.shape[2]
    level = np.broadcast_to(damping, len(rates))[:, None, None]
    if n_joints < 6:
        return np.linalg.solve(turned @ rates + level * np.eye(n_joints), turned @ aims)
    return np.asarray(turned @ np.linalg.solve(rates @ turned + level * np.eye(6), aims))
