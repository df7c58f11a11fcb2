"""Mesh files to solids: nothing lost, nothing moved, nothing turned inside out, and each fault in one line."""

from fractions import Fraction

import numpy as np
import pytest

from clearance.errors import BadDimension, BadPolygon, BadSyntax, EmptyMesh, MissingFile, NotFinite
from clearance.formats.mesh.mesh_file import OPEN, mesh_from_bytes, read_mesh, triangles_from_bytes
from tests.formats.making import CUBE, CUBE_TRIANGLES, binary_stl, cube_stl, signed_volume, text_stl
from tests.formats.making_meshes import obj
from tests.formats.refusal import refusal

CUBE_CORNERS = CUBE[CUBE_TRIANGLES]


def as_triangle_set(corners) -> set:
    """Triangles as exact coordinates, first corner least, orientation kept."""
    found = set()
    for triangle in np.asarray(corners, dtype=float):
        points = [tuple(Fraction(float(x)) for x in point) for point in triangle]
        i = points.index(min(points))
        found.add(tuple(points[i:] + points[:i]))
    return found


STL = {
    "binary": binary_stl(CUBE_CORNERS),
    "binary that begins with solid": binary_stl(
        CUBE_CORNERS, header=b"solid by a careless exporter"
    ),
    "text": text_stl(CUBE_CORNERS),
    "text of two solids": text_stl(CUBE_CORNERS[:4]) + text_stl(CUBE_CORNERS[4:]).upper(),
}


@pytest.mark.parametrize("form", STL)
def test_stl_in_every_form_is_the_same_cube(form):
    mesh = mesh_from_bytes(STL[form], "cube.STL")
    assert (mesh.n_triangles, mesh.shape.n_faces, len(mesh.shape.vertices)) == (12, 6, 8)
    assert signed_volume(mesh.shape) == 1
    assert mesh.shape.closed
    assert mesh.notes == ()


def test_single_precision_values_are_kept_and_nearly_equal_points_stay_apart():
    near = np.nextafter(np.float32(0.1), np.float32(1))
    corners = np.array(
        [[[0, 0, 0], [0.1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, -1, 0], [near, 0, 0]]],
        dtype=np.float32,
    )
    mesh = mesh_from_bytes(binary_stl(corners), "near.stl")
    assert as_triangle_set(corners) == as_triangle_set([mesh.shape.face(i) for i in range(2)])
    assert len(mesh.shape.vertices) == 5


def test_minus_zero_and_zero_are_one_point():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[-0.0, 0, 0], [0, 1, 0], [-1, 0, 1]]])
    assert len(mesh_from_bytes(binary_stl(corners), "m.stl").shape.vertices) == 4


