"""DXF files: the header's unit is obeyed, and whatever is wrong in them ends with a message."""

import math

import ezdxf
import numpy as np
import pytest

from clearance.errors import BadSyntax, ClearanceError, MissingFile
from clearance.planar.curve import Curve
from clearance.planar.dxf import read_drawing, read_dxf
from clearance.planar.entries import BadCurve
from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import minimum_distance


def drawing(tmp_path, unit, draw=lambda space: space.add_line((0, 0), (2, 1))):
    made = ezdxf.new()
    made.header["$INSUNITS"] = unit
    draw(made.modelspace())
    made.saveas(tmp_path / "d.dxf")
    return str(tmp_path / "d.dxf")


@pytest.mark.parametrize(
    ("unit", "metres"), [(0, 1.0), (6, 1.0), (4, 1e-3), (1, 0.0254), (5, 0.01), (22, 0.0254000508)]
)
def test_the_unit_of_the_header_is_obeyed(tmp_path, unit, metres):
    curve = read_dxf(drawing(tmp_path, unit))
    assert curve.box == pytest.approx(np.array([[0, 0], [2 * metres, metres]]))


def test_an_unknown_unit_is_refused(tmp_path):
    with pytest.raises(BadSyntax, match=r"d\.dxf: \$INSUNITS is 77; 0 to 16, 21 to 24"):
        read_dxf(drawing(tmp_path, 77))


def test_a_missing_drawing_is_named():
    with pytest.raises(MissingFile, match=r"nowhere\.dxf: no such file"):
        read_dxf("nowhere.dxf")


@pytest.mark.parametrize("start", [1e18, -1e18, 1e300])
def test_arcs_from_angles_of_many_turns_end_with_a_message(tmp_path, start):
    path = drawing(tmp_path, 6, lambda space: space.add_arc((0, 0), 1, start, 10))
    with pytest.raises(ClearanceError, match="degrees; -360 to 360"):
        read_dxf(path)


def test_arcs_from_angles_of_a_few_turns_are_read(tmp_path):
    path = drawing(tmp_path, 6, lambda space: space.add_arc((0, 0), 1, 720, 90))
    assert read_dxf(path).box == pytest.approx(np.array([[0, 0], [1, 1]]), abs=1e-12)


def test_dxf_entities_become_one_curve(tmp_path):
    made = ezdxf.new()
    space = made.modelspace()
    space.add_line((0, 0), (2, 0))
    space.add_arc((2, 1), 1, -90, 0)
    space.add_circle((10, 0), 2)
    space.add_lwpolyline([(0, 5, 1.0), (2, 5, 0.0)], format="xyb")
    space.add_open_spline([(0, 9), (1, 11), (2, 8), (3, 9)])
    made.saveas(tmp_path / "part.dxf")
    curve = read_dxf(str(tmp_path / "part.dxf"))
    known = Curve.contours(
        [
            Curve.chain([Curve.line([0, 0], [2, 0]), Curve.arc([2, 1], 1, -math.pi / 2, 0)]),
            Curve.circle([10, 0], 2),
            Curve.arc([1, 5], 1, math.pi, 2 * math.pi),
            Curve.bspline([[0, 9], [1, 11], [2, 8], [3, 9]]),
        ]
    )
    assert hausdorff(curve, known).distance <= 1e-14 * known.size
    assert curve.contour.max() == 3
    space.add_text("no curve")
    made.saveas(tmp_path / "text.dxf")
    with pytest.raises(ClearanceError, match="an entity TEXT"):
        read_dxf(str(tmp_path / "text.dxf"))
    (tmp_path / "bad.dxf").write_text("hello")
    with pytest.raises(ClearanceError, match=r"bad\.dxf: not a DXF"):
        read_dxf(str(tmp_path / "bad.dxf"))


