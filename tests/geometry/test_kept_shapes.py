"""What is worked out of meshes once on a machine: the same bits come back, and it is never needed."""

from __future__ import annotations

import os
import pickle

import numpy as np
import pytest

from clearance.errors import BadSyntax
from clearance.geometry import kept_shapes as room
from clearance.geometry import open_faces, polyhedron, tree
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box, cylinder, pipe
from clearance.kept_files import cache_root
from clearance.load import mesh_store
from clearance.load.files.input_files import InputFiles
from clearance.load.mesh.mesh_file import mesh_file


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of what is kept, empty."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
    cache_root.cache_clear()
    yield tmp_path / "kept" / "clearance" / room.FOLDER
    cache_root.cache_clear()


class Maker:
    """Gives a value and counts how often it was asked to."""

    def __init__(self, value: object) -> None:
        self.value, self.n_made = value, 0

    def __call__(self) -> object:
        self.n_made += 1
        return self.value


def test_what_was_made_is_taken_and_other_names_and_kinds_are_made(folder):
    make = Maker([1, 2])
    for name, kind in (("a", "x"), ("a", "x"), ("b", "x"), ("a", "y")):
        assert room.kept(name, kind, room.__file__, make) == [1, 2]
    assert make.n_made == 3


def test_another_source_makes_it_again(folder):
    make = Maker(1)
    for source in (room.__file__, tree.__file__, room.__file__):
        room.kept("a", "x", source, make)
    assert make.n_made == 2


@pytest.mark.parametrize(
    "damage", [lambda c: c[:-1], lambda c: b"", lambda c: c[:40] + bytes([c[40] ^ 1]) + c[41:]]
)
def test_what_is_damaged_is_made_again(folder, damage):
    make = Maker(list(range(100)))
    room.kept("a", "x", room.__file__, make)
    (path,) = folder.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    for _ in range(2):
        assert room.kept("a", "x", room.__file__, make) == make.value
    assert make.n_made == 2


@pytest.mark.skipif(os.name == "nt", reason="other rights")
def test_what_others_could_have_written_is_not_unpickled(folder):
    make = Maker(1)
    room.kept("a", "x", room.__file__, make)
    (path,) = folder.iterdir()
    path.chmod(0o666)
    room.kept("a", "x", room.__file__, make)
    assert make.n_made == 2


def test_where_nothing_can_be_written_it_is_made_each_time(folder, monkeypatch):
    def full(*_: object) -> None:
        raise OSError("no room")

    monkeypatch.setattr(room, "write_kept", full)
    make = Maker(1)
    assert [room.kept("a", "x", room.__file__, make) for _ in range(2)] == [1, 1]


def test_the_oldest_goes_where_more_is_kept_than_may_be(folder, monkeypatch):
    monkeypatch.setattr(room, "MOST_FILES", 4)
    for age, name in enumerate("abcd"):
        room.kept(name, name, room.__file__, Maker(name))
        (path,) = folder.glob(f"{name}-*")
        os.utime(path, (age, age))
    room.kept("e", "e", room.__file__, Maker("e"))
    assert {path.name[0] for path in folder.iterdir()} == {"d", "e"}


def test_names_tell_shape_and_type_of_arrays_and_where_parts_begin():
    zeros = np.zeros(4)
    parts = [(zeros,), (zeros.reshape(2, 2),), (zeros.astype(np.float32),), (zeros, zeros),
             (b"ab", b"c"), (b"a", b"bc"), ("x", 1.0), ("x", -0.0), ("x", 0.0)]  # fmt: skip
    assert len({room.name_of(*each) for each in parts}) == len(parts)


def test_a_solid_from_another_process_cannot_be_written_either():
    copy = pickle.loads(pickle.dumps(box((1.0, 2.0, 3.0))))
    assert isinstance(copy, Polyhedron) and copy.volume == 6.0
    with pytest.raises(ValueError):
        copy.vertices[0, 0] = 7.0


def _surface(shapes):
    tree._built.clear()
    tree._joined.clear()
    return tree.join(shapes)


