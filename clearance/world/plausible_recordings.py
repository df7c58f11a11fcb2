"""Notices on holes in recordings, suspect until the case says how joints move there, and on unproven motion.

Unproven are stretches of a program on which joints are where it says at the samples, and perhaps not between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import GAPS, HOLD, LINEAR, NOT_MEASURED, Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import Window
from clearance.world.trajectory import Trajectory, UnprovenSpan

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


def notices_on_unproven(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """A notice on all stretches of a robot that are not proven between the samples, if there are some.

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


def not_measured(case: Case) -> list[tuple[float, float]]:
    """The stretches of a run [s] in which some robot is not measured, in order of time, each once."""
    return sorted({*_stretches(case, lambda asked: asked.not_measured)})


def not_proven(case: Case) -> list[tuple[float, float]]:
    """The stretches of a run [s] that are not proven between the samples, in order of time."""
    return sorted(_stretches(case, lambda asked: asked.unproven))


def _stretches(
    case: Case, of: Callable[[Trajectory], Sequence[Window | UnprovenSpan]]
) -> Iterator[tuple[float, float]]:
    """[s] The times of a run at which stretches of the tables of robots begin and end."""
    for placed in case.robots:
        for one in of(placed.trajectory) if placed.trajectory is not None else ():
            start, end = placed.timing.run_times(np.array([one.start, one.end])).tolist()
            yield start, end
