"""Marks follow from what a test uses, and the guard holds a test to them."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from importlib import import_module

import pytest

import clearance as cl
from tests import guards, marks
from tests.examples import PROFILES, examples, listed, share_of

FETCH = marks.SHARED_CASES / "fetch_cage_planned"
MODULE = "subprocess"


def starts_a_process():
    return subprocess.run([sys.executable, "-c", ""], check=True)


def starts_one_by_another():
    return starts_a_process()


def drives_a_browser():
    from tests.report.browser import chromium

    return chromium()


def asks_a_peer():
    import fcl

    return fcl


def reads_a_shared_case():
    return FETCH / "case.yaml"


def asks_for_a_cross_check():
    return cl.check("case.yaml", cross_check=True)


def has_what_a_cross_check_said():
    return replace(uses_nothing, cross_check=uses_nothing())


def uses_nothing():
    return sorted([2, 1])


@pytest.mark.parametrize(("function", "expected"), [
    (starts_a_process, {"cold"}), (starts_one_by_another, {"cold"}), (drives_a_browser, {"browser"}),
    (asks_a_peer, {"peer"}), (asks_for_a_cross_check, {"peer"}), (has_what_a_cross_check_said, set()),
    (reads_a_shared_case, {"shared"}), (uses_nothing, set()),
])  # fmt: skip
def test_a_mark_follows_from_what_is_used(function, expected):
    assert marks.marks_of([function]) == expected


def test_this_test_has_no_mark_and_so_starts_no_process(request):
    """What `guards` does to any test that is not marked; the refusals are taken back, since they are wanted."""
    assert not {mark.name for mark in request.node.iter_markers()}
    start = import_module(MODULE).run  # as a library's code does it: nothing in this test says so
    for deed in (lambda: start([sys.executable, "-c", ""]), lambda: os.system("true")):
        with pytest.raises(guards.UnmarkedDeed):
            deed()
    assert len(guards.refused) == 2
    guards.refused.clear()


def test_a_case_beside_the_repository_is_not_read_without_the_mark():
    with pytest.raises(guards.UnmarkedDeed):
        open(guards.SHARED_CASES / "no_such_case")
    guards.refused.clear()


def test_a_profile_draws_its_share_of_the_examples():
    from hypothesis import settings

    share = settings.default.max_examples
    assert share in PROFILES.values()
    assert examples(200).max_examples == 2 * share
    assert examples(1).max_examples == 3


def test_of_listed_examples_a_share_is_taken_all_over_the_list():
    items = [("a", i) for i in range(60)] + [("b", 0), ("c", 0), ("c", 1)]
    kept = listed(items, key=lambda item: item[0])
    of_a = [i for name, i in kept if name == "a"]
    assert len(of_a) == share_of(60) and of_a[0] == 0 and of_a[-1] >= 40
    assert [item for item in kept if item[0] != "a"] == [("b", 0), ("c", 0), ("c", 1)]
    assert kept == sorted(kept)