def test_dxf_bulges_old_polylines_weights_and_refusals(tmp_path):
    made = ezdxf.new()
    space = made.modelspace()
    space.add_lwpolyline(
        [(0, 0, 1.0), (2, 0, 0.0), (2, 3, 0.0), (0, 3, -0.5)], format="xyb", close=True
    )
    space.add_polyline2d([(5, 0, 0.4), (6, 1, 0), (7, 0, 0)], format="xyb", close=True)
    space.add_arc((10, 0), 2, 350, 20)  # through the angle 0
    space.add_rational_spline([(0, 9), (1, 11), (2, 8), (3, 9)], [1, 2, 0.5, 1])
    made.saveas(tmp_path / "part.dxf")
    curve = read_dxf(str(tmp_path / "part.dxf"))
    assert curve.contour.max() == 3 and curve.is_closed is False
    half = Curve.arc(
        [1, 0], 1, math.pi, 2 * math.pi
    )  # a bulge of 1 is a half turn, to the right of the chord
    gap = minimum_distance(half, curve)
    assert gap.distance <= 1e-15 and hausdorff(half, curve).directed["a_to_b"].distance <= 1e-14
    arc = Curve.arc([10, 0], 2, math.radians(-10), math.radians(20))
    assert hausdorff(arc, curve).directed["a_to_b"].distance <= 1e-14
    spline = Curve.bspline([[0, 9], [1, 11], [2, 8], [3, 9]], weights=[1, 2, 0.5, 1])
    assert hausdorff(spline, curve).directed["a_to_b"].distance <= 1e-14
    for add, said in [
        (
            lambda: space.add_spline(fit_points=[(0, 9), (1, 10), (3, 9)]),
            "a spline of fit points alone",
        ),
        (lambda: space.add_ellipse((0, 0), (3, 0), 0.5), "an entity ELLIPSE"),
        (
            lambda: space.add_circle((0, 0), 1, dxfattribs={"extrusion": (0, 1, 0)}),
            "extrusion (0.0, 1.0, 0.0)",
        ),
        (lambda: space.add_line((1, 1), (1, 1)), "a curve of zero length"),
    ]:
        entity = add()
        made.saveas(tmp_path / "bad.dxf")
        with pytest.raises(ClearanceError) as caught:
            read_dxf(str(tmp_path / "bad.dxf"))
        assert said in str(caught.value) and "bad.dxf" in str(caught.value)
        space.delete_entity(entity)


@pytest.mark.parametrize(
    ("draw", "said"),
    [
        (lambda space: space.add_line((0, 0, 0), (500, 0, 300)), "z is 300 in LINE"),
        (lambda space: space.add_circle((0, 0, 5), 1), "z is 5 in CIRCLE"),
        (lambda space: space.add_arc((0, 0, 5), 1, 0, 90), "z is 5 in ARC"),
        (
            lambda space: space.add_lwpolyline([(0, 0), (1, 0)], dxfattribs={"elevation": 5}),
            "z is 5 in LWPOLYLINE",
        ),
        (
            lambda space: space.add_polyline2d([(0, 0), (1, 0)], dxfattribs={"elevation": (0, 0, 5)}),
            "z is 5 in POLYLINE",
        ),
        (
            lambda space: space.add_open_spline([(0, 9, 0), (1, 11, 5), (2, 8, 0), (3, 9, 0)]),
            "z is 5 in SPLINE",
        ),
    ],
)  # fmt: skip
def test_a_drawing_that_does_not_lie_in_one_plane_is_refused(tmp_path, draw, said):
    """A side view in the plane y = 0 would lose its heights: two that differ there alone would be equal."""

    def both(space):
        space.add_line((0, 0, 0), (2, 1, 0))
        draw(space)

    with pytest.raises(BadCurve, match=said) as caught:
        read_dxf(drawing(tmp_path, 4, both))
    assert "elsewhere; a drawing in one plane z = const" in str(caught.value)


def test_a_drawing_at_any_one_height_is_read(tmp_path):
    def at_seven(space):
        space.add_line((0, 0, 7), (2, 1, 7 + 1e-10))
        space.add_circle((0, 0, 7), 1)

    assert read_dxf(drawing(tmp_path, 6, at_seven)).box == pytest.approx(
        np.array([[-1, -1], [2, 1]])
    )


@pytest.mark.parametrize(
    ("hide", "why"),
    [
        (lambda layer, entity: layer.off(), "is on layer 'aside', which is off"),
        (lambda layer, entity: layer.freeze(), "is on layer 'aside', which is frozen"),
        (lambda layer, entity: entity.dxf.set("invisible", 1), "is invisible"),
    ],
)
def test_what_is_hidden_in_a_drawing_is_no_silent_part_of_its_outline(tmp_path, hide, why):
    made = ezdxf.new()
    space, layer = made.modelspace(), made.layers.add("aside")
    space.add_circle((0, 0), 1)
    entity = space.add_circle((3, 0), 1, dxfattribs={"layer": "aside"})
    made.saveas(tmp_path / "d.dxf")
    assert read_dxf(tmp_path / "d.dxf").contour.max() == 1
    hide(layer, entity)
    made.saveas(tmp_path / "d.dxf")
    with pytest.raises(BadCurve, match=r"an entity CIRCLE \(handle \w+\) " + why):
        read_dxf(tmp_path / "d.dxf")


