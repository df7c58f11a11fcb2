"""Reserved outlines of which it is open what they enclose."""

from __future__ import annotations

from dataclasses import replace

import pytest

import clearance as cl
from clearance.errors import BadShape
from clearance.planar.curve import Curve
from clearance.sketch import Sketch
from clearance.world.body import Body, Obstacle
from clearance.world.case import ReservedSpace
from tests.profiles.moving import slab, turning

POST = Obstacle(Body("post", slab([0.3, -0.5, 0.0], [0.4, -0.4, 0.1])))


def squares(*spans: tuple[float, float]) -> Sketch:
    """Squares from (low, low) to (high, high)."""
    sketch = Sketch()
    for low, high in spans:
        places = [(low, low), (high, low), (high, high), (low, high)]
        corners = [sketch.point(*place) for place in places]
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            sketch.segment(a, b)
    return sketch


def checked(mode: str, *spans: tuple[float, float], limit: float = 0.0):
    """An arm of 0.5 m that turns by 1 rad, and squares that it keeps to, or out of."""
    case = turning(slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1]), [0.0, 0.5, 1.0])
    space = ReservedSpace("zone", squares(*spans), mode=mode, limit=limit)
    return cl.check(replace(case, obstacles=(POST,), profiles=(space,)))


OVERLAPPING = (-0.7, 0.8), (-0.8, 0.7)


def test_a_robot_in_the_overlap_of_two_zones_that_it_keeps_out_of_is_not_clear():
    with pytest.raises(BadShape, match=r"profiles\[0\] zone: sketch: contours 1 and 2 overlap"):
        checked("inside", *OVERLAPPING)


def test_a_zone_with_a_hole_is_what_the_guide_says():
    assert checked("inside", (-2.0, 2.0), (-0.8, 0.8)).passed
    assert not checked("inside", (-2.0, 2.0)).passed


def test_outlines_that_only_have_to_be_near_may_cross():
    assert checked("nearest", *OVERLAPPING, limit=0.5).record.profiles[0].gap > 0.0


def test_a_fit_beside_outlines_that_overlap_is_refused():
    two = Curve.contours(
        [Curve.polyline([[a, a], [b, a], [b, b], [a, b]], closed=True) for a, b in OVERLAPPING]
    )
    sketch = cl.Sketch()
    center = sketch.point(0.0, 0.0)
    circle = sketch.circle(center, 0.1)
    sketch.radius(circle, name="r", driven=True)
    for mode in ("inside", "outside"):
        with pytest.raises(BadShape, match="outline: contours 1 and 2 overlap"):
            cl.fit(sketch, two, mode)
