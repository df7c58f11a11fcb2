"""The drawing of a sketch: its segments, arcs and circles as one planar curve."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from clearance.errors import BadShape
from clearance.sketch.entities import Arc, Circle, Point, Segment

if TYPE_CHECKING:
    from clearance.planar.curve import Curve


def curve_of(sketch) -> Curve:
    """The drawn parts as contours: segments and arcs that share ends are chained, circles stand
    alone.

    Raises:
        BadShape: nothing is drawn (infinite lines and points draw nothing).
    """
    from clearance.planar.curve import Curve

    entities = list(sketch.entities.values())
    parts = [e for e in entities if isinstance(e, (Segment, Arc))]
    contours = [
        Curve.chain([_piece(e, back) for e, back in chain]) for chain in chains(sketch, parts)
    ]
    for e in entities:
        if type(e) is Circle:
            contours.append(Curve.circle(e.center.position, e.radius))
    if not contours:
        raise BadShape("the sketch draws nothing", valid="a segment, an arc or a circle")
    return contours[0] if len(contours) == 1 else Curve.contours(contours)


def chains(sketch, parts: list) -> list[list[tuple[object, bool]]]:
    """The parts (with True where they run backwards) joined at ends that only two of them share."""
    alias = sketch._engine().current().alias
    at: dict[int, list[int]] = {}
    for k, e in enumerate(parts):
        for p in ends_of(e):
            at.setdefault(int(alias[p.variable]), []).append(k)
    unused, out = set(range(len(parts))), []
    for first in sorted(
        unused,
        key=lambda k: (min(len(at[int(alias[p.variable])]) == 2 for p in ends_of(parts[k])), k),
    ):
        if first in unused:
            out.append(_chain(parts, first, unused, at, alias))
    return out


def _chain(parts, first: int, unused: set[int], at: dict[int, list[int]], alias) -> list:
    unused.discard(first)
    start, end = (int(alias[p.variable]) for p in ends_of(parts[first]))
    back = len(at[start]) == 2 and len(at[end]) != 2
    chain, tip = [(parts[first], back)], start if back else end
    while len(at[tip]) == 2:
        following = [k for k in at[tip] if k in unused]
        if not following:
            break
        k = following[0]
        unused.discard(k)
        a, b = (int(alias[p.variable]) for p in ends_of(parts[k]))
        chain.append((parts[k], a != tip))
        tip = b if a == tip else a
    return chain


def ends_of(e) -> tuple[Point, Point]:
    """The two end points of a segment or arc."""
    return (e.start, e.end) if isinstance(e, Arc) else e.ends


def _piece(e, back: bool):
    from clearance.planar.curve import Curve

    a, b = (p.position for p in ends_of(e))
    if isinstance(e, Segment):
        return Curve.line(b, a) if back else Curve.line(a, b)
    start, end = angles_of(e)
    return Curve.arc(e.center.position, e.radius, *((end, start) if back else (start, end)))


def angles_of(arc: Arc) -> tuple[float, float]:
    """[rad] where an arc starts and ends; the end is above the start."""
    c, a, b = arc.center.position, arc.start.position, arc.end.position
    start = math.atan2(a[1] - c[1], a[0] - c[0])
    end = math.atan2(b[1] - c[1], b[0] - c[0])
    return start, end if end > start else end + 2.0 * math.pi