@pytest.mark.parametrize(
    ("layers", "own", "n_contours", "notes"),
    [
        (("0", "0"), (), 2, ()),
        (("cut", "holes"), (), 2, ("the layers 'cut', 'holes' are taken as one outline",)),
        (("l1", "SWEPT"), ("all", "but"), 1, ("but", "of the layers 'l1', 'SWEPT' only 'SWEPT' is taken")),
        (("WALLS", "SWEPT"), (), 2, ("the layers 'WALLS', 'SWEPT' are taken as one outline",)),
        (("0", "0"), ("5 mm all round", "checked by JD"), 2, ()),
    ],
)  # fmt: skip
def test_several_layers_are_told_and_in_a_drawing_of_ours_that_of_the_sweep_is_taken_alone(
    tmp_path, layers, own, n_contours, notes
):
    made = ezdxf.new()
    for i, layer in enumerate(layers):
        if not made.layers.has_entry(layer):
            made.layers.add(layer)
        made.modelspace().add_circle((3 * i, 0), 1, dxfattribs={"layer": layer})
    for text in own:
        made.header.custom_vars.append("clearance", text)
    made.saveas(tmp_path / "d.dxf")
    found = read_drawing(tmp_path / "d.dxf")
    assert found.curve.contour.max() + 1 == n_contours and found.notes == notes


SQUARE = [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]


def spline_fitted(space, curve):
    """A closed POLYLINE as others write it whose spline is on: the frame's vertices and those of its curve."""
    made = space.add_polyline2d([], close=True, dxfattribs={"smooth_type": 6})
    made.dxf.flags |= made.SPLINE_FIT_VERTICES_ADDED
    made.append_vertices(SQUARE, {"flags": 16, "start_width": 9})
    made.append_vertices(curve, {"flags": 8})


def test_the_frame_of_a_polylines_spline_is_no_part_of_its_curve(tmp_path):
    turns = [math.radians(9 * k) for k in range(40)]
    curve = [(500 + 400 * math.cos(turn), 500 + 400 * math.sin(turn)) for turn in turns]
    read = read_dxf(drawing(tmp_path, 4, lambda space: spline_fitted(space, curve)))
    known = Curve.polyline(1e-3 * np.array(curve), closed=True)
    assert hausdorff(read, known).distance <= 1e-12
    assert read.is_closed and read.contour.max() == 0


@pytest.mark.parametrize(
    "draw",
    [
        lambda space: spline_fitted(space, []),
        lambda space: space.add_polyline2d([], close=True),
    ],
)
def test_a_polyline_of_which_nothing_is_drawn_is_refused(tmp_path, draw):
    with pytest.raises(
        BadCurve, match=r"zero length; .* that differ, beside the frame of a spline"
    ):
        read_dxf(drawing(tmp_path, 4, draw))


@pytest.mark.parametrize(
    "draw",
    [
        lambda space: space.add_lwpolyline(SQUARE, close=True, dxfattribs={"const_width": 100}),
        lambda space: space.add_lwpolyline([(0, 0, 100, 0, 0), (1, 0)]),
        lambda space: space.add_lwpolyline([(0, 0, 0, 100, 0), (1, 0)]),
        lambda space: space.add_lwpolyline(
            [(0, 0, 9, 100, 0), (1, 0)], dxfattribs={"const_width": 0}
        ),
        lambda space: space.add_polyline2d(SQUARE, dxfattribs={"default_start_width": 100}),
        lambda space: space.add_polyline2d(SQUARE, dxfattribs={"default_end_width": 100}),
        lambda space: space.add_polyline2d([(0, 0, 100, 0, 0), (1, 0, 0, 0, 0)], format="xyseb"),
    ],
)
def test_a_polyline_with_a_width_is_refused(tmp_path, draw):
    """It is drawn as a band that reaches half its width beyond the line that was read."""

    def both(space):
        space.add_circle((5, 5), 1)
        draw(space).dxf.layer = "cut"

    said = (
        r"d\.dxf: \w+ \(handle \w+\): a polyline of width 100 on layer 'cut'; polylines of width 0"
    )
    with pytest.raises(BadCurve, match=said):
        read_dxf(drawing(tmp_path, 4, both))


def test_a_polyline_whose_widths_are_0_is_read(tmp_path):
    def both(space):
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"const_width": 0})
        space.add_polyline2d(SQUARE, close=True, dxfattribs={"default_end_width": 0})

    assert read_dxf(drawing(tmp_path, 4, both)).box == pytest.approx(np.array([[0, 0], [1, 1]]))
