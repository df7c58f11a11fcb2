"""What is written down of the library, and which of its files a processor takes."""

from __future__ import annotations

import json
import platform

import pytest

from clearance.compile import build, library, manifest
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
