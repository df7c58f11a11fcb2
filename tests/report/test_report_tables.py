"""Steps as files: every float comes back as it was, names with commas too."""

from __future__ import annotations

import csv

import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as some

import clearance as cl
from clearance.report.tables import write_csv
from clearance.report.topics.worst import sensitivity_blocks, sensitivity_data
from tests.gains.gantries import along_x, gantry, slot, standing

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


def table_of(case):
    data = sensitivity_data(cl.check(case).report.sensitivity)
    return data, repr(sensitivity_blocks(data, several_robots=False))


def test_one_number_says_both_ways():
    data, text = table_of(slot(fail=0.04, off=0.03))
    (rate,) = (one for one in data["rates"] if one["kind"] == "joint" and one["name"] == "y")
    assert rate["both_ways"] and "one way" not in text
    assert "+1.000" in text and "-1.000" in text and "obstacle left, y" in text


def test_what_holds_one_way_only_says_so():
    data, text = table_of(slot(fail=0.04, off=0.0))
    assert len(data["pairs"]) == 2
    assert "each figure holds in its direction only" in text and "As near are" in text


def test_of_bodies_in_contact_it_is_not_worked_out():
    post = standing("post", cl.box((0.1,) * 3), (0, 0, 0))
    data, text = table_of(cl.Case("hit", (along_x(gantry()),), (post,)))
    assert data["rates"] == [] and "not computed: the bodies are in contact" in text
