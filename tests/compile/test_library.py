"""The library of kernels: its manifest, the hashes of its sources, and which file a processor takes."""

from __future__ import annotations

import json
import platform
from pathlib import Path

import pytest

from clearance.compile import build, library, manifest, sources
from clearance.compile.manifest import Manifest, is_current, read_manifest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(manifest, "FOLDER", tmp_path)
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    return tmp_path


def write(folder, **changes) -> None:
    found = Manifest("abc", is_linked=True, sizes={})._replace(**changes)
    (folder / "manifest.json").write_text(json.dumps(found._asdict()))


def test_in_a_wheel_no_source_is_read(folder):
    write(folder, is_checked=False)
    assert is_current(lambda: pytest.fail("the sources are read"), ["x86-64-v2"])


@pytest.mark.parametrize("text", ["", '{"sources": "a', "[]", '{"sources": "abc"}', "\xff"])
def test_a_manifest_that_is_damaged_says_nothing(folder, text):
    (folder / "manifest.json").write_text(text, encoding="latin-1")
    assert read_manifest() is None and not is_current(lambda: "abc", [])


def test_a_library_of_which_a_file_is_cut_off_or_missing_is_not_current(folder):
    file = folder / "kernels-x86-64-v2.so"
    write(folder, sizes={file.name: 3})
    assert not is_current(lambda: "abc", [])
    file.write_bytes(b"ab")
    assert not is_current(lambda: "abc", [])
    file.write_bytes(b"abc")
    assert is_current(lambda: "abc", [])


def test_a_library_for_other_processors_is_not_current(folder):
    file = folder / "kernels-x86-64-v2.so"
    file.write_bytes(b"abc")
    write(folder, sizes={file.name: 3})
    assert is_current(lambda: "abc", ["x86-64-v2"])
    assert not is_current(lambda: "abc", ["x86-64-v3"])


def test_a_level_that_does_not_exist_is_refused_in_one_line():
    with pytest.raises(SystemExit) as refused:
        build.main(["x86-64-v9"])
    said = "error: no level of processor is called 'x86-64-v9'; all, "
    assert str(refused.value).startswith(said)


@pytest.mark.parametrize(("is_linked", "suffix"), [(True, "so"), (False, "zip")])
@pytest.mark.parametrize("n_bytes", [None, 0, 2, 3])
def test_a_damaged_library_is_refused_in_one_line(folder, monkeypatch, is_linked, suffix, n_bytes):
    monkeypatch.setattr(library, "KERNELS", "built")
    file = folder / f"kernels-{library.processor_level()}.{suffix}"
    if n_bytes is not None:
        file.write_bytes(b"abc"[:n_bytes])
    write(folder, sizes={file.name: 3}, is_linked=is_linked, is_checked=False)
    with pytest.raises(library.Unavailable) as refused:
        library._opened.__wrapped__()
    assert str(refused.value).startswith("the compiled kernels cannot be loaded: ")
    assert str(refused.value).endswith("install clearance again")
    assert ("missing or cut off" in str(refused.value)) == (n_bytes != 3)


def test_without_the_compiler_a_missing_library_is_one_line(folder, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr(library, "KERNELS", "built")
    with pytest.raises(library.Unavailable) as refused:
        library._opened.__wrapped__()
    assert str(refused.value) == (
        "the kernels are not compiled yet, and the compiler numba is not installed; "
        "pip install -e '.[jit]' in the folder of the sources installs it"
    )


V3 = "avx avx2 bmi1 bmi2 f16c fma abm movbe sse4_2"


@pytest.mark.parametrize(
    ("machine", "flags", "level"),
    [
        ("x86_64", V3, "x86-64-v3"), ("x86_64", "sse4_2 avx", "x86-64-v2"),
        ("x86_64", V3.replace("fma ", ""), "x86-64-v2"), ("AMD64", "", "x86-64-v2"),
        ("aarch64", "", "aarch64"), ("arm64", "", "arm64"),
    ],
)  # fmt: skip
def test_a_processor_takes_the_best_that_is_built_for_it(monkeypatch, machine, flags, level):
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(library, "_flags", lambda: set(flags.split()))
    assert library.processor_level() == level
    assert level in build.all_levels()


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
