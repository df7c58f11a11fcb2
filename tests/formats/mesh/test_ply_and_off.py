"""PLY and OFF: all that the header says is read, in every form, and a file that holds less or more is refused."""

import numpy as np
import pytest

from clearance.errors import BadInput
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from tests.formats.making import CUBE, CUBE_TRIANGLES, signed_volume
from tests.formats.making_meshes import QUADS, binary_ply, off, text_ply
from tests.formats.refusal import refusal

FORMS = [
    text_ply,
    lambda faces: text_ply(faces, newline="\r\n"),
    lambda faces: text_ply(faces, newline="\r"),
    binary_ply,
    lambda faces: binary_ply(faces, ">"),
]


@pytest.mark.parametrize("write", FORMS)
@pytest.mark.parametrize(
    "faces", [CUBE_TRIANGLES.tolist(), QUADS, [*QUADS[:5], [1, 5, 7], [1, 7, 3]]]
)
def test_a_cube_is_a_cube_in_every_form(write, faces):
    mesh = mesh_from_bytes(write(faces), "m.ply")
    assert (mesh.n_triangles, mesh.shape.n_faces, signed_volume(mesh.shape)) == (12, 6, 1)


STRIP = [0, 2, 1, 3, -1, 1, 3, 0, 2]


@pytest.mark.parametrize("write", [text_ply, binary_ply])
def test_strips_are_read(write):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    data = write([STRIP], points=points, element="tristrips")
    mesh = mesh_from_bytes(data, "m.ply")
    assert mesh.n_triangles == 4
    assert signed_volume(mesh.shape) == pytest.approx(1)


@pytest.mark.parametrize("write", [text_ply, binary_ply])
def test_other_properties_and_elements_are_passed_over(write):
    data = write(CUBE_TRIANGLES.tolist())
    if write is text_ply:
        data = data.replace(b"\nelement face", b"\nproperty uchar red\nelement face")
        head, _, body = data.partition(b"end_header\n")
        lines = body.split(b"\n")
        lines[:8] = [line + b" 255" for line in lines[:8]]
        edges = b"element edge 1\nproperty int vertex1\nproperty int vertex2\n"
        data = head + edges + b"end_header\n" + b"\n".join(lines) + b"0 1\n"
    assert signed_volume(mesh_from_bytes(data, "m.ply").shape) == 1


@pytest.mark.parametrize("write", FORMS)
@pytest.mark.parametrize("faces", [CUBE_TRIANGLES.tolist(), [*QUADS[:5], [1, 5, 7], [1, 7, 3]]])
def test_a_ply_file_that_is_cut_off_anywhere_is_refused(write, faces):
    data = write(faces)
    last = len(data.rstrip()) - 1 if b"ascii" in data else len(data)
    for end in [*range(0, last, 5), last - 1]:
        with pytest.raises(BadInput):
            mesh_from_bytes(data[:end], "m.ply")


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (text_ply(QUADS) + b"3 0 1 2\n", "1 lines more than its header says"),
        (binary_ply(QUADS) + b"\1\2", "2 bytes more than its header says"),
        (binary_ply(QUADS).replace(b"face 6", b"face 2000000000"), "do not fit in the file"),
        (text_ply(QUADS).replace(b"face 6", b"face 2000000000"), "cut off"),
        (text_ply(QUADS).replace(b"4 0 1 3 2", b"4 0 1 3 2 7"), "row 0 has 6 numbers"),
        (text_ply(QUADS).replace(b"4 0 1 3 2", b"4 0 1 3 8"), "vertex 8"),
        (text_ply(QUADS).replace(b"4 0 1 3 2", b"4 0 1 3 1_0"), "'1_0' is not a whole number"),
        (text_ply(QUADS).replace(b"double z", b"double y"), "'y' is there twice"),
        (text_ply(QUADS).replace(b"double z", b"triple z"), "header has the line 'property triple z'"),
        (text_ply(QUADS).replace(b"vertex_indices", b"texcoord"), "0 lists of vertex indices"),
        (text_ply(QUADS).replace(b"uchar int", b"uchar float"), "vertex indices are fractions"),
        (text_ply(QUADS).replace(b"format ascii", b"format binary"), "not a PLY file"),
        (text_ply([], CUBE), "no faces"),
    ],
)  # fmt: skip
def test_a_ply_file_that_does_not_add_up_is_refused(data, says):
    assert says in refusal(mesh_from_bytes, data, "m.ply", of=BadInput)


@pytest.mark.parametrize(
    "data",
    [
        off(),
        off(CUBE_TRIANGLES.tolist()),
        off(head="OFF "),
        off(head="# a cube\nOFF # here\n\n"),
        off(colour=" 255 0 0 # red"),
        off(points=np.concatenate([CUBE, CUBE], axis=1), head="NOFF\n"),
        off().replace(b"\n", b"\r\n"),
    ],
)
def test_an_off_cube_is_a_cube(data):
    mesh = mesh_from_bytes(data, "m.off")
    assert (mesh.n_triangles, mesh.shape.n_faces, signed_volume(mesh.shape)) == (12, 6, 1)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (off() + b"3 0 1 2\n", "15 lines below its header; 8 points and 6 faces"),
        (off().replace(b"4 0 1 3 2", b"5 0 1 3 2"), "face 0 has 4 numbers, and names 5 corners"),
        (off().replace(b"4 0 1 3 2", b"4 0 1 3 8"), "vertex 8"),
        (off().replace(b"-0.5 -0.5 -0.5", b"-0.5 -0.5", 1), "point 0 has 2 coordinates"),
        (off(head="4OFF\n"), "not an OFF file"),
        (off(head="OFF BINARY\n"), "header"),
    ],
)
def test_an_off_file_that_does_not_add_up_is_refused(data, says):
    assert says in refusal(mesh_from_bytes, data, "m.off", of=BadInput)
