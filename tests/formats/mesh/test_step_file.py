"""STEP as a mesh: units, how far facets may be off, and that a case takes that off its clearance."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadSyntax, Unavailable
from clearance.formats.mesh import step_file
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from tests.formats.making_case import load_small, with_obstacle
from tests.formats.making_step import box_step, cylinder_step

pytestmark = pytest.mark.cold


def solid(text: str, tolerance: float = 1e-4):
    return mesh_from_bytes(text.encode(), "part.step", tolerance=tolerance)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        (box_step((10, 20, 30)), (0.01, 0.02, 0.03)),
        (box_step((1, 2, 3), "inch"), (0.0254, 0.0508, 0.0762)),
    ],
)
def test_a_box_is_as_large_as_its_unit_says_and_lies_as_in_the_file(text, size):
    shape = solid(text).shape
    np.testing.assert_allclose(shape.bounds, [[0, 0, 0], size], rtol=0, atol=0.3 * 2.0**-24)
    assert shape.closed and shape.n_faces == 6 and shape.volume > 0


@pytest.mark.parametrize(("unit", "tolerance"), [("mm", 5e-5), ("inch", 1e-3)])
def test_a_cylinder_is_nowhere_farther_off_than_is_said(unit, tolerance):
    loaded = solid(cylinder_step(40.0, 30.0, unit), tolerance)
    shape, scale = loaded.shape, {"mm": 1e-3, "inch": 25.4e-3}[unit]
    radius, length = 40.0 * scale, 30.0 * scale
    across = np.hypot(*shape.vertices[:, :2].T)
    assert np.abs(across - radius).max() <= shape.excess
    rings = [shape.face(i) for i in range(shape.n_faces)]
    sides = [(a, b) for ring in rings for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)]
    middle = np.array([0.5 * (a + b) for a, b in sides if abs(a[2] - b[2]) < 1e-9])
    inside = radius - np.hypot(*middle[:, :2].T).min()
    assert 0.05 * tolerance < inside <= shape.shortfall
    assert tolerance < shape.shortfall < tolerance + 1e-6
    assert shape.closed and np.ptp(shape.bounds[:, 2]) == pytest.approx(length, abs=1e-6)


def test_the_accuracy_that_a_file_states_is_part_of_the_bound_and_scale_grows_it():
    text = box_step(uncertainty=0.05)
    loaded = mesh_from_bytes(text.encode(), "part.stp", 2.0)
    assert loaded.shape.shortfall == pytest.approx(2 * (1e-4 + 5e-5), rel=1e-3)
    assert loaded.notes == (
        "facets of a CAD file, up to 0.3 mm off its surface, which is taken off the clearance; depths of contact "
        "are those of the facets",
    )


def test_the_clearance_of_a_case_is_never_overstated(tmp_path):
    """A cylinder of 0.5 m stands 1.2 m along x before the cube of the arm, which reaches to 0.5 m."""
    case = load_small(
        tmp_path,
        with_obstacle("mesh: {file: part.step, tolerance: 0.01}"),
        trajectory="time,shoulder\n0,0\n1,0\n",
        part__step=cylinder_step(500.0, 2000.0),
    )
    (obstacle,) = case.obstacles
    record = cl.check(case).record
    least = float(record.steps["clearance"].to_numpy().min())
    true = 1.2 - 0.5 - 0.5
    assert true - 2 * obstacle.body.shape.shortfall <= least <= true
    assert least < true - 0.9 * obstacle.body.shape.shortfall
    summary = cl.check(case).summary
    assert summary["paddings"] == {"post": pytest.approx(0.01, rel=1e-3)}
    assert any("taken off the clearance" in note for note in summary["notes"])
    assert cl.Checker(case).distance([0.0]).distance == least


def test_faces_of_other_colours_and_curves_beside_them_are_read():
    curves = "GEOMETRIC_CURVE_SET('',(#9000))"
    line = "#9000=POLYLINE('',(#1,#3));\n"
    style = "#{0}=SURFACE_STYLE_USAGE(.BOTH.,#{1});#{1}=SURFACE_SIDE_STYLE('',(#{2}));"
    style += "#{2}=SURFACE_STYLE_FILL_AREA(#{3});#{3}=FILL_AREA_STYLE('',(#{4}));"
    style += "#{4}=FILL_AREA_STYLE_COLOUR('',#{5});#{5}=COLOUR_RGB('',{r},0.,0.);"
    style += "#{6}=PRESENTATION_STYLE_ASSIGNMENT((#{0}));#{7}=STYLED_ITEM('',(#{6}),{face});"
    text = box_step(item=curves)
    faces = [of.partition("=")[0] for of in text.splitlines() if "=ADVANCED_FACE(" in of]
    (context,) = (of.partition("=")[0] for of in text.splitlines() if "GEOMETRIC_REP" in of)
    red, black = (
        style.format(*range(n, n + 8), r=r, face=face)
        for n, r, face in ((9010, "1.", faces[0]), (9020, "0.", faces[1]))
    )
    shown = "#9030=MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#9017,#9027),"
    more = f"{line}{red}\n{black}\n{shown}{context});\n"
    loaded = solid(text.replace("ENDSEC;\nEND-ISO", more + "ENDSEC;\nEND-ISO"))
    assert loaded.shape.closed and loaded.shape.n_faces == 6
    assert "1 set of curves, which have no surface: not measured" in loaded.notes


def test_a_face_that_its_corners_do_not_lie_on_is_refused():
    """The ends of a cylinder of 10 mm whose side is said to be of 9 mm."""
    text = cylinder_step().replace("CYLINDRICAL_SURFACE('',#", "CYLINDRICAL_SURFACE('',##")
    place, _, _ = text.partition("CYLINDRICAL_SURFACE('',##")
    rest = text[len(place) :].replace("##", "#").replace(",10)", ",9.)", 1)
    with pytest.raises(BadSyntax, match=r"part\.step: .*(off their face|come to facets|no facets)"):
        solid(place + rest)


@pytest.mark.parametrize("share", [0.9])
def test_a_file_with_a_part_missing_is_refused(share):
    text = box_step()
    begin = text.index("DATA;") + int(
        share * (text.index("ENDSEC;\nEND-ISO") - text.index("DATA;"))
    )
    with pytest.raises(BadSyntax):
        solid(text[:begin] + text[begin + 150 :])


def test_a_process_that_dies_is_one_line(monkeypatch, tmp_path):
    (tmp_path / "dies.py").write_text("import os; os.abort()")
    monkeypatch.setattr(step_file, "_PROCESS", tmp_path / "dies.py")
    with pytest.raises(BadSyntax, match=r"Open CASCADE came to no end with it \(exit code -6\)"):
        solid(box_step())


def test_no_library_no_reading(monkeypatch):
    monkeypatch.setattr("clearance.extras.is_installed", lambda library: False)
    with pytest.raises(Unavailable, match=r"reading STEP needs cascadio.*clearance\[cad\]"):
        solid(box_step())
