"""The guard holds a test to its marks."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests import guards


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
