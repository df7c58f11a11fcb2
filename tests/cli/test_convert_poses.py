"""`clearance convert` of poses: tables and stamped messages there and back, frames kept or told."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.cli import run
from clearance.formats.known_formats import Kind, suffixes_written
from clearance.formats.motion.pose_writer import written_poses
from clearance.formats.motion.requests import PoseRequest, PoseSamples, read_samples
from tests.examples import examples
from tests.formats.motion.test_pose_formats import STAMPED, pose

SUFFIXES = suffixes_written(Kind.POSES)
TABLE = (
    "time,x,y,z,qx,qy,qz,qw\n"
    "0.0,4.0,0.1,0.30000000000000004,0.0,0.0,0.0,1.0\n"
    "0.4,4.0,0.5,-0.0,0.18257418583505536,0.3651483716701107,0.5477225575051661,0.7302967433402214\n"
    "1.0,4.0,1.0,1e-07,0.0,0.0,1.0,0.0\n"
)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def convert(*arguments: object) -> int:
    return run(["convert", *map(str, arguments)])


def samples_in(content: bytes, name: str) -> PoseSamples:
    return read_samples(PoseRequest(lambda: BytesIO(content)), name).samples


def test_frames_and_stamps_are_kept_between_messages_and_told_of_tables(capsys):
    Path("a.yaml").write_text(STAMPED)
    assert convert("a.yaml", "b.json") == 0
    assert convert("b.json", "c.yaml") == 0
    back = samples_in(Path("c.yaml").read_bytes(), "c.yaml")
    assert (back.frame, back.child, back.stamp) == ("map", "", 1_700_000_000_100_000_000)
    capsys.readouterr()
    assert convert("c.yaml", "d.csv") == 0
    told, warned = capsys.readouterr()
    assert "in frame 'map', taken for what the poses are seen from" in told
    assert "d.csv: the poses are in frame 'map', which a table cannot say" in told
    assert warned.startswith("warning: d.csv: the first sample is stamped 1700000000.1 s, which it")
    assert "`start:`" in warned
    assert convert("d.csv", "e.yaml") == 0
    assert "e.yaml: frame_id is empty" in capsys.readouterr().out


def test_a_frame_that_may_move_is_not_lost_in_a_table(refusal):
    Path("a.yaml").write_text(STAMPED.replace("map", "wrist_camera"))
    assert convert("a.yaml", "b.json") == 0
    told = refusal("convert", "b.json", "c.csv")
    assert "b.json: the poses are in frame 'wrist_camera', which a table cannot say" in told
    assert "on: wrist_camera" in told


def test_transforms_stay_transforms(capsys):
    where = {
        "translation": {"x": 1.0, "y": 0, "z": 0},
        "rotation": {"x": 0, "y": 0, "z": 0, "w": 1},
    }
    moved = [pose(0.0, t) | {"child_frame_id": "door", "transform": where} for t in (1, 2)]
    Path("a.json").write_text(json.dumps({"transforms": moved}))
    assert convert("a.json", "b.yaml") == 0
    back = samples_in(Path("b.yaml").read_bytes(), "b.yaml")
    assert (back.frame, back.child, back.times.tolist()) == ("map", "door", [0.0, 1.0])
    assert convert("b.yaml", "c.csv") == 0
    told = capsys.readouterr().out
    assert "the poses are those of frame 'door', which a table cannot say" in told


def test_times_that_messages_keep_otherwise_are_told(refusal, capsys):
    rows = TABLE.replace("0.4,", "0.3333333333333333,").replace("\n0.0,", "\n0.25,")
    Path("a.csv").write_text(rows)
    assert convert("a.csv", "b.yaml") == 0
    told = capsys.readouterr().out
    assert "note: b.yaml: 1 of 3 times are rounded to nanoseconds" in told
    assert "count from their first, here at 0.25 s: moves: {file: …, start: 0.25}" in told
    assert convert("b.yaml", "c.csv") == 0
    assert Path("c.csv").read_text().splitlines()[2].startswith("0.083333333,4.0")
    Path("a.csv").write_text(TABLE.replace("0.4,", "1e-10,"))
    assert "less than a nanosecond after the one before" in refusal("convert", "a.csv", "d.yaml")


NUMBERS = st.floats(-1e3, 1e3)
TIMES = st.lists(st.integers(1, 10**13), max_size=4, unique=True)
QUATERNIONS = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


@examples(60)
@given(st.data(), TIMES, st.sampled_from(SUFFIXES), st.sampled_from(["", "map", "a: b", "~", "1"]))
def test_any_poses_come_back_bit_for_bit(data, nanoseconds, suffix, child):
    times = np.array([whole / 10**9 for whole in (0, *sorted(nanoseconds))])
    positions = np.array([[data.draw(NUMBERS) for _ in "xyz"] for _ in times])
    turned = np.array([data.draw(QUATERNIONS) for _ in times])
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    stamp = 0 if suffix == ".csv" else 17_000_000_000
    names = ("", "") if suffix == ".csv" else ("o'e", child)
    samples = PoseSamples(times, positions, turned, *names, stamp)
    content, notes = written_poses(samples, f"door{suffix}")
    back = samples_in(content, f"door{suffix}")
    assert not notes and (back.frame, back.child, back.stamp) == (*names, stamp)
    for one, other in (
        (back.times, times), (back.positions, positions), (back.quaternions, turned),
    ):  # fmt: skip
        assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["a.yaml", "b.csv", "--topic", "/a"], "a.yaml: --topic says nothing about a table of poses"),
        (["far.csv", "b.yaml"], "far.csv: line 4: a position is 1e+160 m away"),
        (["off.yaml", "b.csv"], "off.yaml: the quaternion"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_and_leaves_nothing(refusal, words, says):
    Path("a.yaml").write_text(STAMPED)
    Path("off.yaml").write_text(STAMPED.replace("w: 1.0", "w: 0.5"))
    Path("far.csv").write_text(TABLE.replace("1e-07", "1e160"))
    assert says in refusal("convert", *words)
