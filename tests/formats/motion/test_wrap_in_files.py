"""Which way round continuous joints go by what files say: a table asks, a recording goes the shortest way."""

import numpy as np
import pytest

from clearance import load_case
from clearance.case.recorded_run import with_recorded
from clearance.cli import run
from clearance.errors import BadInput
from clearance.formats.motion.joint_states import JointState, trajectory_of_states
from clearance.world.motion import kinematic_motion
from clearance.world.plausibility import notices_of
from tests.formats.making import ARM
from tests.formats.making_case import changed, load_small

SPINS = ARM.replace('type="revolute"', 'type="continuous"').replace("<limit", "<unused")
AROUND = "time,shoulder\n0,2.6\n1,3.1\n2,-2.8\n3,-2.6331853\n"
"""A smooth turn from 2.6 to 3.65 rad, written in (-pi, pi]."""


def load(folder, key="", trajectory=AROUND, urdf=SPINS, **files):
    case = changed("file: path.csv", f"file: path.csv{key}")
    return load_small(folder, case, urdf=urdf, trajectory=trajectory, **files)


def kinds(case):
    return [one.kind for one in notices_of(case)]


def course(case):
    return case.robots[0].trajectory.positions[:, 0]


def test_a_table_is_suspect_until_the_case_says_which_way_it_goes(tmp_path):
    assert kinds(load(tmp_path)) == ["wrap"] and course(load(tmp_path))[2] == -2.8
    case = load(tmp_path, ", wrap: shortest")
    assert kinds(case) == []
    assert course(case) == pytest.approx([2.6, 3.1, 2 * np.pi - 2.8, 3.65], abs=1e-6)
    said = "steps of more than half a turn go the shortest way (wrap: shortest): joint 'shoulder' in 1 step"
    assert f"path.csv: {said}" in case.notes
    case = load(tmp_path, ", wrap: as_written")
    assert kinds(case) == [] and course(case)[2] == -2.8
    assert "path.csv: steps of more than half a turn go as written" in " ".join(case.notes)
    with pytest.raises(BadInput, match=r"trajectory\.wrap.*shortest"):
        load(tmp_path, ", wrap: short")


def test_a_turntable_that_goes_round_and_round_is_not_in_degrees(tmp_path):
    """Nine turns, written in (-pi, pi]. What is written beyond two turns still may be, wherever it wraps."""
    angles = 0.9 * np.arange(63)
    rows = "".join(f"{t},{(a + np.pi) % (2 * np.pi) - np.pi}\n" for t, a in enumerate(angles))
    case = load(tmp_path, ", wrap: shortest", "time,shoulder\n" + rows)
    assert course(case) == pytest.approx(angles) and kinds(case) == []
    rows = "".join(f"{t},{d}\n" for t, d in enumerate([*range(100, 181), *range(-179, -100)]))
    assert kinds(load(tmp_path, ", wrap: shortest", "time,shoulder\n" + rows)) == ["units"]


def states(times, angles, name="shoulder"):
    return [JointState(round(t * 1e9), (name,), [a]) for t, a in zip(times, angles, strict=True)]


def in_half_turns(angles):
    return np.remainder(np.array(angles) + np.pi, 2 * np.pi) - np.pi


def recorded(messages, wrapping=frozenset({"shoulder"})):
    joints = {"shoulder": True, "lift": False}
    return trajectory_of_states(sorted(messages), joints, None, wrapping).trajectory


