"""Profiles through files and the command line, two compared, and what `check` says of a case's profiles."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import clearance as cl
from clearance.cli.commands import clearance as command
from clearance.errors import BadInput, UnknownLink
from clearance.profiles.compare import as_data, compare
from clearance.profiles.outline_file import DrawnOutline, read_outline
from clearance.profiles.profile_file import write_profile
from tests.formats.making import CASE, write_case
from tests.formats.making_case import load_small
from tests.profiles.moving import free_circle, rows, slab, turning
from tests.report.schemas import objections

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture(scope="module")
def profile():
    return cl.swept_profile(
        turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 3.2, 6.4]), per_link=True, tolerance=2e-3
    )


@pytest.mark.slow
def test_our_yaml_keeps_every_bit(profile, tmp_path):
    write_profile(profile, tmp_path / "p.yaml")
    again = read_outline(tmp_path / "p.yaml").profile
    assert rows(again) == rows(profile)
    for name in ("name", "plane", "bound", "tolerance", "facets", "n_steps", "section", "notes"):
        assert getattr(again, name) == getattr(profile, name)
    assert [again.maker(i) for i in range(again.n_pieces)] == [
        profile.maker(i) for i in range(profile.n_pieces)
    ]
    assert list(again.parts) == list(profile.parts)


@pytest.mark.peer
def test_dxf_keeps_the_curve_and_opens_elsewhere(profile, tmp_path):
    import trimesh

    case = turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 3.2, 6.4])
    one = cl.swept_profile(case, tolerance=2e-3)
    path = tmp_path / "p.dxf"
    write_profile(one, path)
    found = cl.hausdorff(cl.read_curve(str(path)), one.curve)
    assert found.distance + found.error_bound <= 1e-12
    other = trimesh.load_path(str(path))  # its own reader of the format
    assert len(other.entities) >= 2
    points = one.contours[0].flattened(1e-4)
    assert np.allclose(other.bounds, [points.min(axis=0), points.max(axis=0)], atol=2e-3)
    write_profile(one, tmp_path / "q.dxf")
    assert path.read_bytes() == (tmp_path / "q.dxf").read_bytes()


@pytest.mark.peer
def test_geojson_is_a_valid_polygon_with_its_hole(profile, tmp_path):
    from shapely.geometry import shape

    write_profile(profile, tmp_path / "p.geojson")
    (feature,) = json.loads((tmp_path / "p.geojson").read_text())["features"]
    polygon = shape(feature["geometry"])
    assert polygon.is_valid and polygon.area == pytest.approx(profile.area, rel=1e-5)
    assert len(polygon.geoms[0].interiors) == 1


@pytest.mark.slow
def test_compare_agrees_with_the_distance_and_names_the_maker():
    one = cl.swept_profile(turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 0.5, 1.0]))
    two = cl.swept_profile(turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 0.5, 1.2]))
    found = compare(
        DrawnOutline("one", one.curve, one), DrawnOutline("two", two.curve, two), limit=0.01
    )
    whole = cl.hausdorff(one.curve, two.curve)
    assert found.found.distance == whole.distance
    assert found.lost <= 1e-4 < found.gained
    assert found.gained == pytest.approx(0.1 * (0.6**2 + 0.01 - 0.09), rel=0.02)
    assert (
        not found.within_limit and found.makers["b"][0] == "l1" and found.makers["b"][1] in (1, 2)
    )
    assert found.beyond and max(b.distance for b in found.beyond) <= whole.distance + 1e-9
    assert objections("comparison", json.loads(json.dumps(as_data(found)))) == []
    same = compare(
        DrawnOutline("one", one.curve, one), DrawnOutline("one", one.curve, one), limit=1e-9
    )
    assert same.found.distance <= 1e-15 and same.gained == 0.0 and not same.beyond


@pytest.mark.slow
def test_the_commands_from_sweep_to_picture(tmp_path):
    case, run = write_case(tmp_path), CliRunner().invoke
    swept, zone, fitted = (tmp_path / name for name in ("swept.yaml", "zone.yaml", "fitted.yaml"))
    free_circle(2.0).save(zone)
    out = run(command, ["profile", "sweep", str(case), "--tolerance", "2", "--out", str(swept)])
    assert out.exit_code == 0 and "contains all that is swept" in out.output, out.output
    arguments = [str(zone), str(swept), "--outside", "--margin-mm", "5", "--out", str(fitted)]
    out = run(command, ["profile", "fit", *arguments])
    assert out.exit_code == 0 and "proven gap 5" in out.output, out.output
    arguments = [str(swept), str(fitted), "--limit-mm", "1", "--out", str(tmp_path / "d")]
    out = run(command, ["profile", "compare", *arguments])
    assert out.exit_code == 1 and "beyond" in out.output, out.output
    written = sorted(path.name for path in (tmp_path / "d").iterdir())
    assert written == ["comparison.json", "comparison.png", "comparison.svg"]
    out = run(command, ["profile", "compare", str(swept), str(swept), "--limit-mm", "0.001"])
    assert out.exit_code == 0 and out.output.startswith("within 0.001 mm: ")


RING = [[0, 0], [1, 0], [1, 1], [0, 1]]
ASIDE = [[0.5, 0], [1.5, 0], [1.5, 1], [0.5, 1]]


@pytest.mark.parametrize(
    ("second", "closed", "why"),
    [
        (RING, True, r"one\.yaml: contours 1 and 2 overlap, as at .*, which leaves open what is inside"),
        (ASIDE, True, r"one\.yaml: contours 1 and 2 overlap"),
        (ASIDE, False, r"one\.yaml: contour 2 is open: it ends 1 away from its start"),
    ],
)  # fmt: skip
def test_contours_that_enclose_no_region_have_no_areas_and_the_comparison_says_why(
    tmp_path, second, closed, why
):
    """Parity would say that the same square twice encloses nothing, beside a distance of 0 to the square."""
    one, two = tmp_path / "one.yaml", tmp_path / "two.yaml"
    ring = f"{{polyline: {{points: {RING}, closed: true}}}}"
    other = f"{{polyline: {{points: {second}, closed: {str(closed).lower()}}}}}"
    one.write_text(f"curves: [{ring}, {other}]\n")
    two.write_text(f"curves: [{ring}]\n")
    for paths in ((one, two), (two, one)):
        out = CliRunner().invoke(command, ["profile", "compare", *map(str, paths)])
        assert out.exit_code == 0 and "  area " not in out.output
        assert re.search("  note      no areas: " + why, out.output)
    found = compare(*map(read_outline, (one, two)))
    assert as_data(found)["area_gained"] is as_data(found)["area_lost"] is None
    out = CliRunner().invoke(command, ["profile", "compare", str(two), str(two)])
    assert "  area      0 only in A" in out.output and "note" not in out.output


def sweep(case, *asked, **cut):
    found = cl.swept_profile(case, *asked, **cut)
    return DrawnOutline(asked[0] if asked else "xy", found.curve, found)


@pytest.mark.slow
@pytest.mark.parametrize("plane", ["0.5 0 0.4 0 0 1", "0 0 0 0 0 -1"])
def test_sweeps_in_planes_of_other_coordinates_are_not_compared(plane):
    """Two outlines in planes across one another can have the same numbers, and are nothing alike."""
    case = turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 1.0])
    with pytest.raises(BadInput, match="whose coordinates differ; sweeps with one --plane"):
        compare(sweep(case), sweep(case, plane))
    assert compare(sweep(case), sweep(case, "0 0 0.4 0 0 1")).found.distance <= 1e-9


@pytest.mark.slow
def test_a_section_beside_a_silhouette_is_named(tmp_path):
    case = turning(slab([0.3, -0.1, 0], [0.6, 0.1, 0.1]), [0, 1.0])
    for name, height in (("whole", None), ("cut", 0.05), ("cut2", 0.06)):
        write_profile(cl.swept_profile(case, section=height), tmp_path / f"{name}.yaml")

    def told(*names):
        paths = [str(tmp_path / f"{name}.yaml") for name in names]
        return CliRunner().invoke(command, ["profile", "compare", *paths]).output

    assert "note      A is a silhouette, B a section at 0.05 m" in told("whole", "cut")
    assert "note      A is a section at 0.06 m, B a section at 0.05 m" in told("cut2", "cut")
    assert "note" not in told("cut", "cut")


def squares(tmp_path, unit):
    """Two squares of 1000 and 1003, in drawings of a unit."""
    import ezdxf

    paths = []
    for name, width in (("a.dxf", 1000), ("b.dxf", 1003)):
        made = ezdxf.new()
        made.header["$INSUNITS"] = unit
        corners = [(0, 0), (width, 0), (width, 1000), (0, 1000)]
        made.modelspace().add_lwpolyline(corners, close=True)
        made.saveas(tmp_path / name)
        paths.append(str(tmp_path / name))
    return paths


def test_drawings_with_a_unit_are_compared_in_mm_and_take_no_limit_without_one(tmp_path, refusal):
    """They are read in metres, in which a limit of 1 would be a thousand times the 1 mm that is meant."""
    paths = squares(tmp_path, unit=4)
    out = CliRunner().invoke(command, ["profile", "compare", *paths, "--limit-mm", "1"])
    assert out.exit_code == 1 and out.output.startswith("beyond 1 mm: the outlines differ by 3 mm")
    out = CliRunner().invoke(command, ["profile", "compare", *paths])
    assert out.exit_code == 0 and out.output.startswith(
        "the outlines differ by 3 mm, error at most"
    )
    said = "error: --limit: a limit without a unit, where a.dxf says its own; --limit-mm"
    assert refusal("profile", "compare", *paths, "--limit", 1).startswith(said)


def test_drawings_without_a_unit_are_compared_in_their_own(tmp_path):
    out = CliRunner().invoke(
        command, ["profile", "compare", *squares(tmp_path, unit=0), "--limit", "1"]
    )
    assert out.exit_code == 1
    assert out.output.startswith("beyond 1 (unit of the files): the outlines differ by 3 (unit")


def test_a_drawing_without_a_unit_is_fitted_to_no_sketch(tmp_path, refusal):
    """Sketches are in metres, and a margin in mm: 20 mm about numbers of mm were 0.02 mm."""
    zone, drawing = SCENES / "sketches" / "keep_in_zone.yaml", squares(tmp_path, unit=0)[0]
    asked = ("--outside", "--margin-mm", 20, "--out", tmp_path / "x.yaml")
    said = "a.dxf: the drawing names no unit ($INSUNITS 0), and sketches are in metres"
    assert said in refusal("profile", "fit", zone, drawing, *asked)


@pytest.mark.slow
def test_a_swept_profile_takes_no_limit_without_a_unit(profile, tmp_path, refusal):
    """Its lengths are printed in mm, so that a limit of 1 would read as 1 mm and be 1 m."""
    path = tmp_path / "p.yaml"
    write_profile(profile, path)
    said = "error: --limit: a limit without a unit, where p.yaml says its own; --limit-mm"
    assert refusal("profile", "compare", path, path, "--limit", 1).startswith(said)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["sweep", "CASE", "--out", "x.png"], "a profile file with .png"),
        (["sweep", "CASE", "--plane", "xyz", "--out", "x.yaml"], "plane: 'xyz'"),
        (["fit", "ZONE", "none.yaml", "--out", "x.yaml"], "no such file"),
        (["compare", "ZONE", "none.yaml", "--out", "x.yaml"], "no such file"),
        (["fit", "OPENING", "ZONE", "--out", "x.yaml"], "no free dimension"),
    ],
)
def test_refusals_of_the_commands_are_one_line(arguments, said, tmp_path, monkeypatch, refusal):
    monkeypatch.chdir(tmp_path)
    sketches = SCENES / "sketches"
    known = {
        "CASE": SCENES / "profiles" / "keep_in.yaml",
        "ZONE": sketches / "keep_in_zone.yaml",
        "OPENING": sketches / "port_opening.yaml",
    }
    assert said in refusal("profile", *(known.get(word, word) for word in arguments))


@pytest.mark.parametrize(
    ("entry", "fault", "said"),
    [
        ("{name: a, sketch: none.yaml}", BadInput, "profiles[0]: sketch: there is no file"),
        ("{name: a, sketch: zone.yaml, mode: around}", BadInput, "profiles[0].mode"),
        ("{name: a, sketch: zone.yaml, links: [hand]}", UnknownLink, "profiles[0]: links"),
        ("{name: a, sketch: open.yaml}", BadInput, "profiles[0]: sketch"),
        ("{name: a, sketch: points.yaml}", BadInput, "the sketch draws nothing"),
    ],
)
def test_refusals_of_a_case_name_the_profile(entry, fault, said, tmp_path):
    free_circle(2.0).save(tmp_path / "zone.yaml")
    points = "points: {a: [0, 0], b: [1, 0]}\n"
    (tmp_path / "points.yaml").write_text(points)
    (tmp_path / "open.yaml").write_text(points + "segments: {ab: [a, b]}\n")
    with pytest.raises(fault) as caught:
        load_small(tmp_path, CASE + f"profiles: [{entry}]\n")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("plane: [1, 2]", "plane"),
        ("plane: {origin: [0, 0]}", "plane: origin"),
        ("plane: {axes: [[1, 0, 0], [0, .nan, 0]]}", "plane: axes"),
        ("bound: -1", "bound"),
        ("steps: many", "steps"),
        ("notes: 5", "notes"),
        ("section: [1]", "section"),
        ("origin: {links: [a], link_and_step: [[0, 1]]}", "1 entries for 3 pieces"),
        ("origin: {links: [a], link_and_step: [[0, 1], [1, 1], [0, 2]]}", "a link or step"),
        ("origin: 5", "origin"),
        ("parts: {l1: {name: l1}}", "parts: l1: contours"),
        ("parts: {l1: {contours: [[[0, 0, 0]]]}}", "a single vertex"),
    ],
)
def test_a_profile_file_with_a_wrong_field_is_refused_by_its_name(line, said, tmp_path):
    path = tmp_path / "p.yaml"
    path.write_text(
        f"format: clearance-profile-1\ncontours: [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]\n{line}\n"
    )
    with pytest.raises(BadInput) as caught:
        read_outline(path)
    assert said in str(caught.value) and "p.yaml" in str(caught.value)


@pytest.mark.slow
def test_drawings_state_their_size_in_millimetres_and_their_unit(profile, tmp_path):
    write_profile(profile, tmp_path / "p.svg"), write_profile(profile, tmp_path / "p.dxf")
    width = float(re.search(r'width="([\d.]+)mm"', (tmp_path / "p.svg").read_text())[1])
    extent = float((profile.curve.box[1] - profile.curve.box[0])[0]) * 1000.0
    assert extent < width < 1.2 * extent
    words = (tmp_path / "p.dxf").read_text().split()
    assert words[words.index("$INSUNITS") + 2] == "6"
