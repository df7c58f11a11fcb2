"""The cache of searchable forms: the same bits come back, nothing that is executed, and no run needs it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from clearance.geometry import surface_cache, tree
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import cylinder
from clearance.kernels.mesh.surface import Surface

pytestmark = pytest.mark.cold


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


def test_a_surface_is_built_once_and_comes_back_with_the_same_bits(folder):
    build = Builder()
    built, read = (surface_cache.cached_surface(round_one(), build) for _ in range(2))
    assert build.n_built == 1 and len(list(folder.iterdir())) == 1
    assert_same_bits(built, read)


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


def test_where_nothing_can_be_written_it_is_built_each_time(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    build = Builder()
    for _ in range(2):
        surface_cache.cached_surface(round_one(), build)
    assert build.n_built == 2


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
