"""The guard holds a test to its marks, and a profile takes its share of the examples."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests import guards
from tests.examples import PROFILES, examples, listed, share_of


def test_this_test_has_no_mark_and_so_starts_no_process(request):
    """What `guards` does to any test that is not marked; the refusals are taken back, since they are wanted."""
    assert not {mark.name for mark in request.node.iter_markers()}
    start = subprocess.run
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
