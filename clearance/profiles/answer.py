"""Answers a case's reserved outlines: does the sweep keep to each sketch, how close does it come, who and when.

The swept profile contains all that is swept, so that a gap to it is a gap to the motion itself; a sweep that is
beyond a sketch by less than the profile's bound is still called a violation. Not for: fitting, nor sizes of bodies
(`world.plausible_sizes`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from clearance.errors import at
from clearance.planar.curve import Curve
from clearance.planar.deviation import deviation
from clearance.planar.hausdorff import hausdorff
from clearance.profiles.gap import ClosedContours, proven_gap
from clearance.profiles.outline_file import DrawnOutline, require_closed
from clearance.profiles.picture import picture_bytes
from clearance.profiles.profile import MOVING, Profile
from clearance.profiles.region import contains
from clearance.profiles.sweep import swept_profile
from clearance.profiles.swept_bodies import TimedCase
from clearance.record.record import ProfileAnswer
from clearance.world.case import Case, ReservedSpace
from clearance.world.extents import metres, reach_of
from clearance.world.notice import IN_MILLIMETRES, Notice, Severity, units
from clearance.world.plausible_sizes import FAR, FAR_OFF, far_off_notice
from clearance.world.timeline import Timeline


class AnsweredProfile(NamedTuple):
    """The answer of a profile, what draws it as SVG, and what is odd about its sketch."""

    answer: ProfileAnswer
    picture: Callable[[], str]
    notices: tuple[Notice, ...]


def answer_profiles(case: Case, timeline: Timeline) -> tuple[AnsweredProfile, ...]:
    """One answer for each of the case's profiles, in their order.

    Raises:
        BadInput: not a plane, an open contour, contours that overlap; with the profile's name.
    """
    found = []
    for i, space in enumerate(case.profiles):
        with at(f"profiles[{i}] {space.name}"):
            swept = swept_profile(
                TimedCase(case, timeline),
                space.plane,
                links=space.links or None,
                section=space.section,
            )
            found.append(_answer(case, space, swept, timeline.path_error))
    return tuple(found)


def _answer(case: Case, space: ReservedSpace, swept: Profile, path_error: float) -> AnsweredProfile:
    """The answer; a gap is less by what paths may be off [m]."""
    curve = space.sketch.curves()
    require_closed(curve, "sketch")
    sketch, outline = ClosedContours.of_curve(curve), ClosedContours(swept.contours)
    if space.mode == "nearest":
        whole = hausdorff(curve, swept.curve)
        gap, ends = whole.distance, np.stack([whole.point_b, whole.point_a])
        passed, contained = gap + whole.error_bound + path_error <= space.limit, False
    else:
        sketch.require_apart("sketch")
        around = space.mode == "outside"
        gap, least = proven_gap(sketch, outline, around=around)
        gap -= path_error
        contained, ends = gap > 0.0, np.stack([least.point_b, least.point_a])
        passed = contained and gap >= space.limit
        if not contained:
            gap, ends = _beyond(sketch, swept, around, ends)
    link, step = _maker(swept, ends[0])
    answer = ProfileAnswer(
        name=space.name,
        plane=space.plane,
        section=space.section,
        mode=space.mode,
        limit=space.limit,
        passed=bool(passed),
        contained=bool(contained),
        gap=float(gap),
        bound=swept.bound,
        point_sweep=_pair(ends[0]),
        point_sketch=_pair(ends[1]),
        link=link,
        step=step,
        links=space.links,
        left_out=swept.left_out,
    )
    picture = partial(_picture, space, swept, DrawnOutline("sketch", curve), ends)
    odd = _notices_on_zone(case, space, curve, swept.curve, answer.gap)
    return AnsweredProfile(answer, picture, (*odd, *_uncounted(space, swept)))


def _uncounted(space: ReservedSpace, swept: Profile) -> Iterator[Notice]:
    """A warning on each thing that the sweep does not contain and that no other warning is on."""
    open_cuts = (f"{note}, without what it encloses" for note in swept.open_cuts)
    moving = (note for note in swept.left_out if note.startswith(MOVING))
    for note in (*open_cuts, *moving):
        yield Notice(Severity.WARNING, "profiles", f"profile {space.name!r}: {note}")


def _beyond(sketch: ClosedContours, swept: Profile, around: bool, ends: np.ndarray):
    """How far the swept outline is beyond the sketch, at the worst of many samples, negative; and where.

    Where the sketch, or a hole of it, lies wholly in the sweep, how far it is from the swept outline.
    """
    along = deviation(swept.curve, sketch.curve, samples=4000)
    wrong = contains(sketch.region, along.point) != around
    if not wrong.any():
        along = deviation(sketch.curve, swept.curve, samples=4000)
        within = contains(swept.region, along.point)
        if not within.any():
            return 0.0, ends
        worst = int(np.argmax(np.where(within, along.distance, -1.0)))
        return -float(along.distance[worst]), np.stack([along.foot[worst], along.point[worst]])
    worst = int(np.argmax(np.where(wrong, along.distance, -1.0)))
    return -float(along.distance[worst]), np.stack([along.point[worst], along.foot[worst]])


def _maker(swept: Profile, point: np.ndarray) -> tuple[str, int]:
    piece, _, _ = ClosedContours(swept.contours).pieces.feet(point[None])
    made = swept.maker(int(piece[0]))
    assert made is not None
    return made


def _picture(space: ReservedSpace, swept: Profile, sketch: DrawnOutline, ends: np.ndarray) -> str:
    drawn = DrawnOutline("swept", swept.curve, swept)
    title = f"{space.name}: {space.mode}, plane {space.plane}; in m"
    shade = ("only in the sketch", "only swept")
    return picture_bytes(drawn, sketch, ends, title, ".svg", shade=shade).decode()


def _pair(point: np.ndarray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _notices_on_zone(
    case: Case, space: ReservedSpace, sketch: Curve, swept: Curve, gap: float
) -> Iterator[Notice]:
    """Suspect input, or a warning, where a zone is far larger than what stays in it, or far from what stays out:
    reserved outlines that look like another unit.

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
    return units(f"{text} {metres(reach)} m; {IN_MILLIMETRES}")