def test_a_kept_surface_has_the_bits_of_one_that_is_built(folder):
    round_one = cylinder(0.1, 0.3, tolerance=1e-6)
    assert round_one.n_faces >= tree.LARGE
    shapes = [box((1.0, 1.0, 1.0)), round_one]
    made, taken = _surface(shapes), _surface(shapes)
    assert len(list(folder.glob("surfaces-*"))) == 1
    for a, b in zip(made, taken, strict=True):
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        assert (
            a.flags.writeable == b.flags.writeable and a.flags.c_contiguous == b.flags.c_contiguous
        )


@pytest.mark.parametrize("n_lacking", [1, 200])
def test_what_is_open_is_found_once_and_has_the_same_bits(folder, monkeypatch, n_lacking):
    whole = cylinder(0.1, 0.3, tolerance=1e-6)
    lacking = Polyhedron.from_triangles(whole.vertices, whole.triangles()[:-n_lacking])
    assert lacking.n_faces >= open_faces.LARGE
    made = open_faces.open_faces_of(lacking)
    monkeypatch.setattr(open_faces, "closing_of", None)
    taken = open_faces.open_faces_of(lacking)
    assert (made.few or made.some) is not None
    assert pickle.dumps(made) == pickle.dumps(taken)
    assert taken.loose.flags.writeable == made.loose.flags.writeable


def test_of_a_whole_surface_nothing_open_is_kept(folder):
    found = open_faces.open_faces_of(cylinder(0.1, 0.3, tolerance=1e-6))
    assert found[:2] == (None, None) and not len(found.loose)
    assert not folder.exists()


def test_small_shapes_leave_no_file(folder):
    _surface([box((1.0, 1.0, 1.0)), box((1.0, 1.0, 2.0))])
    assert not folder.exists()


def _bent(height=0.5, inner_radius=0.04):
    path = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, height], [0.4, 0.0, 0.5]])
    return pipe(path=path, bend_radius=0.1, inner_radius=inner_radius, outer_radius=0.05)


def test_a_bent_pipe_is_merged_once_and_has_the_same_bits(folder, monkeypatch):
    made = _bent()
    assert len(list(folder.glob("bent-*"))) == 1
    monkeypatch.setattr(polyhedron, "merge_coplanar", None)
    taken = _bent()
    for name in ("vertices", "face_starts", "face_vertices"):
        a, b = getattr(made, name), getattr(taken, name)
        assert a.dtype == b.dtype and a.tobytes() == b.tobytes() and not b.flags.writeable
    assert (made.excess, made.volume) == (taken.excess, taken.volume)
    with pytest.raises(TypeError):
        _bent(inner_radius=0.03)  # another pipe, which is merged


def _stl(folder, name="a.stl", size=1.0):
    shape = cylinder(size, 0.3, tolerance=1e-5)
    path = folder / name
    path.write_bytes(mesh_file(shape.vertices, shape.triangles(), "stl"))
    assert path.stat().st_size > mesh_store.SMALL
    return path


def test_a_mesh_file_is_read_once_on_a_machine_for_each_scale_and_content(
    tmp_path, folder, monkeypatch
):
    real, read = mesh_store.mesh_from_bytes, []
    monkeypatch.setattr(mesh_store, "mesh_from_bytes", lambda *a: read.append(a) or real(*a))

    def load(path, scale=(1.0, 1.0, 1.0)):
        return mesh_store.MeshStore(InputFiles(tmp_path)).load(path, scale)

    made, taken = load(_stl(tmp_path)), load(_stl(tmp_path, "b.stl"))
    assert len(read) == 1
    assert made.shape.vertices.tobytes() == taken.shape.vertices.tobytes()
    assert (made.notes, made.n_triangles) == (taken.notes, taken.n_triangles)
    load(tmp_path / "a.stl", (2.0, 2.0, 2.0))
    load(_stl(tmp_path, size=1.1))
    assert len(read) == 3


def test_a_file_that_is_refused_is_refused_again_by_its_own_name(tmp_path, folder):
    content = _stl(tmp_path).read_bytes()[:-7]
    for name in ("first.stl", "second.stl"):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(BadSyntax, match=name):
            mesh_store.MeshStore(InputFiles(tmp_path)).load(tmp_path / name, (1.0, 1.0, 1.0))