def test_a_recorded_turn_goes_the_shortest_way(tmp_path):
    pytest.importorskip("rosbags", reason="bags are made by rosbags")
    from tests.formats.making_bags import state, write_bag

    smooth = np.linspace(2.6, 3.65, 22)
    written = in_half_turns(smooth)
    assert (np.abs(np.diff(written)) > np.pi).sum() == 1
    messages = [state(i, [angle, 0.0]) for i, angle in enumerate(written)]
    name = write_bag(tmp_path, "bag", {"/joint_states": messages}).name
    case = changed("file: path.csv", f"file: {name}")
    given = load_small(tmp_path, case, urdf=SPINS)
    assert kinds(given) == [] and course(given) == pytest.approx(smooth, abs=1e-12)
    said = "go the shortest way (wrap: shortest): joint 'shoulder' in 1 step"
    assert said in " ".join(given.notes)
    as_written = changed("file: path.csv", f"file: {name}, wrap: as_written")
    assert course(load_small(tmp_path, as_written, urdf=SPINS)).tolist() == written.tolist()


def test_between_messages_of_other_joints_it_goes_the_shortest_way_too():
    """The lift is told of between two messages of the shoulder, of which the second is a whole turn less."""
    lift = states([0.0, 0.5, 1.25, 1.5, 2.0], [0.0] * 5, "lift")
    messages = states([0.0, 1.0, 2.0], in_half_turns([3.0, 3.1, 3.4])) + lift
    for wrapping in (frozenset({"shoulder"}), None):  # None: the robot is not known
        found = recorded(messages, wrapping)
        raw = found.positions[:, found.joint_names.index("shoulder")]
        assert np.unwrap(raw) == pytest.approx([3.0, 3.05, 3.1, 3.175, 3.25, 3.4], abs=1e-12)
        assert (np.abs(np.diff(raw)) > np.pi).sum() == 1
    found = recorded(messages, frozenset())
    assert found.positions[4, found.joint_names.index("shoulder")] == pytest.approx(
        (3.1 + 3.4 - 2 * np.pi) / 2
    )


@pytest.mark.parametrize("turn", [0.0, 2 * np.pi, -4 * np.pi])
def test_a_recorded_run_is_held_against_what_was_asked_whatever_turn_it_is_on(tmp_path, turn):
    asked = "time,shoulder\n" + "".join(f"{i},{2.6 + 0.5 * i + turn}\n" for i in range(4))
    driven = in_half_turns([2.61, 3.1, 3.6, 4.1])
    rows = "".join(f"{i},{angle}\n" for i, angle in enumerate(driven))
    case = load(tmp_path, trajectory=asked)
    (tmp_path / "run.csv").write_text(f"time,shoulder\n{rows}")
    found = with_recorded(case, tmp_path / "run.csv")
    (error,) = found.robots[0].recording.joints
    assert error.greatest == pytest.approx(0.01, abs=1e-9) and kinds(found) == []
    assert kinematic_motion(found.robots[0]).positions[:, 0] == pytest.approx(
        turn + np.array([2.61, 3.1, 3.6, 4.1])
    )


def test_a_new_case_proposes_the_key(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    load(tmp_path)
    (tmp_path / "scene.yaml").write_text("obstacles: [{name: post, box: {size: [0.1, 0.1, 1]}}]\n")
    words = ["new", "out", "--robot", "arm.urdf", "--trajectory", "path.csv"]
    assert run([*words, "--scene", "scene.yaml"]) == 0
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert "\ntrajectory: trajectory.csv  #" in text
    (line,) = [one for one in text.splitlines() if "wrap: shortest}" in one]
    assert "or as_written: joint 'shoulder' turns by more than half a turn" in line
    assert kinds(load_case(tmp_path / "out" / "case.yaml")).count("wrap") == 1
    taken = line.removeprefix("# ").partition("  #")[0]
    text = text.replace("trajectory: trajectory.csv  #", f"{taken}  #")
    (tmp_path / "out" / "case.yaml").write_text(text)
    assert "wrap" not in kinds(load_case(tmp_path / "out" / "case.yaml"))


def test_a_table_that_is_said_to_be_recorded_goes_the_shortest_way(tmp_path):
    case = load(tmp_path, ", gaps: linear")
    assert kinds(case) == [] and course(case)[-1] == pytest.approx(3.65, abs=1e-6)
