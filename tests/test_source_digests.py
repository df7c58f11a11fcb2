"""Digests of sources are taken from an earlier run where no source has changed, and never where one has."""

from __future__ import annotations

import os
import time

import pytest

from clearance import import_closure as closures
from clearance import kept_files, source_digests
from clearance.import_closure import digest_of, import_closure


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of two files, changed long ago, and an empty cache."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(source_digests, "SETTLED", 0)
    kept_files.cache_root.cache_clear()
    folder = tmp_path / "clearance"
    (folder / "rooms").mkdir(parents=True)
    for name in ("__init__", "rooms/__init__", "rooms/b"):
        (folder / f"{name}.py").write_text("")
    (folder / "rooms" / "a.py").write_text("from clearance.rooms import b\n")
    yield folder
    kept_files.cache_root.cache_clear()
    source_digests._kept.cache_clear()


def digest_of_a_run(package, **asked):
    """The digest, and how often a run of its own had to work it out."""
    source_digests._kept.cache_clear()
    for known in (closures._imports, closures._module_file, closures._files_down_to):
        known.cache_clear()
    roots = [package / "rooms" / "a.py"]
    worked_out = []

    def counted(*arguments):
        worked_out.append(arguments)
        return digest_of(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(source_digests, "digest_of", counted)
        patch.setattr(source_digests.atexit, "register", lambda *call: ends.append(call))
        ends: list[tuple] = []
        found = source_digests.closure_digest(roots, package, **asked)
    for write, *arguments in ends:
        write(*arguments)
    assert found == digest_of(import_closure(roots, package, **asked), package)
    return found, len(worked_out)


def test_the_second_run_works_nothing_out(package):
    first, n_first = digest_of_a_run(package)
    assert digest_of_a_run(package) == (first, 0)
    assert n_first == 1


def test_another_question_is_another_digest(package):
    whole, _ = digest_of_a_run(package)
    without, n_worked_out = digest_of_a_run(package, leave_out=("rooms",))
    assert (whole != without, n_worked_out) == (True, 1)
    assert digest_of_a_run(package) == (whole, 0)
    assert digest_of_a_run(package, leave_out=("rooms",)) == (without, 0)


def set_back(path, before):
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


@pytest.mark.parametrize("change", ["content", "content with its time set back", "replaced"])
def test_a_source_that_has_changed_is_read_again(package, change):
    first, _ = digest_of_a_run(package)
    path = package / "rooms" / "b.py"
    before = path.stat()
    time.sleep(0.02)  # a clock's grain, which `SETTLED` is there for
    if change == "replaced":
        other = package.parent / "other.py"
        other.write_text("#")
        other.replace(path)
    else:
        path.write_text("#")
    if change != "content":
        set_back(path, before)
    second, n_worked_out = digest_of_a_run(package)
    assert (second != first, n_worked_out) == (True, 1)


def test_a_new_file_that_takes_the_place_of_another_is_seen(package):
    first, _ = digest_of_a_run(package)
    (package / "rooms" / "b").mkdir()
    (package / "rooms" / "b" / "__init__.py").write_text("")
    assert digest_of_a_run(package)[0] != first


def test_of_sources_that_were_changed_just_now_nothing_is_kept(package, monkeypatch):
    monkeypatch.setattr(source_digests, "SETTLED", 60 * 10**9)
    assert digest_of_a_run(package)[1] == 1
    assert digest_of_a_run(package)[1] == 1


def test_what_is_kept_and_damaged_is_worked_out_again(package):
    first, _ = digest_of_a_run(package)
    (kept,) = (package.parent / "kept").rglob("digests-*.json")
    content = kept.read_bytes()
    kept.write_bytes(content[:-5] + b"00000")
    assert digest_of_a_run(package) == (first, 1)


def test_a_file_outside_the_package_counts_with_what_it_imports(tmp_path, package):
    outside = tmp_path / "outside.py"
    outside.write_text("from clearance.rooms import b\n")
    found = source_digests.closure_digest([outside], package)
    assert found == digest_of(import_closure([outside], package), package)
    outside.write_text("from clearance.rooms import a\n")
    assert source_digests.closure_digest([outside], package) != found
