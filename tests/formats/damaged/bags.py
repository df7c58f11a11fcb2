"""Small bags in each container that rosbags writes; of a folder its one file with the messages."""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path

from tests.formats.making_bags import planned, state, write_bag


@functools.cache
def bag(container: str) -> bytes:
    """A bag of one planned motion."""
    return _written(container, {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]})


def states(container: str) -> bytes:
    """A bag of what two joints did."""
    seen = [state(i, [0.1 * i, 0.2], velocities=[0.1, 0.0]) for i in range(3)]
    return _written(container, {"/joint_states": seen})


def bag_metadata() -> bytes:
    """What stands beside the messages in a folder of rosbag2 in sqlite3."""
    with tempfile.TemporaryDirectory() as folder:
        topics = {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]}
        path = write_bag(Path(folder) / "made", "rosbag2 sqlite3", topics)
        return (path / "metadata.yaml").read_bytes()


def _written(container: str, topics: dict) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = write_bag(Path(folder) / "made", container, topics)
        return (next(path.glob("*.db3")) if path.is_dir() else path).read_bytes()
