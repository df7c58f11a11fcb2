"""Fitted sketches: known answers, proven containment, refusals."""

import math
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadShape
from clearance.profiles.contour import Contour
from clearance.profiles.fit import NoFit
from clearance.profiles.fit_shape import NoFreeDimension, SketchShape
from clearance.profiles.gap import ClosedContours
from clearance.profiles.outline_file import read_outline
from clearance.profiles.profile import Profile
from tests.oracle.outlines import inside
from tests.profiles.moving import rows, slab, turning

SKETCHES = Path(__file__).parents[2] / "scenes" / "sketches"


SQUARE = cl.Curve.polyline([[0, 0], [1, 0], [1, 1], [0, 1]], closed=True)


def rectangle(width, depth, *, driven=("width", "depth"), fixed=False):
    """A rectangle with its lower left corner at the origin."""
    s = cl.Sketch()
    p = [
        s.point(x, y, name=f"p{i}")
        for i, (x, y) in enumerate([(0, 0), (width, 0), (width, depth), (0, depth)])
    ]
    sides = [s.segment(p[i], p[(i + 1) % 4], name=f"s{i}") for i in range(4)]
    for i in (0, 2):
        s.horizontal(sides[i])
        s.vertical(sides[i + 1])
    s.distance(p[0], p[1], width, name="width", driven="width" in driven)
    s.distance(p[1], p[2], depth, name="depth", driven="depth" in driven)
    if fixed:
        s.fix(p[0])
    return s


def contours_of_shape(found):
    """A fitted sketch as the oracle takes it."""
    shape = SketchShape(found.sketch, list(found.dimensions))
    placed = shape.at(shape.start)
    return [np.column_stack([c.vertices, c.bulges]).tolist() for c in placed.contours]


@pytest.mark.parametrize("name", ["keep_in_zone", "d_cell", "port_bar"])
def test_an_outline_made_from_a_sketch_gives_its_dimensions_back(name):
    sketch = cl.Sketch.load(SKETCHES / f"{name}.yaml")
    shape = SketchShape(sketch, None)
    n = len(shape.free)
    wanted = shape.start.copy()
    wanted[:n] *= np.linspace(1.21, 0.83, n)
    wanted[n:] += [0.13, -0.07, 0.4][: len(wanted) - n]
    found = cl.fit(sketch, shape.at(wanted).curve, "nearest")
    assert list(found.dimensions.values()) == pytest.approx(wanted[:n].tolist(), abs=1e-9)
    assert found.distance.distance + found.distance.error_bound <= 1e-9
    again = found.sketch.solve()
    assert again.solved and again.movement <= 1e-9
    assert cl.hausdorff(found.sketch.curves(), found.curve).distance <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(
    "drawn", [(0.25, 0.15, 0.0), (1.0, 0.1, 0.0), (1.0, 1.0, 5.0), (2.0, 1.3, -1.0)]
)
def test_the_least_rectangle_about_a_rectangle_is_that_rectangle(drawn):
    """An edge that lies along the outline's shrinks past its corner, from every start that leads anywhere."""
    outline = cl.Curve.polyline([[0, 0], [0.1, 0], [0.1, 0.05], [0, 0.05]], closed=True)
    width, depth, at = drawn
    found = cl.fit(moved_rectangle(width, depth, at), outline, "outside", starts=4)
    assert list(found.dimensions.values()) == pytest.approx([0.1, 0.05], rel=1e-6)
    assert found.area == pytest.approx(0.005, rel=1e-6) and found.clearance > 0.0
    assert 2 * found.n_agreeing > found.n_starts


@pytest.mark.slow
def test_a_rectangle_drawn_small_in_a_hole_grows_to_its_margin():
    hole = [[0.02, 0.01], [0.12, 0.01], [0.12, 0.06], [0.02, 0.06]]
    frame = [[-0.1, -0.1], [0.2, -0.1], [0.2, 0.15], [-0.1, 0.15]]
    outline = cl.Curve.contours([cl.Curve.polyline(one, closed=True) for one in (frame, hole)])
    found = cl.fit(moved_rectangle(0.001, 0.001, 0.03), outline, "inside", margin=0.005, starts=3)
    assert found.area == pytest.approx(0.09 * 0.04, rel=1e-6) and found.clearance >= 0.005
    assert found.n_agreeing == found.n_starts


def moved_rectangle(width, depth, at):
    s = rectangle(width, depth)
    shape = SketchShape(s, None)
    shape.start[2:] += at
    return shape.placed_sketch(shape.start, s)


