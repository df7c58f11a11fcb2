"""A case as it was commanded, where its robots have done something else. Not for: reading those (`formats`)."""

from __future__ import annotations

from dataclasses import replace

from clearance.world.case import Case, PlacedRobot


def commanded_case(case: Case) -> Case:
    """The case with what its robots were commanded in place of what was recorded, without tolerances."""
    return replace(case, robots=tuple(map(_commanded, case.robots)), tolerance=None)


def _commanded(placed: PlacedRobot) -> PlacedRobot:
    found = placed.recording
    if found is None:
        return placed
    return replace(placed, trajectory=found.commanded, timing=found.timing, recording=None)
