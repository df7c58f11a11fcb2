"""A case as it was asked, where its robots have done something else. Not for: reading recordings (`load`)."""

from __future__ import annotations

from dataclasses import replace

from clearance.world.case import Case, PlacedRobot


def as_asked(case: Case) -> Case:
    """The case with what its robots were asked in place of what was recorded, without tolerances."""
    return replace(case, robots=tuple(map(_asked, case.robots)), tolerance=None)


def _asked(placed: PlacedRobot) -> PlacedRobot:
    found = placed.recording
    if found is None:
        return placed
    return replace(placed, trajectory=found.asked, timing=found.timing, recording=None)
