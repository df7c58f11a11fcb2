"""What a row of a batch says of a run, and what it is made without."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.batch.manifest import items_of
from clearance.batch.measuring import read_item
from clearance.batch.rows import curve_of, row_of
from clearance.record.row_status import status_counts
from clearance.run import answer
from tests.batch.batches import write_cell


@pytest.mark.parametrize("certify", [False, True])
def test_the_row_of_a_case_is_made_without_the_table_of_its_steps(tmp_path, certify):
    (item,) = items_of([str(write_cell(tmp_path, [0.02]))], dict(certify=certify))
    run = answer(item.options.question(read_item(item).case))
    row = row_of(run)
    assert "steps" not in vars(run.record)
    assert row["measured"] == "violated"
    told = status_counts(run.record)
    assert [name for name, number in told.items() if number][-1] == row["measured"]
    known = run.record.clearances
    assert np.float32(np.nanmin(known)) >= np.min(curve_of(run.record))
