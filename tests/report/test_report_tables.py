"""Steps as files: every float comes back as it was, names with commas too."""

from __future__ import annotations

import csv

import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as some

from clearance.report.tables import write_csv, write_parquet
from tests.report.records import record

finite = some.floats(allow_nan=False, allow_infinity=False)


@given(some.lists(finite, min_size=1, max_size=40))
def test_floats_come_back_from_csv_bit_for_bit(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("csv") / "steps.csv"
    write_csv(lambda: [pa.table({"clearance": pa.array(values, pa.float64())})], path)
    with path.open(newline="") as file:
        back = [float(row["clearance"]) for row in csv.DictReader(file)]
    assert [value.hex() for value in back] == [float(value).hex() for value in values]


@pytest.mark.parametrize("name", ["plain", "with, comma", 'with "quotes"', "two\nlines"])
def test_names_come_back_from_csv(tmp_path, name):
    write_csv(lambda: [pa.table({"link": [name], "clearance": [0.1]})], tmp_path / "steps.csv")
    with (tmp_path / "steps.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == [{"link": name, "clearance": "0.1"}]


def test_csv_of_plain_names_has_no_quotes_and_a_header(tmp_path):
    table = pa.table({"step": [0], "link": ["fore"], "clearance": [0.5]})
    write_csv(lambda: [table], tmp_path / "steps.csv")
    assert (tmp_path / "steps.csv").read_text() == "step,link,clearance\n0,fore,0.5\n"


def test_parquet_is_the_table(tmp_path):
    steps = record().steps
    write_parquet([steps], tmp_path / "steps.parquet")
    assert pyarrow.parquet.read_table(tmp_path / "steps.parquet").equals(steps)
