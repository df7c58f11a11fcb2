"""Tables in columns, the status of a row, and the folder of resumable rows, which goes through no link."""

from __future__ import annotations

import itertools
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from clearance.errors import Unwritable
from clearance.record.rows import folder as rows_folder
from clearance.record.rows.folder import LOCK, MARK
from clearance.record.rows.resumable import IN_MEMORY, open_resumable_rows
from clearance.record.status import STATUSES, status_codes, status_of
from clearance.record.table import Names, Table
from clearance.world.case import Limits


class Interrupted(BaseException):
    """Stands for Ctrl-C."""


def everything(folder: Path) -> dict[str, bytes | str | None]:
    """Every file's content, every link's target, every folder, below `folder`."""
    return {
        str(path.relative_to(folder)): os.readlink(path)
        if path.is_symlink()
        else path.read_bytes()
        if path.is_file()
        else None
        for path in sorted(folder.rglob("*"))
    }


def left_by_an_interrupted_run(place: Path) -> None:
    with pytest.raises(Interrupted), open_resumable_rows(place, print) as kept:
        kept.ask("the question before")
        kept.array("steps.clearance", (10,))
        kept.log("steps", [slice(0, 10)]).note(1, {}, last=True)
        raise Interrupted


def a_link_to_a_folder(place: Path) -> None:
    place.symlink_to(place.parent / "precious")


def a_link_to_what_a_run_has_left(place: Path) -> None:
    left_by_an_interrupted_run(place.parent / "precious" / "left")
    place.symlink_to(place.parent / "precious" / "left")


def a_link_that_leads_nowhere(place: Path) -> None:
    place.symlink_to(place.parent / "nowhere")


def a_file(place: Path) -> None:
    place.write_text("mine")


def an_empty_folder(place: Path) -> None:
    place.mkdir(mode=0o700)


def a_folder_with_files(place: Path) -> None:
    shutil.copytree(place.parent / "precious", place)
    place.chmod(0o700)


def a_folder_with_an_empty_lock(place: Path) -> None:
    a_folder_with_files(place)
    (place / LOCK).touch()


def a_folder_with_a_lock_elsewhere(place: Path) -> None:
    a_folder_with_files(place)
    (place.parent / "lock elsewhere").write_bytes(MARK)
    (place / LOCK).symlink_to(place.parent / "lock elsewhere")


def a_marked_folder_that_others_can_write(place: Path) -> None:
    left_by_an_interrupted_run(place)
    place.chmod(0o777)


def a_marked_folder_of_another_user(place: Path) -> None:
    left_by_an_interrupted_run(place)
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        pytest.skip("only root can give a folder away")
    os.chown(place, 12345, 12345)


FOREIGN = [
    a_link_to_a_folder, a_link_to_what_a_run_has_left, a_link_that_leads_nowhere, a_file,
    an_empty_folder, a_folder_with_files, a_folder_with_an_empty_lock,
    a_folder_with_a_lock_elsewhere, a_marked_folder_that_others_can_write,
    a_marked_folder_of_another_user,
]  # fmt: skip


@pytest.mark.skipif(os.name == "nt", reason="other links and rights")
@pytest.mark.parametrize("plant", FOREIGN)
def test_what_we_have_not_made_is_refused_and_left_as_it_is(
    tmp_path: Path, plant: Callable[[Path], None]
) -> None:
    (tmp_path / "precious" / "deep").mkdir(parents=True)
    (tmp_path / "precious" / "deep" / "thesis.txt").write_text("years of work")
    (tmp_path / "precious" / "question.json").write_text("the question before")
    place = tmp_path / ".out.unfinished"
    plant(place)
    before = everything(tmp_path)
    with (
        pytest.raises(Unwritable, match="move it away") as caught,
        open_resumable_rows(place, print) as kept,
    ):
        kept.ask("another question")
    assert str(place) in str(caught.value)
    assert everything(tmp_path) == before


def test_a_link_that_has_come_since_is_not_followed(tmp_path: Path) -> None:
    """Whoever can rename in the folder above may do so at any moment."""
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("years of work")
    place = tmp_path / "kept"
    with pytest.raises(Unwritable), open_resumable_rows(place, print) as kept:
        place.rename(tmp_path / "aside")
        place.symlink_to(precious)
        kept.ask("question")
    assert everything(precious) == {"thesis.txt": b"years of work"}


def test_what_a_run_has_left_is_taken_by_the_next(tmp_path: Path) -> None:
    place = tmp_path / "kept"
    left_by_an_interrupted_run(place)
    assert place.stat().st_mode & 0o077 == 0
    with open_resumable_rows(place, print) as kept:
        kept.ask("the question before")
        assert (place / "steps.clearance.rows").exists()
    assert list(tmp_path.iterdir()) == []


def test_of_two_runs_that_start_at_once_one_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second finds no folder, and one when it is about to put its own there."""
    place, lexists, ways = tmp_path / "kept", os.path.lexists, []

    def seen_too_early(path: Path) -> bool:
        found = lexists(path)
        if not ways:
            ways.append(open_resumable_rows(place, print))
            ways[0].__enter__()
        return found

    monkeypatch.setattr(rows_folder.os.path, "lexists", seen_too_early)
    with (
        pytest.raises(Unwritable, match="another run is writing"),
        open_resumable_rows(place, print),
    ):
        pass
    assert (place / LOCK).read_bytes() == MARK
    ways[0].__exit__(None, None, None)
    assert list(tmp_path.iterdir()) == []


def test_a_number_has_the_status_of_a_row() -> None:
    clearances = [-0.01, -0.0, 0.0, 1e-300, 0.004, 0.005, 0.01, 0.02, 0.03, np.inf, np.nan]
    limits = [Limits(), Limits(0.005), Limits(0.005, 0.02)]
    for own, touches in itertools.product(limits, (None, False, True)):
        touching = None if touches is None else np.full(len(clearances), touches)
        codes = status_codes(np.array(clearances), own, touching)
        rows = [str(STATUSES[code]) for code in codes]
        assert [status_of(value, own, touches) for value in clearances] == rows


def test_what_is_at_a_limit_keeps_it_and_at_0_it_is_broken() -> None:
    clearances = np.array([0.0, 0.0049, 0.005, 0.0199, 0.02])
    apart = np.zeros(5, dtype=bool)
    told = ["violated", "violated", "near", "near", "clear"]
    assert [STATUSES[code] for code in status_codes(clearances, Limits(0.005, 0.02), apart)] == told
    (code,) = status_codes(np.zeros(1), Limits(), np.zeros(1, dtype=bool))
    assert STATUSES[code] == "violated" and status_of(0.0, Limits()) == "contact"


FIRST = Table({"gap": np.array([0.5, np.nan]), "move": Names(np.array([1, -1]), ["a", "b"])})
SECOND = Table({"gap": np.array([0.25]), "move": Names(np.array([0]), ["c", "b"])})
ROWS = [{"gap": 0.5, "move": "b"}, {"gap": None, "move": None}, {"gap": 0.25, "move": "c"}]


def test_batches_with_other_names_are_one_table():
    table = IN_MEMORY.table("table", 3, [FIRST, SECOND])
    assert [table.row(i) for i in range(3)] == table.arrow().to_pylist() == ROWS
    assert table.names("move").places_in(["c", "d", "b"]).tolist() == [2, -1, 0]


def test_names_are_the_same_in_pyarrow_however_many_rows_there_are(monkeypatch):
    few = FIRST.arrow()
    monkeypatch.setattr("clearance.record.table.FEW", 0)
    assert FIRST.arrow().equals(few)
