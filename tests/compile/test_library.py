"""What is written down of the library, and which of its files a processor takes."""

from __future__ import annotations

import json
import platform

import pytest

from clearance.compile import build, library, manifest
from clearance.compile.decorators import KERNELS
from clearance.compile.manifest import Manifest, is_current, read_manifest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(manifest, "FOLDER", tmp_path)
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    return tmp_path


def write(folder, **changes) -> None:
    found = Manifest("abc", is_linked=True)._replace(**changes)
    (folder / "manifest.json").write_text(json.dumps(found._asdict()))


def test_without_a_manifest_nothing_is_current(folder):
    assert read_manifest() is None and not is_current(lambda: "abc")


def test_in_sources_the_hash_decides(folder):
    write(folder)
    assert is_current(lambda: "abc") and not is_current(lambda: "abd")


def test_in_a_wheel_no_source_is_read(folder):
    write(folder, is_checked=False)
    assert is_current(lambda: pytest.fail("the sources are read"))


def test_without_the_compiler_a_missing_library_is_one_line(folder, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
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
    assert level in build.levels()


@pytest.mark.skipif(KERNELS != "built", reason="the library is not used")
def test_a_symbol_that_the_library_has_not_is_none():
    assert library.built_address("clearance_take")
    assert library.built_address("clearance_no_such_kernel") is None
