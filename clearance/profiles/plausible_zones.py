"""Reserved outlines that look like another unit: compared with how far the robots of the case reach.

Not for: whether an outline is kept (`answer`), nor sizes of bodies (`world.plausible_sizes`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.planar.curve import Curve
from clearance.world.case import Case, ReservedSpace
from clearance.world.extents import metres, reach_of
from clearance.world.notice import Notice, Severity
from clearance.world.plausible_sizes import FAR, FAR_OFF, far_off_notice


def notices_on_zone(
    case: Case, space: ReservedSpace, sketch: Curve, swept: Curve, gap: float
) -> Iterator[Notice]:
    """Suspect input, or a warning, where a zone is far larger than what stays in it, or far from what stays out.

    Args:
        gap: [m] between sketch and sweep, negative where it is not kept.
    """
    reach = max(map(reach_of, case.robots))
    zone = f"the sketch of profile {space.name!r}"
    if space.mode == "outside":
        length, largest = _length(sketch), FAR * max(1.0, reach, _length(swept))
        if length > largest:
            yield _suspect(f"{zone} is {metres(length)} m long where the robot reaches", reach)
    elif space.mode == "inside" and gap > FAR * max(1.0, reach):
        yield _suspect(f"{zone} stays {metres(gap)} m away from a robot that reaches", reach)
    elif space.mode == "inside" and gap > FAR_OFF * reach:
        text = f"{zone} stays {metres(gap)} m away from all that the robot sweeps"
        yield far_off_notice(text, gap / reach)


def _length(curve: Curve) -> float:
    return float(np.ptp(curve.box, axis=0).max())


def _suspect(text: str, reach: float) -> Notice:
    asks = "lengths are in metres, is this millimetres?"
    return Notice(Severity.SUSPECT, "units", f"CHECK UNITS: {text} {metres(reach)} m; {asks}")
