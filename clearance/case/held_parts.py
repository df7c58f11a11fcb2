"""What a scene file says a robot holds, as parts that are carried from the begin of the run to its end.

Not for: reading it (`planning_scene`), nor where the parts are: they ride on the link that holds them.
"""

from __future__ import annotations

from dataclasses import replace

from clearance.case.allow import body_names
from clearance.formats.scene.request import SceneContent
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.notice import listed
from clearance.world.rules import matches
from clearance.world.timeline import timeline_of
from clearance.world.timing import Window


def with_held_parts(case: Case, content: SceneContent) -> tuple[Case, list[str]]:
    """The case in which the parts that its scene file attaches to links are carried by them, and notes.

    A part that the case says something of is left to it.
    """
    own = {carry.part for carry in case.carries}
    held = [one for one in content.held if one.part not in own]
    if not held:
        return case, []
    names = body_names(case)
    known = (*names.links, *names.obstacles)
    motions = [kinematic_motion(placed) for placed in case.robots]
    start = float(timeline_of(case, motions).times[0])
    carries, unknown = [], dict[str, None]()
    for one in held:
        there = [name for name in one.touch if any(matches(body, name) for body in known)]
        unknown |= dict.fromkeys(name for name in one.touch if name not in there)
        carries.append(Carry(one.part, one.link, Window(start), tuple(there)))
    told = ", ".join(f"{one.part} by {one.link}" for one in held[:6])
    more = f" and {len(held) - 6} more" if len(held) > 6 else ""
    notes = [f"attached objects of the scene's file are carried all the time: {told}{more}"]
    if unknown:
        notes.append(f"touch_links that are not there are left out: {listed([*unknown], 6)}")
    return replace(case, carries=(*case.carries, *carries)), notes
