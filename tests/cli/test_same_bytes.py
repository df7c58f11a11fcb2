"""The same run in two processes gives the same bytes, whatever lay in the memory that they were given."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from clearance.record.every_pair import EveryPair
from tests.cart import ROOT, files

ASKED = ["--quiet", "--need", "pairs", "--fail-mm", "1"]
FILL = ("17", "99")
"""What glibc fills memory with that it hands out; pyarrow is told to ask it. Elsewhere chance has to do."""


@pytest.mark.cold
def test_every_file_of_a_report(tmp_path: Path) -> None:
    """Seconds each: two whole runs, with report and page, in processes of their own."""
    case = ROOT / "scenes" / "box_pipe" / "case.yaml"
    reports = []
    for fill in FILL:
        out = tmp_path / fill / "report"
        memory = {"MALLOC_PERTURB_": fill, "ARROW_DEFAULT_MEMORY_POOL": "system"}
        subprocess.run(
            [sys.executable, "-m", "clearance", "check", case, *ASKED, "--out", out],
            env={**os.environ, "PYTHONPATH": str(ROOT), **memory}, check=True,
        )  # fmt: skip
        reports.append(files(out))
    assert "pairs.parquet" in reports[0] and reports[0] == reports[1]


def test_a_name_is_in_a_dictionary_once() -> None:
    """pyarrow leaves room unwritten in the file for one that is there twice."""
    links, obstacles = ["arm", "hand", "arm", "hand"], ["post", "post", "wall", "wall"]
    clearance = np.arange(12.0).reshape(3, 4)
    clearance[0, 0] = np.nan
    every = EveryPair(links, obstacles, clearance)
    for column, names in (("link", ["arm", "hand"]), ("obstacle", ["post", "wall"])):
        (chunk,) = every.table[column].chunks
        assert chunk.dictionary.to_pylist() == names
    rows = every.table.to_pydict()
    assert rows["link"] == 3 * links and rows["obstacle"] == 3 * obstacles
    assert rows["step"] == [0] * 4 + [1] * 4 + [2] * 4
    assert rows["clearance"] == [None, *range(1, 12)], "null where a pair is not measured"
    assert pa.types.is_dictionary(every.table.schema.field("link").type)
