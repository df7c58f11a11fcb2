"""Hashes of kernels: an edit touches the kernels that import what was edited, and no others."""

from __future__ import annotations

from pathlib import Path

import pytest

from clearance.compile import sources

ROOM = sorted(Path(sources.__file__).parent.glob("*.py"))


@pytest.fixture
def package(tmp_path, monkeypatch) -> Path:
    """Kernels a and b, where a imports c; none of them is ever imported."""
    package = tmp_path / "clearance"
    texts = {
        "kernels/__init__": "", "kernels/room/__init__": "",
        "kernels/a": "from clearance.kernels.room import c\n", "kernels/b": "x = 1\n",
        "kernels/room/c": "from clearance.kernels.room.d import y\n", "kernels/room/d": "y = 1\n",
        **{f"compile/{file.stem}": "" for file in ROOM},
    }  # fmt: skip
    for name, text in texts.items():
        file = package / f"{name}.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    monkeypatch.setattr(sources, "PACKAGE", package)
    return package


def digests() -> list[str]:
    for cached in (sources.digest_of, sources._imports):
        cached.cache_clear()
    modules = [sources.digest_of(f"clearance.kernels.{name}") for name in "ab"]
    return [*modules, sources.digest_of_sources()]


@pytest.fixture(autouse=True)
def forget():
    yield
    sources.digest_of.cache_clear()
    sources._imports.cache_clear()


@pytest.mark.parametrize(
    ("edited", "changes"),
    [
        ("kernels/a", [True, False, True]), ("kernels/b", [False, True, True]),
        ("kernels/room/c", [True, False, True]), ("kernels/room/d", [True, False, True]),
        ("compile/objects", [True, True, True]), ("compile/linking", [False, False, True]),
        ("compile/calls", [False, False, False]),
    ],
)  # fmt: skip
def test_an_edit_changes_the_hashes_of_what_depends_on_it(package, edited, changes):
    before = digests()
    file = package / f"{edited}.py"
    file.write_text(file.read_text() + "# edited\n")
    assert [a != b for a, b in zip(before, digests(), strict=True)] == changes


def test_another_compiler_changes_the_hash_of_a_kernel_and_needs_no_new_library(
    package, monkeypatch
):
    before = digests()
    monkeypatch.setattr(sources, "_compilers", lambda: "numba 99.0")
    assert [a != b for a, b in zip(before, digests(), strict=True)] == [True, True, False]


def test_every_module_of_kernels_is_listed(package):
    assert sources.modules() == [
        f"clearance.kernels.{name}" for name in ("a", "b", "room.c", "room.d")
    ]
