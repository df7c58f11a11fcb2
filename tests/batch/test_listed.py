"""The list of a batch comes back from its store as it was, and is refused where it is damaged."""

from datetime import date

import pytest

from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.listed import read_list, write_list
from clearance.batch.options import CaseOptions
from clearance.batch.store import open_store
from clearance.errors import BadInput, MissingFile
from clearance.run import CheckOptions
from clearance.world.waiver import Waiver

UNTIL = {"at_least": 0.01, "by": "me", "until": date(2027, 3, 31)}


@pytest.fixture
def cases():
    plain = CaseOptions.of(CheckOptions(need="limit", today=date(2026, 11, 1)))
    waiver = Waiver(("a", "b"), reason='says "cases": [ and ]}', **UNTIL)
    waived = plain.waived_by((waiver,))
    given = GivenTrajectory("/in/t0.csv", '{"period":0.5}', "left")
    return [
        Item(0, "t0", "/in/cell.yaml", given, plain),
        Item(1, 'a {"quoted"} name', "/in/whole.yaml", None, waived),
        Item(2, "tü", "/in/cell.yaml", GivenTrajectory("/in/tü.csv", "{}"), waived),
        Item(3, "no text", "/in/cell.yaml", GivenTrajectory("/in/\udcff.csv", "{}"), plain),
    ]


def test_it_comes_back(cases, tmp_path):
    with open_store(tmp_path) as store:
        write_list(store, cases[:1])
        write_list(store, cases)
        found = read_list(store)
    assert found == cases
    assert [one.options.key for one in found] == [one.options.key for one in cases]


def test_a_store_without_one_says_so(tmp_path):
    with open_store(tmp_path) as store, pytest.raises(MissingFile, match="no batch was begun"):
        read_list(store)


@pytest.mark.parametrize(
    ("options", "item"),
    [("{", "[1"), ('{"need": 3}', '["/in/cell.yaml", null]'), ("{}", '["/in/cell.yaml"]')],
)
def test_one_that_is_damaged_is_told_in_one_line(options, item, tmp_path):
    with open_store(tmp_path) as store:
        store.write_list([options], [(0, "t0", item, 0)])
        with pytest.raises(BadInput, match="the list of cases is damaged"):
            read_list(store)
