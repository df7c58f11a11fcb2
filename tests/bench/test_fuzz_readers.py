"""Some dozens of damaged files of every kind: each is read or refused by an error of ours."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco  # noqa: F401 - its import starts a process, so it comes before any test
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

from scripts.bench.fuzz_readers import damaged, outcome
from scripts.bench.fuzz_seeds import readers
from tests.examples import share_of, some_slow

READERS = readers()

N_FILES = max(9, share_of(36))
"""Damaged files of a kind: of fewer than nine all may still be readable."""

KINDS = [
    *some_slow([kind for kind in READERS if kind != "STEP"], {"case"}),
    pytest.param("STEP", marks=[pytest.mark.cold, pytest.mark.slow]),  # read by another process
]


@pytest.mark.parametrize("kind", KINDS)
def test_damaged_files_are_read_or_refused(kind, tmp_path):
    reader = READERS[kind]
    assert outcome(reader, reader.valid, tmp_path) == "read"
    said = {i: outcome(reader, damaged(reader.valid, 77_000 + i), tmp_path) for i in range(N_FILES)}
    assert {i: found for i, found in said.items() if found not in ("read", "refused")} == {}
    assert "refused" in said.values()


def test_the_same_seed_does_the_same_damage():
    valid = READERS["OBJ"].valid
    assert [damaged(valid, i) for i in range(9)] == [damaged(valid, i) for i in range(9)]
    assert len({damaged(valid, i) for i in range(9)}) > 5


def test_a_foreign_error_and_a_message_of_several_lines_are_faults(tmp_path):
    def fails(data, folder, name):
        raise KeyError("x")

    reader = READERS["OBJ"]._replace(reads=fails)
    assert outcome(reader, reader.valid, tmp_path).startswith("KeyError at")