def test_zero_area_triangles_go_only_where_their_neighbours_cover_them():
    covered = [[[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [0.5, -0.5, -0.5]]]
    mesh = mesh_from_bytes(binary_stl(np.concatenate([CUBE_CORNERS, covered])), "m.stl")
    assert mesh.shape.n_faces == 6
    assert mesh.notes == ("1 triangle has no area and is covered by its neighbours",)
    whisker = [[[2, 0, 0], [3, 0, 0], [4, 0, 0]]]
    mesh = mesh_from_bytes(binary_stl(np.concatenate([CUBE_CORNERS, whisker])), "m.stl")
    assert mesh.shape.bounds[1].tolist() == [4, 0.5, 0.5]
    assert (
        "1 triangle has no area; 1 is kept as a face, because nothing else covers it"
        in mesh.notes[0]
    )


def test_a_mesh_with_each_triangle_once_for_each_side_is_said_to_hold_nothing():
    both = np.concatenate([CUBE_CORNERS, CUBE_CORNERS[:, ::-1]])
    (note,) = mesh_from_bytes(binary_stl(both), "m.stl").notes
    assert note.startswith("it holds each face once for each side: what is wholly inside")
    (note,) = mesh_from_bytes(binary_stl(np.concatenate([both, CUBE_CORNERS + 3.0])), "m.stl").notes
    assert note.startswith("1 of its 2 parts holds")
    assert mesh_from_bytes(binary_stl(CUBE_CORNERS), "m.stl").notes == ()


def test_obj_of_several_materials_groups_and_objects_keeps_every_face():
    lines = obj().splitlines()
    faces = [
        "o first", "usemtl red", lines[8], "usemtl blue", lines[9], "g left right",
        "f 1/1/1 5/2/1 6/3/1 2/4/1", "o second", "usemtl red", "f 3//1 4//1 8//1 7//1", "s off",
        "usemtl", lines[12], "l 1 2", "f 2/9 6/9 8/9 4/9",
    ]  # fmt: skip
    text = "\n".join(
        ["# two materials", "mtllib missing.mtl", *lines[:8], "vn 0 0 1", "vt 0 0", *faces]
    )
    mesh = mesh_from_bytes(text.encode(), "cube.obj")
    expected = as_triangle_set(CUBE_CORNERS)
    whole = mesh_from_bytes(obj().encode(), "cube.obj")
    assert mesh.n_triangles == len(expected) == 12
    assert signed_volume(mesh.shape) == signed_volume(whole.shape) == 1
    assert mesh.shape.closed


def test_obj_points_and_lines_are_told():
    mesh = mesh_from_bytes(f"{obj()}l 1 2 3\np 1 2\n".encode(), "cube.obj")
    left_out = "2 elements of points or lines, which have no surface: not measured"
    assert mesh.notes == (left_out,)


def test_obj_relative_indices_count_from_their_own_line():
    triangle = "v 0 0 {0}\nv 1 0 {0}\nv 0 1 {0}\nf -3 -2 -1\n"
    data = (triangle.format(0) + triangle.format(5)).encode()
    triangles = triangles_from_bytes(data, "m.obj")
    heights = triangles.vertices[triangles.corners][:, :, 2]
    assert heights.tolist() == [[0, 0, 0], [5, 5, 5]]


def test_obj_continued_lines_tabs_colours_and_comments():
    data = b"v 0 0 0 1 0 0\r\nv\t1 0 0 # corner\r\nv 0 1 0\r\nf 1 \\\r\n 2 3 # face\r\n"
    assert triangles_from_bytes(data, "m.obj").corners.tolist() == [[0, 1, 2]]


def test_scale_of_each_axis_and_mirroring_move_points_where_they_belong():
    corners = CUBE_CORNERS + np.array([1, 2, 3])
    shape = mesh_from_bytes(binary_stl(corners), "m.stl", (-2, 3, 0.5)).shape
    assert shape.bounds.tolist() == [[-3, 4.5, 1.25], [-1, 7.5, 1.75]]
    assert signed_volume(shape) == pytest.approx(3)


@pytest.mark.parametrize("scale", [0, (1, 0, 1), float("nan"), float("inf"), (1, 2), 1e308])
def test_a_scale_that_leaves_no_solid_is_refused(scale):
    far = binary_stl(CUBE_CORNERS * 100)
    with pytest.raises(BadDimension, match=r"^m\.stl: scale"):
        mesh_from_bytes(far, "m.stl", scale)


@pytest.mark.peer
@pytest.mark.parametrize("suffix", ["ply", "off", "glb", "stl", "obj"])
def test_formats_that_trimesh_writes_come_back_whole(suffix):
    import trimesh

    box = trimesh.creation.box(extents=(1, 2, 4))
    written = box.export(file_type=suffix)
    data = written.encode() if isinstance(written, str) else written
    mesh = mesh_from_bytes(data, f"box.{suffix}")
    assert (mesh.n_triangles, mesh.shape.n_faces) == (12, 6)
    assert signed_volume(mesh.shape) == pytest.approx(8)
    size = mesh.shape.bounds[1] - mesh.shape.bounds[0]
    assert size.tolist() == ([1, 4, 2] if suffix == "glb" else [1, 2, 4])  # glTF is y up


NAN_STL = binary_stl(np.concatenate([CUBE_CORNERS, [[[0, 0, 0], [1, np.nan, 0], [0, 1, 0]]]]))


@pytest.mark.parametrize(
    ("name", "data", "fault", "says"),
    [
        ("m.stl", binary_stl(np.zeros((0, 3, 3))), EmptyMesh, "no faces"),
        ("m.stl", cube_stl()[:-20], BadSyntax, "not an STL file"),
        ("m.stl", cube_stl() + b"more", BadSyntax, "not an STL file"),
        ("m.stl", text_stl(CUBE_CORNERS)[:600], BadSyntax, "cut off"),
        ("m.stl", text_stl(CUBE_CORNERS).replace(b"endloop", b"", 1), BadSyntax, "closed outer loop"),
        ("m.stl", text_stl(CUBE_CORNERS).replace(b"-0.5", b"x", 1), BadSyntax, "three vertices"),
        ("m.stl", NAN_STL, NotFinite, "face 12"),
        ("m.obj", b"v 0 0 0\nv 1 0 0\n", EmptyMesh, "no faces"),
        ("m.obj", b"v 0 0 0\nv 1 0 0\nf 1 2\n", BadPolygon, "face 0 has 2 vertices"),
        ("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", BadPolygon, "vertex 3"),
        ("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", BadSyntax, "line 4: 'f 1 2 0'"),
        ("m.obj", b"v 0 0 0\ncurv 0 1 1\n", BadSyntax, "line 2: free-form"),
        ("m.ply", b"ply\nformat ascii 1.0\n", BadSyntax, "not a PLY file"),
        ("m.off", b"OFX\n", BadSyntax, "OFF"),
        ("m.glb", b"glTF\0\0", BadSyntax, "GLB"),
        ("m.3ds", b"", BadSyntax, "unknown mesh format '.3ds'; .stl, .obj, .dae"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_the_file(name, data, fault, says):
    said = refusal(mesh_from_bytes, data, name, of=fault)
    assert says in said
    assert said.startswith(name)


def test_files_are_read_from_disk(tmp_path):
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    assert signed_volume(read_mesh(tmp_path / "cube.stl", scale=0.5)) == 0.125
    assert "there is no file 'no.stl'" in refusal(read_mesh, tmp_path / "no.stl", of=MissingFile)
    (tmp_path / "folder.stl").mkdir()
    assert "is a folder" in refusal(read_mesh, tmp_path / "folder.stl", of=MissingFile)


INSIDE_OUT = CUBE_CORNERS[:, ::-1]
PARTS = {
    # what: its parts, the note, its volume
    "inside out": ([INSIDE_OUT], "the closed surface was inside out and is turned round", 1),
    "a cavity": ([CUBE_CORNERS * 4, INSIDE_OUT], "", 63),
    "two of three": (
        [CUBE_CORNERS, INSIDE_OUT + 3.0, INSIDE_OUT + 6.0],
        "2 of its 3 parts were inside out and are turned round", 3,
    ),
    "open": ([CUBE_CORNERS[1:]], OPEN, None),
    "one open": (
        [CUBE_CORNERS[1:], CUBE_CORNERS + 3.0],
        "1 of its 2 parts is open: a body inside is found only if the holes are small", None,
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", PARTS)
def test_parts_that_are_inside_out_or_open_are_noted_and_cavities_stay(what):
    parts, note, volume = PARTS[what]
    mesh = mesh_from_bytes(binary_stl(np.concatenate(parts)), "m.stl")
    assert mesh.notes == ((note,) if note else ())
    assert volume is None or signed_volume(mesh.shape) == pytest.approx(volume)


def test_exact_copies_of_faces_are_left_out_with_a_note():
    again = np.concatenate([CUBE_CORNERS, CUBE_CORNERS[3:5], np.roll(CUBE_CORNERS[7:8], 1, axis=1)])
    mesh = mesh_from_bytes(binary_stl(again), "m.stl")
    assert mesh.notes == ("3 exact copies of faces are left out",)
    assert mesh.n_triangles == 15
    assert signed_volume(mesh.shape) == 1
    assert mesh.shape.closed and mesh.shape.component_closed.all()
    one = mesh_from_bytes(binary_stl(np.concatenate([CUBE_CORNERS, CUBE_CORNERS[:1]])), "m.stl")
    assert one.notes == ("1 exact copy of a face is left out",)


def test_obj_lines_end_where_lines_end_and_numbers_are_numbers():
    data = "v 0 0 0 # a\u2028v 9 9 9\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode()
    assert triangles_from_bytes(data, "m.obj").corners.tolist() == [[0, 1, 2]]
    for old, new in [
        (b"v 1 0 0", b"v 1_0 0 0"),
        (b"f 1 2 3", b"f 1 2 0_3"),
        (b"v 0 1", b"v 0 \xd9\xa1"),
    ]:
        assert "line" in refusal(mesh_from_bytes, data.replace(old, new), "m.obj", of=BadSyntax)
