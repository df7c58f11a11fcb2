"""Tables of digests against a dict, and cases against the items that they were made of."""

import numpy as np
import pytest

from clearance.batch.cases import Cases, Texts
from clearance.batch.digest_table import NONE, DigestTable, digest_of_text
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.known_hashes import KnownHashes
from clearance.batch.options import CaseOptions
from clearance.batch.row_index import RowIndex


@pytest.mark.parametrize("width", [8, 16, 32])
def test_digests_are_numbered_as_a_dict_would(width):
    rng = np.random.default_rng(width)
    # many that begin alike: the first byte says where to look
    digests = [bytes([i % 3]) + bytes(7) + rng.bytes(width - 8) for i in range(300)]
    digests += [rng.bytes(width) for _ in range(700)]
    table, known = DigestTable(width), {}
    for digest in [*digests, *digests[::7]]:
        assert table.find(digest) == known.get(digest, NONE)
        assert table.enter(digest) == known.setdefault(digest, len(known))
    assert len(table) == len(known)
    assert [table[i] for i in range(len(table))] == list(known)
    assert table.find(bytes([255]) * width) == NONE


def test_names_of_files_need_not_be_text():
    texts = Texts()
    for text in ("", "a", "Ü" * 3, "\udcff.csv"):
        texts.append(text)
    assert [texts[i] for i in range(len(texts))] == ["", "a", "Ü" * 3, "\udcff.csv"]
    assert digest_of_text("\udcff") != digest_of_text("\udcfe")


def items():
    first, other = CaseOptions(), CaseOptions(need="steps")
    given = [
        ("/a/in/t0.csv", "/a/in/cell.yaml", first),
        ("/a/in/more/t1.csv", "/a/in/cell.yaml", first),
        ("/elsewhere/t2.csv", "/a/in/cell.yaml", other),
        ("/t3.csv", "/b/cell.yaml", first),
    ]
    for i, (path, cell, options) in enumerate(given):
        yield Item(i, f"n{i}", cell, GivenTrajectory(path, "{}", "left" if i else None), options)
    yield Item(4, "whole", "/a/whole/case.yaml", None, first)


def test_cases_are_the_items_that_they_were_made_of():
    cases = Cases.of(items())
    assert list(cases) == list(items()) and len(cases) == 5
    assert cases[-1].name == "whole" and [one.number for one in cases[1::2]] == [1, 3]
    assert [one.number for one in cases[1:].among([3, 0])] == [4, 1]
    assert list(cases[::2].names()) == ["n0", "n2", "whole"] and cases.name(3) == "n3"
    assert cases.cells == ["/a/in/cell.yaml", "/b/cell.yaml"]
    assert [one.number for one in cases.of_cell("/a/in/cell.yaml")] == [0, 1, 2]
    assert cases.options == [CaseOptions(), CaseOptions(need="steps")]
    with pytest.raises(IndexError):
        cases[5]


def test_of_two_rows_of_a_key_the_later_generation_counts_then_the_first():
    keys, index = [f"{i:064x}" for i in range(3)], RowIndex()
    index.enter("late", 1, keys[:1], ["a"], ["x"])
    index.enter("early", 0, keys, ["a", "a", "b"], ["x", "y", "x"])
    index.enter("later", 2, keys[1:2], ["a"], ["z"])
    index.enter("again", 2, keys[1:2], ["a"], ["z"])
    assert [index.place(index.find(key)) for key in keys] == [(0, 0), (2, 0), (1, 2)]
    assert index.find("f" * 64) == NONE and len(index) == 3
    assert list(index.inputs("a")) == [(0, 0), (1, 1), (2, 0)]
    assert list(index.inputs("b")) == [(1, 2)] and list(index.inputs("c")) == []


def test_known_hashes_come_back_from_their_table():
    known = KnownHashes()
    for i in range(20):
        assert known.learn(f"/t{i % 10}.csv", (1, i, 3, 4, 5), f"{i:064x}")
    assert not known.learn("/t9.csv", (1, 19, 3, 4, 5), f"{19:064x}")
    again = KnownHashes.of(known.table().to_batches(max_chunksize=3))
    for one in (known, again):
        assert len(one) == 10
        assert one.find("/t3.csv", (1, 13, 3, 4, 5)) == f"{13:064x}"
        assert one.find("/t3.csv", (1, 3, 3, 4, 5)) is None  # what it was before
        assert one.find("/t4.csv", (1, 13, 3, 4, 5)) is None  # another file of these marks
    with pytest.raises(KeyError):
        KnownHashes.of(known.table().select(["path"]).to_batches())
    with pytest.raises(ValueError):
        KnownHashes.of([*known.table().to_batches()] * 2)
