"""Batches that start at once on a folder that is no store yet: each finds, or makes, the one store."""

import os
from pathlib import Path

import pytest

from clearance.batch.mark import MARK
from clearance.batch.output import withdraw_answer
from clearance.batch.store import open_store
from clearance.errors import Unwritable

ASKED = [(Path, "exists"), (Path, "is_dir"), (Path, "iterdir"), (Path, "mkdir"), (os, "replace")]
"""What opening asks the file system, before each of which another process may run."""


class Preempted:
    """Opens a store, and lets another one be opened and written to just before the `n`-th step of that."""

    def __init__(self, monkeypatch, place: Path, n: int) -> None:
        self.place, self.left = place, n
        for owner, name in ASKED:
            monkeypatch.setattr(owner, name, self._watched(getattr(owner, name)))

    def _watched(self, real):
        def step(*given, **options):
            self.left -= 1
            if self.left == -1:
                withdraw_answer(open_store(self.place), 1)
            return real(*given, **options)

        return step


@pytest.mark.parametrize("made", [False, True], ids=["no folder", "an empty folder"])
def test_another_that_runs_between_any_two_steps_is_no_folder_of_something_else(
    tmp_path, monkeypatch, made
):
    n, all_steps = 0, False
    while not all_steps:
        place = tmp_path / str(n)
        if made:
            place.mkdir()
        with monkeypatch.context() as patched:
            other = Preempted(patched, place, n)
            store = open_store(place)
        all_steps = other.left >= 0
        assert (store.place, len(store)) == (place, 0) and (place / MARK).is_file()
        n += 1
    assert n > 6


def test_what_a_process_that_was_ended_left_of_its_mark_is_no_hindrance(tmp_path):
    (tmp_path / f".{MARK}-1a2b.partial").write_text("{")
    assert len(open_store(tmp_path)) == 0


@pytest.mark.parametrize("name", ["robot.urdf", "store.json.partial", ".git"])
def test_a_folder_with_something_in_it_is_refused(tmp_path, name):
    (tmp_path / name).write_text("")
    with pytest.raises(Unwritable, match="is a folder of something else"):
        open_store(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [name]
