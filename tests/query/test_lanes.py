"""Kernels that read without checks: each domain as plain Python, where numpy checks every index.

What that cannot show is how compiled code reads. To compile a domain with every index checked takes minutes:

    CLEARANCE_KERNELS=jit NUMBA_BOUNDSCHECK=1 PYTHONPATH=. python tests/query/lane_of_domains.py search sweep
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.query import lane_of_domains

pytestmark = pytest.mark.cold

ROOT = Path(__file__).parents[2]
DOMAINS = tuple(lane_of_domains.DOMAINS)


def run_lane(*domains: str, **settings: str) -> dict:
    """The answers of some domains, from a process of its own."""
    ran = subprocess.run(
        [sys.executable, "tests/query/lane_of_domains.py", *domains],
        env={**os.environ, "PYTHONPATH": str(ROOT), **settings}, cwd=ROOT,
        capture_output=True, text=True, timeout=900, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr[-3000:]
    return json.loads(ran.stdout)


@pytest.fixture(scope="module")
def plain() -> dict:
    return run_lane(*DOMAINS, CLEARANCE_KERNELS="python")


@pytest.mark.parametrize("domain", DOMAINS)
def test_as_plain_python(plain, domain):
    assert plain["bounds"]  # numpy itself checks
    assert plain[domain] == json.loads(json.dumps(lane_of_domains.DOMAINS[domain]()))
