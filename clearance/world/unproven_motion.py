"""Stretches of a program on which joints are measured at the samples, and not proven between them.

Not for: why (room `programs`).
"""

from __future__ import annotations

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot


def notices_on_unproven(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """A notice on all such stretches of a robot, if there are some.

    Args:
        before: what stands before the names of joints.
    """
    about, spans = placed.robot.name, placed.given_trajectory.unproven
    if not spans:
        return []
    whose = f" of robot {about!r}" if before else ""
    stretches = listed([f"{one.move}, {one.start:.3f}-{one.end:.3f} s: {one.why}" for one in spans])
    text = f"measured at the samples and not proven{whose}: {stretches}"
    return [Notice(Severity.UNPROVEN, "unproven motion", text, about)]


def not_proven(case: Case) -> list[tuple[float, float]]:
    """Those stretches of a run [s], in order of time."""
    return sorted(
        (float(start), float(end))
        for placed in case.robots
        if placed.trajectory is not None
        for one in placed.trajectory.unproven
        for start, end in [placed.timing.run_times(np.array([one.start, one.end]))]
    )
