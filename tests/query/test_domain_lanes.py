"""Kernels that read without checks: each domain with every index checked, and as plain Python.

The lane with checks compiles all it comes to, at level 0, into the cache that the user has: checked code has
names of its own there, so that only the first run after a change of kernels pays for it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.query import lane_of_domains

pytestmark = pytest.mark.skipif(
    "CLEARANCE_LANES" not in os.environ,
    reason="minutes of compiling: set CLEARANCE_LANES=1 after a change of kernels",
)

ROOT = Path(__file__).parents[2]
DOMAINS = tuple(lane_of_domains.DOMAINS)


def run_lane(**settings: str) -> dict:
    """The answers of all domains, from a process of its own."""
    ran = subprocess.run(
        [sys.executable, "tests/query/lane_of_domains.py", *DOMAINS],
        env={**os.environ, "PYTHONPATH": str(ROOT), **settings}, cwd=ROOT,
        capture_output=True, text=True, timeout=900, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr[-3000:]
    return json.loads(ran.stdout)


@pytest.fixture(scope="module")
def checked() -> dict:
    return run_lane(NUMBA_BOUNDSCHECK="1", NUMBA_OPT="0")


@pytest.fixture(scope="module")
def plain() -> dict:
    return run_lane(NUMBA_DISABLE_JIT="1")


@pytest.mark.parametrize("domain", DOMAINS)
def test_with_every_index_checked(checked, domain):
    assert checked["bounds"], "indices were not checked"
    assert checked[domain] == json.loads(json.dumps(lane_of_domains.DOMAINS[domain]()))


@pytest.mark.parametrize("domain", DOMAINS)
def test_with_the_jit_off(plain, domain):
    assert plain["bounds"]  # numpy itself checks
    assert plain[domain] == json.loads(json.dumps(lane_of_domains.DOMAINS[domain]()))
