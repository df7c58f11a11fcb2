"""Damage to the structure of every kind of file: it is read, or refused by an error of ours, in little memory."""

from __future__ import annotations

import tracemalloc
import warnings
from pathlib import Path, PurePath
from random import Random

import mujoco  # noqa: F401 - its import starts a process, so it comes before any test
import numpy as np
import pytest

from clearance.errors import BadInput
from clearance.formats.known_formats import ANY, FORMATS, Kind
from tests.examples import share_of, some_slow
from tests.formats.damaged.anywhere import damaged
from tests.formats.damaged.outcome import not_finite, outcome
from tests.formats.damaged.rows import readers

READERS = readers()
SLOW = {
    "bag bag", "bag mcap", "bag mcap states", "bag metadata", "bag rosbag2 sqlite3", "case", "controllers",
    "joint limits", "octomap message", "PlanningScene", "SRDF",
}  # fmt: skip
KINDS = [
    *some_slow([kind for kind in READERS if kind != "STEP"], SLOW),
    pytest.param("STEP", marks=[pytest.mark.cold, pytest.mark.slow]),  # read by another process
]

N_FILES = max(9, share_of(36))
"""Files of a kind whose bytes are damaged: of fewer than nine all may still be readable."""

OPEN_ENDED = {
    "OBJ", "points CSV", "points XYZ", "curves", "profile", "sketch", "joint limits", "controllers",
    "scene", "PlanningScene", "octomap message", "trajectory", "trajectory semicolons", "JointTrajectory",
    "pose table", "poses stamped", "case", "manifest", "batch", "waivers", "program",
}  # fmt: skip
"""Kinds of files of which a beginning can be a file of its own: rows and lines, of which no count is stated."""

MOST_MEMORY = 24_000_000
"""[bytes] What a damaged file of some kilobytes may take while it is read, at its peak."""


def soundly(kind: str, data: bytes, folder: Path) -> str:
    """What comes of a file, in which a warning is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return outcome(READERS[kind], data, folder)


@pytest.mark.parametrize("kind", KINDS)
def test_files_of_another_structure_are_read_or_refused_in_little_memory(kind, tmp_path, capfd):
    reader, of_another_process = READERS[kind], kind == "STEP"
    assert soundly(kind, reader.valid, tmp_path) == "read"
    for seed in range(share_of(4 if of_another_process else 25)):
        data = reader.damage(reader.valid, Random(seed))
        is_measured = seed < 3 and not of_another_process
        if is_measured:
            tracemalloc.start()
        assert soundly(kind, data, tmp_path) in ("read", "refused"), seed
        if is_measured:
            _, peak = tracemalloc.get_traced_memory()
            tracemalloc.stop()
            assert peak < MOST_MEMORY + 1000 * len(data)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", KINDS)
def test_files_cut_off_are_refused(kind, tmp_path, capfd):
    """But where a beginning is a file of its own, and but for the last letters of text."""
    valid = READERS[kind].valid
    ends = range(0, len(valid), max(1, len(valid) // share_of(3 if kind == "STEP" else 60)))
    said = {end: soundly(kind, valid[:end], tmp_path) for end in ends}
    assert {end: one for end, one in said.items() if one not in ("read", "refused")} == {}
    assert "refused" in said.values()
    if kind not in OPEN_ENDED:
        whole = len(valid.rstrip()) - 3
        assert [end for end, one in said.items() if one == "read" and end < whole] == []
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", KINDS)
def test_files_with_other_bytes_are_read_or_refused(kind, tmp_path):
    reader = READERS[kind]
    assert outcome(reader, reader.valid, tmp_path) == "read"
    n_files = 9 if kind == "STEP" else N_FILES
    said = {i: outcome(reader, damaged(reader.valid, 77_000 + i), tmp_path) for i in range(n_files)}
    assert {i: found for i, found in said.items() if found not in ("read", "refused")} == {}
    assert "refused" in said.values()


def test_every_format_that_is_read_has_a_row():
    given = {
        (reader.kind, suffix)
        for reader in READERS.values()
        for suffix in (PurePath(reader.name).suffix, *reader.also)
    }
    read = {(one.kind, suffix) for one in FORMATS if one.read for suffix in one.suffixes}
    assert read - given == {
        (kind, ANY) for kind in (Kind.ROBOT, Kind.SCENE, Kind.POSES, Kind.TRAJECTORY)
    }


@pytest.mark.parametrize(
    ("kind", "suffix"),
    [
        (kind, suffix)
        for kind, reader in READERS.items()
        for suffix in reader.also
        if kind != "STEP"
    ],
)
def test_other_suffixes_are_read_as_the_row_says(kind, suffix, tmp_path):
    reader = READERS[kind]
    other = reader._replace(name=str(PurePath(reader.name).with_suffix(suffix)))
    assert outcome(other, reader.valid, tmp_path) == "read"


def test_a_foreign_error_and_a_message_of_several_lines_are_faults(tmp_path):
    def fails(data, folder, name):
        raise KeyError("x")

    class Rambling(BadInput):
        def __str__(self):
            return "one line\nand another"

    def rambles(data, folder, name):
        raise Rambling("x")

    reader = READERS["OBJ"]
    assert outcome(reader._replace(reads=fails), reader.valid, tmp_path).startswith("KeyError at")
    said = outcome(reader._replace(reads=rambles), reader.valid, tmp_path)
    assert said == "message of several lines"


def test_what_is_not_finite_is_found_where_it_stands():
    assert not_finite({"a": [1.0, (2, np.array([0.0, 1.0]))]}) == ""
    assert not_finite({"a": [1.0, (2, np.array([0.0, np.nan]))]}) == "dict.a.."
    assert not_finite({"a": {"b": float("inf")}}) == "dict.a.b"