@pytest.mark.slow
def test_the_least_rectangle_about_a_turned_ellipse_like_outline_touches_four_sides():
    outline = cl.Curve.polyline(
        [
            [0.9 * math.cos(t) + 0.2, 0.4 * math.sin(t) - 0.1]
            for t in np.linspace(0, 2 * math.pi, 60)[:-1]
        ],
        closed=True,
    )
    found = cl.fit(rectangle(1.0, 1.0), outline, "outside", margin=0.05, starts=3)
    low, high = outline.box
    wide, deep = high - low + 0.1
    assert found.dimensions["width"] == pytest.approx(wide, abs=2e-8)
    assert found.dimensions["depth"] == pytest.approx(deep, abs=2e-8)
    assert found.area == pytest.approx(wide * deep, abs=1e-7)
    assert 0.05 <= found.clearance <= 0.05 + 1e-7
    assert found.sensitivity["width"][1] == pytest.approx(
        -1.0, abs=1e-6
    )  # smaller: it touches at once


@pytest.mark.slow
def test_an_outline_of_many_corners_is_contained_by_its_farthest_ones():
    """Of 5000 noisy corners a part is looked at first; those that stuck out were never seen."""
    turn = np.linspace(0.0, 2.0 * math.pi, 5001)[:-1]
    noise = np.random.default_rng(0).normal(size=(5000, 2)) * 5e-5
    outline = np.column_stack([0.3 * np.cos(turn), 0.2 * np.sin(turn)]) + noise
    curve = cl.Curve.polyline(outline, closed=True)
    found = cl.fit(rectangle(1.0, 1.0), curve, "outside", starts=1)
    wide, deep = np.ptp(outline, axis=0)
    assert found.dimensions["width"] == pytest.approx(wide, abs=1e-7)
    assert found.dimensions["depth"] == pytest.approx(deep, abs=1e-7)
    assert found.clearance > 0.0


@pytest.mark.slow
def test_the_largest_bar_in_a_round_port_has_its_corners_on_the_rim():
    radius, height, margin = 0.17, 0.10, 0.004
    port = cl.Curve.circle([0.02, 0.76], radius)
    found = cl.fit(
        cl.Sketch.load(SKETCHES / "port_bar.yaml"), port, "inside", margin=margin, starts=3
    )
    width = 2 * math.sqrt((radius - margin) ** 2 - height**2 / 4)
    assert found.dimensions["width"] == pytest.approx(width, abs=1e-7)
    assert found.clearance >= margin
    # d(width)/d(height) at the optimum; the area also grows by the height itself.
    slope = width - height * height / width
    assert found.active["height"] == pytest.approx(-slope, rel=1e-3)  # minus: more area is better


def test_nearest_is_the_middle_between_two_circles():
    """A circle of free radius between two concentric ones is nearest half-way."""
    s = cl.Sketch()
    centre = s.point(0, 0)
    s.fix(centre)
    s.radius(s.circle(centre, 0.5), 0.5, name="r", driven=True)
    rings = cl.Curve.contours([cl.Curve.circle([0, 0], 1.0), cl.Curve.circle([0, 0], 0.6)])
    found = cl.fit(s, rings, "nearest")
    assert found.dimensions["r"] == pytest.approx(0.8, abs=1e-9)
    assert found.distance.distance == pytest.approx(0.2, abs=1e-9)


