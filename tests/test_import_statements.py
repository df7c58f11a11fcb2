"""What is kept of a source's import statements: for that source only, and never needed."""

from __future__ import annotations

import pytest

from clearance import import_statements as room
from clearance.kept_files import cache_root, read_kept, write_kept


@pytest.fixture
def as_if_new(tmp_path, monkeypatch):
    """Every call begins with what earlier ones have kept in an empty folder, and writes at its end."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))

    def told(path):
        cache_root.cache_clear()
        room._kept.cache_clear()
        parsed = []
        with monkeypatch.context() as patched:
            patched.setattr(
                room.ast, "parse", lambda *a, real=room.ast.parse: parsed.append(a) or real(*a)
            )
            found = room.statements_of(path)
        room._write(room._kept().new)
        return sorted(one.module for one in found), len(parsed)

    yield told
    cache_root.cache_clear()
    room._kept.cache_clear()


def test_a_source_is_parsed_once_and_again_when_it_has_changed(tmp_path, as_if_new):
    path = tmp_path / "a.py"
    path.write_text("import clearance.rooms.b\nfrom . import c\n")
    assert [as_if_new(path), as_if_new(path)] == [(["", "clearance.rooms.b"], n) for n in (1, 0)]
    path.write_text("import clearance.rooms.d\nfrom . import c\n")
    assert as_if_new(path) == (["", "clearance.rooms.d"], 1)


def test_what_others_have_parsed_meanwhile_stays(tmp_path, as_if_new):
    for name in "ab":
        (tmp_path / f"{name}.py").write_text(f"import {name}")
        as_if_new(tmp_path / f"{name}.py")
    assert [as_if_new(tmp_path / f"{name}.py") for name in "ab"] == [(["a"], 0), (["b"], 0)]


def test_what_is_damaged_is_parsed_again(tmp_path, as_if_new):
    path = tmp_path / "a.py"
    path.write_text("import a")
    as_if_new(path)
    (kept,) = (tmp_path / "kept").rglob("*.txt")
    kept.write_bytes(kept.read_bytes().replace(b'"a"', b'"b"'))
    assert as_if_new(path) == (["a"], 1)


def test_it_does_not_grow_for_ever(tmp_path, as_if_new, monkeypatch):
    path = tmp_path / "a.py"
    path.write_text("import a")
    as_if_new(path)
    (old,) = read_kept(room._FOLDER, room._file_name()).splitlines()
    many = [b"%d %b\n" % (n, old.split(b" ", 1)[1]) for n in range(room._MOST)]
    write_kept(room._FOLDER, room._file_name(), b"".join(many))
    as_if_new(path)
    assert len(read_kept(room._FOLDER, room._file_name()).splitlines()) == 1
