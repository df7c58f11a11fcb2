"""Tables in columns: joined from batches, looked at by rows, and the same as tables of pyarrow."""

from __future__ import annotations

import numpy as np

from clearance.record.rows.resumable import IN_MEMORY
from clearance.record.table import Names, Table

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
