"""A process that forks while a thread asks a query: the child asks it too, and gets the same answers."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.cold

PROGRAM = """
import os, sys, threading
import numpy as np
import clearance as cl
from tests.made_cases import at, ball

query = cl.Query(ball(1.0, 3), ball(0.5, 3))
poses = np.array([at(1.6 + 0.001 * (i % 200)) for i in range(4000)])
before = query.distances(None, poses[:200]).distances
stop = threading.Event()

def ask():
    while not stop.is_set():
        query.distances(None, poses)

asking = threading.Thread(target=ask, daemon=True)
asking.start()
while not query._lock.locked():
    pass
failed = 0
for _ in range(3):
    child = os.fork()
    if child == 0:
        same = (query.distances(None, poses[:200]).distances == before).all()
        os._exit(0 if same and query.distance(None, poses[0]).distance == before[0] else 1)
    failed += os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
stop.set()
asking.join()
sys.exit(failed)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_child_asks_the_query_that_another_thread_was_asking() -> None:
    """The time limit only ends a child that hangs."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], timeout=300, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
