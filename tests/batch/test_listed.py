"""The list of a batch: JSON as any tool reads it, read back as it was, and refused wherever it is cut off."""

import json
from datetime import date
from pathlib import Path

import pytest

from clearance.batch.cases import Cases
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.listed import FILE_NAME, read_list, write_list
from clearance.batch.options import CaseOptions
from clearance.errors import BadInput
from clearance.world.waiver import Waiver

UNTIL = {"at_least": 0.01, "by": "me", "until": date(2027, 3, 31)}


@pytest.fixture
def cases():
    plain = CaseOptions()
    waiver = Waiver(("a", "b"), reason='says "cases": [ and ]}', **UNTIL)
    waived = plain.waived_by((waiver,))
    given = GivenTrajectory("/in/t0.csv", '{"period":0.5}', "left")
    return Cases.of(
        [
            Item(0, "t0", "/in/cell.yaml", given, plain),
            Item(1, 'a {"quoted"} name', "/in/whole.yaml", None, waived),
            Item(2, "tü", "/in/cell.yaml", GivenTrajectory("/in/tü.csv", "{}"), waived),
        ]
    )


def test_it_is_json_and_comes_back(cases, tmp_path):
    write_list(tmp_path, cases)
    text = (tmp_path / FILE_NAME).read_text()
    told = json.loads(text)
    assert text == json.dumps(told, indent=0) + "\n"
    assert [row["name"] for row in told["cases"]] == [item.name for item in cases]
    found = read_list(tmp_path)
    assert list(found) == list(cases)
    assert [one.options.waivers for one in found] == [one.options.waivers for one in cases]


@pytest.mark.slow
def test_one_that_is_cut_off_is_damaged(cases, tmp_path: Path):
    write_list(tmp_path, cases)
    content = (tmp_path / FILE_NAME).read_bytes()
    for n in range(len(content.rstrip())):
        (tmp_path / FILE_NAME).write_bytes(content[:n])
        with pytest.raises(BadInput, match="the list of cases is damaged"):
            read_list(tmp_path)
