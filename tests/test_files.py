"""All or nothing: what is left behind when writing fails, at every point where it can fail."""

from __future__ import annotations

import errno
import os
import shutil
import signal
from pathlib import Path
from types import SimpleNamespace

import pytest

from clearance.errors import Unwritable
from clearance.files import fill_folder, write_file, write_files
from clearance.report.output import OWN
from tests.report.made import write
from tests.report.records import record

NAMES = {
    "report.html", "steps.csv", "contacts.csv", "steps.parquet", "findings.json",
    "summary.json", "worst_moments.yaml",
}  # fmt: skip


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def two_files(text: str):
    def fill(place: Path) -> None:
        (place / "steps.csv").write_text(text)
        (place / "summary.json").write_text(text)

    return fill


def test_a_report_is_these_files_and_nothing_else(tmp_path):
    write(record(), tmp_path / "out")
    assert set(contents(tmp_path / "out")) == NAMES
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_the_same_record_gives_the_same_bytes_and_replaces_an_older_report(tmp_path):
    write(record(n_steps=60), tmp_path / "a")
    write(record(), tmp_path / "b" / "deep")
    older = contents(tmp_path / "a")
    write(record(), tmp_path / "a")
    assert contents(tmp_path / "a") == contents(tmp_path / "b" / "deep")
    assert contents(tmp_path / "a") != older


@pytest.mark.parametrize("older", [False, True])
def test_a_full_disk_leaves_everything_as_it_was(tmp_path, older):
    folder = tmp_path / "out"
    if older:
        fill_folder(folder, two_files("old"), OWN)

    def fill(place: Path) -> None:
        two_files("new")(place)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(Unwritable, match="No space left"):
        fill_folder(folder, fill, OWN)
    left = contents(folder) if folder.exists() else {}
    assert left == ({"steps.csv": b"old", "summary.json": b"old"} if older else {})
    assert [path.name for path in tmp_path.iterdir()] == (["out"] if older else [])


@pytest.mark.parametrize("fault", [OSError(errno.EIO, "worn out"), KeyboardInterrupt()])
@pytest.mark.parametrize("i_move", range(4))
def test_a_fault_at_any_move_puts_the_older_report_back(tmp_path, monkeypatch, fault, i_move):
    """Two files beside a foreign one need four moves: each older one away, each new one in."""
    fill_folder(tmp_path / "out", two_files("old"), OWN)
    (tmp_path / "out" / "mine.txt").write_text("mine")
    moves = []
    replace = os.replace

    def faulty(source, target):
        moves.append((source, target))
        if len(moves) == i_move + 1:
            raise fault
        replace(source, target)

    monkeypatch.setattr(os, "replace", faulty)
    with pytest.raises((Unwritable, KeyboardInterrupt)):
        fill_folder(tmp_path / "out", two_files("new"), OWN)
    assert len(moves) > i_move
    whole = {"steps.csv": b"old", "summary.json": b"old", "mine.txt": b"mine"}
    assert contents(tmp_path / "out") == whole


def test_a_folder_that_is_being_replaced_never_looks_whole(tmp_path, monkeypatch):
    """summary.json goes first and comes last: whenever it is there, all files are of one report."""
    fill_folder(tmp_path, two_files("old"), OWN)
    (tmp_path / "mine.txt").write_text("new")
    replace, seen = os.replace, []

    def watched(source, target):
        replace(source, target)
        files = {p.name: p.read_text() for p in tmp_path.iterdir() if p.suffix in (".csv", ".json")}
        seen.append("summary.json" not in files or len(set(files.values())) == 1)

    monkeypatch.setattr(os, "replace", watched)
    fill_folder(tmp_path, two_files("new"), OWN)
    assert len(seen) == 4
    assert all(seen)


def test_a_file_that_only_the_older_report_had_goes(tmp_path):
    def with_pairs(place: Path) -> None:
        two_files("old")(place)
        (place / "pairs.parquet").write_text("old")

    for foreign in ("", "mine.txt"):
        folder = tmp_path / f"out{foreign}"
        fill_folder(folder, with_pairs, OWN)
        if foreign:
            (folder / foreign).write_text("mine")
        fill_folder(folder, two_files("new"), OWN)
        assert sorted(contents(folder)) == sorted(
            filter(None, [foreign, "steps.csv", "summary.json"])
        )


@pytest.mark.cold
@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills a process of its own")
@pytest.mark.parametrize("exchanges", [True, False])
@pytest.mark.parametrize("i_move", range(3))
def test_a_process_killed_at_any_move_leaves_one_report_or_none(tmp_path, exchanges, i_move):
    """Where folders cannot be exchanged in one step, there is none between two renames; never files of two."""
    out = tmp_path / "out"
    fill_folder(out, two_files("old"), OWN)
    child = os.fork()
    if child == 0:
        try:
            die_at_move(i_move, exchanges)
            fill_folder(out, two_files("new"), OWN)
        finally:
            os._exit(0)
    killed = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    assert killed == (i_move < (2 if exchanges else 3))
    found = contents(out) if out.exists() else {}
    assert {*found} in (set(), {"steps.csv", "summary.json"})
    assert len({*found.values()}) <= 1
    assert found or not exchanges


def die_at_move(i_move: int, exchanges: bool) -> None:
    """Kills this process before its move of that number; the last one is after all moves."""
    from clearance import files

    moves = []

    def counted(move):
        def moved(*names, **options):
            if len(moves) == i_move:
                os.kill(os.getpid(), signal.SIGKILL)
            moves.append(names)
            return move(*names, **options)

        return moved

    files._exchanged = counted(files._exchanged) if exchanges else lambda one, other: False
    files.os = SimpleNamespace(**{**vars(os), "rename": counted(os.rename)})
    files.shutil = SimpleNamespace(rmtree=counted(shutil.rmtree))


def test_one_file_is_whole_or_the_older_one(tmp_path, monkeypatch):
    path = tmp_path / "deep" / "junit.xml"
    write_file(path, b"old")

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(Unwritable, match=r"junit\.xml"):
        write_file(path, b"new")
    assert contents(tmp_path / "deep") == {"junit.xml": b"old"}


FRESH = {"case.yaml": b"new", "path.csv": b"new"}


def test_files_of_one_command_are_all_written_or_none(tmp_path, monkeypatch):
    """Over nothing unasked, over no input, and nothing is left of a command that is interrupted."""
    (tmp_path / "mine.txt").write_bytes(b"mine")
    (tmp_path / "path.csv").write_bytes(b"mine")
    for force, read, told in ((False, [], "--force"), (True, ["path.csv"], "this run reads")):
        with pytest.raises(Unwritable, match=told):
            write_files(tmp_path, FRESH, [tmp_path / one for one in read], force=force)
    write = Path.write_bytes

    def interrupted(path, content):
        if path.name == "path.csv":
            raise KeyboardInterrupt
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_files(tmp_path, FRESH, [], force=True)
    assert contents(tmp_path) == {"mine.txt": b"mine", "path.csv": b"mine"}
    monkeypatch.undo()
    write_files(tmp_path, FRESH, [], force=True)
    assert contents(tmp_path) == FRESH | {"mine.txt": b"mine"}
