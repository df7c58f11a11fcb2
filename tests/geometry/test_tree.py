"""The bounding tree, every face in one leaf and every box around what is below it, and the cache of such forms."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from clearance.geometry import surface_cache, tree
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import cylinder
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.surface import Surface
from tests.made_cases import ball, faces_below, torus


def soup(n: int) -> Polyhedron:
    """Triangles anywhere, of all sizes."""
    random = np.random.default_rng(n)
    sizes = 10.0 ** random.uniform(-3, 0, (n, 1, 1))
    corners = random.normal(size=(n, 1, 3)) + sizes * random.normal(size=(n, 3, 3))
    return Polyhedron(corners.reshape(-1, 3), np.arange(3 * n).reshape(n, 3))


SHAPES = [soup(n) for n in (1, 2, 3, 4, 5, 6, 9, 17, 64, 65, 300)] + [
    ball(1.0, 3),
    torus(1.0, 0.25, 40, 20),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: str(shape.n_faces))
def test_every_face_is_in_one_leaf_and_every_box_holds_its_faces(shape: Polyhedron) -> None:
    surface = surface_of(shape)
    below = faces_below(surface)
    assert below[surface.roots[0]] == {*range(shape.n_faces)}
    leaves = surface.children[surface.children[:, 1] == 0, 0]
    assert sorted(leaves.tolist()) == list(range(shape.n_faces))
    boxes = surface.boxes.reshape(-1, 12, WIDTH).astype(np.float64)
    centres = surface.centres.reshape(-1, 3, WIDTH)
    for node in np.flatnonzero(surface.children[:, 1] >= 0):
        group, k = divmod(node, WIDTH)
        axes, half = boxes[group, :9, k].reshape(3, 3), boxes[group, 9:, k]
        for face in below[node]:
            corners = surface.face_vertices[
                surface.face_starts[face] : surface.face_starts[face + 1]
            ]
            away = surface.vertices[corners] - centres[group, :, k]
            assert (np.abs(np.linalg.solve(axes.T, away.T).T) <= half).all()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of the cache, empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "clearance" / "surfaces"


def round_one(height: float = 0.3) -> Polyhedron:
    shape = cylinder(0.1, height, tolerance=1e-6)
    assert shape.n_faces >= tree.LARGE
    return shape


class Builder:
    """Builds surfaces and counts how often it was asked to."""

    def __init__(self) -> None:
        self.n_built = 0

    def __call__(self, shape: Polyhedron) -> Surface:
        self.n_built += 1
        return tree._build(shape)


def assert_same_bits(one: Surface, other: Surface) -> None:
    for a, b in zip(one, other, strict=True):
        assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())
        assert a.flags.c_contiguous == b.flags.c_contiguous and b.flags.writeable


@pytest.mark.cold
def test_a_surface_is_built_once_and_comes_back_with_the_same_bits(folder):
    build = Builder()
    built, read = (surface_cache.cached_surface(round_one(), build) for _ in range(2))
    assert build.n_built == 1 and len(list(folder.iterdir())) == 1
    assert_same_bits(built, read)


@pytest.mark.cold
@pytest.mark.parametrize("changed", ["package_digest", "processor"])
def test_other_shapes_and_what_another_program_built_are_built(folder, changed, monkeypatch):
    build = Builder()
    surface_cache.cached_surface(round_one(), build)
    surface_cache.cached_surface(round_one(0.4), build)
    monkeypatch.setattr(surface_cache, changed, lambda: "another")
    surface_cache.cached_surface(round_one(), build)
    assert build.n_built == 3


def with_objects(path: Path) -> None:
    np.savez(path, **dict.fromkeys(Surface._fields, np.array([Path], dtype=object)))


def with_that_of_another_shape(path: Path) -> None:
    surface_cache.cached_surface(round_one(0.4), tree._build)
    (other,) = {*path.parent.iterdir()} - {path}
    os.replace(other, path)


@pytest.mark.cold
@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(path.read_bytes()[:-1]),
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:3000]),
        lambda path: path.write_bytes(path.read_bytes().replace(b"\0\0\0\1", b"\0\0\0\2")),
        lambda path: np.savez(path, vertices=np.zeros((1, 3))),
        with_objects,
        with_that_of_another_shape,
    ],
)
def test_what_is_damaged_or_not_plain_numbers_is_built_again(folder, damage):
    build = Builder()
    built = surface_cache.cached_surface(round_one(), build)
    (path,) = folder.iterdir()
    damage(path)
    for _ in range(2):
        assert_same_bits(built, surface_cache.cached_surface(round_one(), build))
    assert build.n_built == 2


@pytest.mark.cold
def test_where_nothing_can_be_written_it_is_built_each_time(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    build = Builder()
    for _ in range(2):
        surface_cache.cached_surface(round_one(), build)
    assert build.n_built == 2


@pytest.mark.cold
def test_the_oldest_goes_where_the_cache_is_too_large(folder, monkeypatch):
    heights = (0.1, 0.2, 0.3, 0.4)
    for age, height in enumerate(heights):
        surface_cache.cached_surface(round_one(height), tree._build)
        newest = max(folder.iterdir(), key=lambda path: path.stat().st_mtime)
        os.utime(newest, (age, age))
    monkeypatch.setattr(surface_cache, "MOST_BYTES", 4 * newest.stat().st_size)
    build = Builder()
    surface_cache.cached_surface(round_one(0.5), build)
    assert len(list(folder.iterdir())) == 2
    for height in (0.5, 0.4, 0.3):
        surface_cache.cached_surface(round_one(height), build)
    assert build.n_built == 2  # 0.5, and 0.3 which was gone
