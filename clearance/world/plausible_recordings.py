"""Notices on holes in recordings: suspect until the case says how joints move there; named where not measured."""

from __future__ import annotations

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import GAPS, HOLD, LINEAR, NOT_MEASURED, Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import Timing
from clearance.world.trajectory import Hole

_MEANING = {
    None: (
        "the recording{whose} has a hole, bridged by a straight line: {holes}; say how joints move in "
        f"it with gaps: {' | '.join(GAPS)} beside the file (--recorded-gaps)"
    ),
    HOLD: "assumed{whose}: joints stay until one usual interval before their next message (gaps: hold); {holes}",
    LINEAR: "assumed{whose}: joints go straight from message to message (gaps: linear); {holes}",
    NOT_MEASURED: "not measured{whose}: {holes}",
}


def notices_on_holes(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """Notices on the holes in a robot's recording: one for each value of `gaps`, the longest hole first.

    Args:
        before: what stands before the names of joints.
    """
    about, found = placed.robot.name, []
    for means, text in _MEANING.items():
        holes = [hole for hole in placed.given_trajectory.holes if hole.means == means]
        if holes:
            holes.sort(key=lambda hole: hole.start - hole.end)
            holes_text = listed([hole.text for hole in holes], 1)
            text = text.format(whose=f" of robot {about!r}" if before else "", holes=holes_text)
            severity = Severity.SUSPECT if means is None else Severity.WARNING
            found.append(Notice(severity, "gaps", text, about))
    return found


def not_measured(case: Case) -> list[tuple[float, float]]:
    """The stretches of a run [s] in which some robot is not measured, in order of time, each once."""
    spans = {
        _span(hole, placed.timing)
        for placed in case.robots
        if placed.trajectory is not None
        for hole in placed.trajectory.holes
        if hole.means == NOT_MEASURED
    }
    return sorted(spans)


def _span(hole: Hole, timing: Timing) -> tuple[float, float]:
    start, end = timing.run_times(np.array([hole.start, hole.end])).tolist()
    return start, end


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