@pytest.mark.slow
def test_a_zone_about_a_sweep_contains_it_by_the_oracle():
    profile = cl.swept_profile(turning(slab([0.2, -0.05, 0], [1.0, 0.05, 0.1]), [0, 0.7, 1.3]))
    found = cl.fit(
        cl.Sketch.load(SKETCHES / "keep_in_zone.yaml"), profile, "outside", margin=0.01, starts=1
    )
    zone = contours_of_shape(found)
    outline = np.concatenate([c.flattened(1e-4) for c in profile.contours])
    assert all(inside(point, zone) for point in outline[:: max(1, len(outline) // 60)])
    swept = rows(profile)
    assert not any(inside(row[:2], swept) for contour in zone for row in contour)
    assert found.clearance >= 0.01
    assert cl.minimum_distance(found.sketch.curves(), profile.curve).distance >= 0.01 - 1e-9


def contradictory():
    s = rectangle(1.0, 0.5, driven=("depth",))
    s.distance(s.entity("p3"), s.entity("p2"), 1.2, name="other_width")
    return s


@pytest.mark.parametrize(
    ("sketch", "outline", "options", "fault", "said"),
    [
        (lambda: rectangle(1, 1, driven=()), SQUARE, {}, NoFreeDimension, "no free dimension"),
        (contradictory, SQUARE, {}, BadShape, "no place found where"),
        (
            lambda: rectangle(1, 1),
            cl.Curve.polyline([[0, 0], [1, 0], [1, 1]]),
            {},
            BadShape,
            "is open",
        ),
        (lambda: rectangle(1, 1), SQUARE, {"free": ["w"]}, BadInput, "no dimension named 'w'"),
        (lambda: rectangle(1, 1), SQUARE, {"mode": "around"}, BadInput, "unknown mode 'around'"),
        (
            lambda: rectangle(0.1, 0.1, driven=("width",), fixed=True),
            SQUARE,
            {"mode": "outside", "starts": 2},
            NoFit,
            "contains the outline",
        ),
    ],
)
def test_refusals_of_fit_are_one_line(sketch, outline, options, fault, said):
    with pytest.raises(fault) as caught:
        cl.fit(sketch(), outline, **options)
    assert said in str(caught.value)


def test_a_sketch_can_be_compared_as_it_is():
    drawn = read_outline(SKETCHES / "d_cell.yaml")
    assert drawn.curve.is_closed and drawn.profile is None


@pytest.mark.slow
def test_a_sketch_beside_the_outline_that_nothing_holds_is_refused():
    with pytest.raises(NoFit, match="grows beside the outline without end"):
        cl.fit(
            rectangle(1.0, 1.0),
            Profile((Contour(np.array([[5, 5], [6, 5], [6, 6]]), np.zeros(3)),)),
            "inside",
            starts=2,
        )


@pytest.mark.slow
def test_a_dimension_that_would_vanish_does_not_stop_the_others():
    """A step that the outline does not have shrinks to nothing, and the rest is found all the same."""
    s = rectangle(1.0, 0.8)
    s.distance(s.entity("p0"), s.entity("p2"), driven=True, name="diagonal")
    outline = cl.Curve.polyline([[0, 0], [2, 0], [2, 1e-9], [0, 1e-9]], closed=True)
    found = cl.fit(s, outline, "nearest", free=["width", "depth"])
    assert found.dimensions["width"] == pytest.approx(2.0, abs=1e-5)
    assert 0.0 < found.dimensions["depth"] <= 3e-6


@pytest.mark.slow
def test_a_sketch_far_smaller_than_the_outline_about_it_grows_to_fill_it():
    """The price of leaving the outline is above what area is worth there, not where the sketch was drawn."""
    outline = cl.Curve.polyline([[-0.7, -0.4], [0.3, -0.4], [0.3, 0.6], [-0.7, 0.6]], closed=True)
    found = cl.fit(rectangle(0.1, 0.1), outline, "inside", margin=0.005, starts=3)
    assert found.dimensions == pytest.approx({"width": 0.99, "depth": 0.99}, abs=1e-6)
    assert found.clearance >= 0.005


TWELVE_CORNERS = cl.Curve.polyline(
    [
        [0.591, 0.050], [0.025, 0.285], [-0.213, 0.803], [-0.542, 0.082], [-1.110, 0.019], [-0.589, -0.300],
        [-0.538, -0.555], [-0.479, -0.541], [0.126, -0.773], [0.082, -0.359], [0.218, -0.434], [0.028, -0.227],
    ],
    closed=True,
)  # fmt: skip
TWELVE_CORNERS_AREA = 0.939


def corner_of_six(corners=((0, 0), (1, 0), (1, 0.4), (0.5, 0.4), (0.5, 1), (0, 1))):
    """An L of level and upright sides; the lengths of four are free."""
    s = cl.Sketch()
    points = [s.point(*corner) for corner in corners]
    sides = [s.segment(points[i], points[(i + 1) % 6]) for i in range(6)]
    for i, side in enumerate(sides):
        (s.vertical if i % 2 else s.horizontal)(side)
    for i in range(4):
        s.distance(points[i], points[i + 1], math.dist(corners[i], corners[i + 1]), driven=True)
    return s


@pytest.mark.slow
def test_a_fit_does_not_cross_itself_so_that_its_lobes_cancel_each_other():
    found = cl.fit(corner_of_six(), TWELVE_CORNERS, "outside", margin=0.0152, starts=3)
    assert found.area > TWELVE_CORNERS_AREA
    assert not ClosedContours.of_curve(found.curve).crosses_itself


@pytest.mark.parametrize("mode", ["nearest", "outside"])
def test_a_sketch_that_crosses_itself_as_drawn_is_not_fitted(mode):
    crossed = corner_of_six(((0, 0), (1, 0), (1, 0.4), (-0.5, 0.4), (-0.5, 1), (0, 1)))
    with pytest.raises(BadShape, match="sketch: the sketch crosses itself"):
        cl.fit(crossed, TWELVE_CORNERS, mode)
