"""Targets on what moves by a table of its own: a conveyor that turns, a table of joints, and what rides there.

The tool goes on its line or arc as seen from there, and is proven as elsewhere. Truth is in long doubles.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

import clearance as cl
from clearance.geometry.quaternions import quaternions_of
from clearance.programs.carriage import Carriage, steps_of_joint, steps_of_poses
from clearance.programs.motion import ProgramMotion
from clearance.programs.moves import JointMove, Move, Wait
from clearance.world.budget import Budget, ObstacleTolerance, PlacementTolerance
from clearance.world.cubic import positions_along
from clearance.world.kinematic_chain import ChainJoint
from clearance.world.knots import knots_of
from clearance.world.plausibility import notices_of
from clearance.world.trajectory import Trajectory
from tests.made_cases import at
from tests.programs.arms import START, arm, first_pose, shifted, turned
from tests.programs.arms import motion as motion_of_arm
from tests.programs.exact_arm import joints_for, links_at, turn, vector_of
from tests.programs.test_moving_frames import (
    AXIS,
    BESIDE,
    line,
    plate_at,
    pose_at,
    turn_between,
)
from tests.programs.test_programs_in_cases import (
    BASE,
    PLATE,
    as_yaml,
    at_base,
    beside_a_turntable,
    case,
    cube,
    tool_at,
    written,
)
from tests.programs.test_programs_in_cases import START as JOINTS
from tests.receipt.receipts import saved

LONG = np.longdouble
STARTS = {"heron6": np.array(START), "iiwa": np.array([0.1, 0.5, 0.1, -1.6, 0.1, 0.8, 0.0])}


class Belt:
    """A conveyor by poses at knots, which turn by vectors from one to the next, and stand before and after."""

    def __init__(self, times: list[float], places: np.ndarray, turns: np.ndarray) -> None:
        self.times, self.places, self.turns = np.array(times), np.array(places, dtype=LONG), turns
        self.first = [np.eye(3, dtype=LONG)]
        for vector in turns:
            self.first.append(self.first[-1] @ turn(vector))

    @classmethod
    def drawn(cls, draw: np.random.Generator, times: list[float]) -> Belt:
        """One that turns and bends near an arm, and changes its speed at each knot."""
        n = len(times)
        ways = np.cumsum(draw.uniform(-0.04, 0.04, (n, 3)), axis=0)
        return cls(times, ways, draw.uniform(-0.1, 0.1, (n - 1, 3)))

    @property
    def carriage(self) -> Carriage:
        rotations = np.array([one.astype(float) for one in self.first])
        poses = np.hstack([self.places.astype(float), quaternions_of(rotations)])
        return Carriage("belt", tuple(steps_of_poses(knots_of(self.times, poses, n_rotation=4))))

    def at(self, time: float) -> np.ndarray:
        """(4, 4) in long doubles."""
        i = int(np.clip(np.searchsorted(self.times, time) - 1, 0, len(self.turns) - 1))
        length = LONG(self.times[i + 1]) - LONG(self.times[i])
        share = np.clip((LONG(time) - LONG(self.times[i])) / length, 0, 1)
        found = np.eye(4, dtype=LONG)
        found[:3, :3] = self.first[i] @ turn(share * np.asarray(self.turns[i], dtype=LONG))
        found[:3, 3] = self.places[i] + share * (self.places[i + 1] - self.places[i])
        return found


def motion(moves: list[Move], carriage: Carriage, *given, **more) -> ProgramMotion:
    return motion_of_arm(moves, *given, carriages={carriage.name: carriage}, **more)


def share_at(time: float, length: float, speed: float = 0.25) -> np.ndarray:
    """Of a way from rest to rest with 1 m/s^2, by hand."""
    time, speed, length = (LONG(one) for one in (time, speed, length))
    ramp = speed = np.minimum(speed, np.sqrt(length))
    whole = length / speed + ramp
    if time < ramp:
        return time * time / 2 / length
    if time > whole - ramp:
        return 1 - (whole - time) ** 2 / 2 / length
    return (ramp * ramp / 2 + speed * (time - ramp)) / length


@pytest.mark.slow
@pytest.mark.parametrize("name", ["heron6", "iiwa"])
@pytest.mark.parametrize("seed", [0, 1, 5])
def test_between_samples_no_joint_is_farther_off_than_is_proven(name, seed):
    """A line or an arc, and a wait after it, on a belt that changes its speed at once at six knots."""
    draw, start = np.random.default_rng(seed), STARTS[name]
    belt = Belt.drawn(draw, [-0.3, 0.05, 0.21, 0.4, 0.62, 0.9, 1.3])
    on_belt = np.linalg.inv(belt.at(0.0).astype(float)) @ first_pose(name, start)
    end = shifted(on_belt, (0.05, -0.04, 0.03), by=(0.1, 0.2, -0.1))
    via = 0.5 * (on_belt + end)[:3, 3] + [0.0, 0.0, 0.02] if seed % 2 else None
    moves = [line(end, "belt", via=via), Wait("WAIT", "moves", 0.2)]
    found = motion(moves, belt.carriage, name, start)
    made = found.trajectory
    times = np.concatenate([made.times, np.repeat(belt.times, 20) + draw.uniform(-4e-6, 4e-6, 140)])
    times = np.sort(np.append(times, draw.uniform(0.0, made.times[-1], 150)))
    times = times[(times >= 0.0) & (times <= made.moves[-1].end)]
    worst, length = 0.0, arc_length(on_belt, end, via)
    for own, time in zip(positions_along(made, times), times, strict=True):
        share = LONG(1) if time >= made.moves[0].end else share_at(time, length)
        wanted = belt.at(time) @ pose_at(on_belt, end, share, via)
        true = joints_for(arm(name), (wanted[:3, :3], wanted[:3, 3]), own)
        worst = max(worst, float(np.abs(true - own).max()))
    assert 1e-8 < worst <= made.path_error < 1.3e-6 and not made.unproven


def arc_length(start: np.ndarray, end: np.ndarray, via: np.ndarray | None) -> float:
    """[m] By chords."""
    shares = np.linspace(0.0, 1.0, 3)
    points = np.array([pose_at(start, end, one, via)[:3, 3] for one in shares], dtype=float)
    ways = np.diff(points, axis=0)
    if via is None:
        return float(np.linalg.norm(ways.sum(axis=0)))
    bend = np.arccos(ways[0] @ ways[1] / np.linalg.norm(ways[0]) / np.linalg.norm(ways[1]))
    return float(np.linalg.norm(ways[0]) / np.sin(0.5 * bend) * bend)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["heron6", "iiwa"])
def test_no_path_through_a_corner_takes_a_link_farther_than_is_proven(name):
    draw, start = np.random.default_rng(4), STARTS[name]
    belt, one = Belt.drawn(draw, [-1.0, 0.3, 2.0]), arm(name)
    on_belt = np.linalg.inv(belt.at(0.0).astype(float)) @ first_pose(name, start)
    corner, end = shifted(on_belt, (0.05, -0.02, 0.02)), shifted(on_belt, (0.05, 0.03, 0.06))
    end[:3, :3] = turned((0.1, 0.0, 0.1)) @ end[:3, :3]
    found = motion(
        [line(corner, "belt", zone=0.004), line(end, "belt")], belt.carriage, name, start
    )
    made = found.trajectory
    (zone,) = made.corners
    own = positions_along(made, np.array([zone.start, zone.end]))
    entry, exit_ = (
        np.linalg.inv(belt.at(at).astype(float)) @ one.poses(row[None])[0]
        for at, row in zip((zone.start, zone.end), own, strict=True)
    )
    turn_by = vector_of(exit_[:3, :3] @ corner[:3, :3].T)
    for _ in range(12):
        now, last = own[0], np.sort(draw.random(2))[::-1]
        for a, b in np.linspace((0.0, 0.0), last, 4)[1:]:
            pose = entry.astype(LONG)
            pose[:3, 3] += a * (corner - entry)[:3, 3] + b * (exit_ - corner)[:3, 3]
            pose[:3, :3] = turn(draw.random() * turn_by) @ pose[:3, :3]
            time = zone.start + 0.5 * (a + b) * (zone.end - zone.start)
            wanted = belt.at(time) @ pose
            now = joints_for(one, (wanted[:3, :3], wanted[:3, 3]), now)
        nominal = links_at(one, positions_along(made, np.array([time]))[0])[0]
        for link, (rotation, place) in links_at(one, now)[0].items():
            if link not in zone.links:
                continue
            off = zone.links[link]
            assert np.linalg.norm((place - nominal[link][1]).astype(float)) <= off.way, link
            assert turn_between(rotation, nominal[link][0]) <= off.turn + 1e-12, link
    assert 1e-3 < zone.links[one.link].way < 0.05 and not made.unproven


def turntable(table: Trajectory) -> Carriage:
    """The plate of `test_moving_frames` by a table of its joint."""
    i = table.joint_names.index("turn")
    assert table.velocities is not None
    knots = knots_of(table.times, table.positions[:, [i]], table.velocities[:, [i]])
    joint = ChainJoint(BESIDE, AXIS, True, 0, 1.0, 0.0)
    return Carriage("plate", tuple(steps_of_joint(joint, knots, 0, 0.0)))


def test_a_joint_move_ends_where_its_target_is_when_it_arrives():
    belt = Belt(
        [0.0, 4.0], np.array([[0.0, 0.0, 0.0], [0.1, -0.4, 0.0]]), np.array([[0.0, 0.0, 0.4]])
    )
    target = shifted(first_pose(), (0.05, 0.1, 0.0), (0.1, 0.0, 0.2))
    move = JointMove("PTP 1", "moves[0]", pose=target, seen_from="belt")
    found = motion([Wait("WAIT", "moves", 0.4), move, Wait("WAIT 3", "moves", 0.5)], belt.carriage)
    made = found.trajectory
    arrival = made.moves[1].end
    for time in (arrival, arrival + 0.5):
        at = arm("heron6").poses(positions_along(made, np.array([time])))[0]
        assert np.abs(at - belt.at(time) @ target).max() < 3e-7
    begun = made.moves[1].start
    before, middle, after = positions_along(
        made, np.array([begun, 0.5 * (begun + arrival), arrival])
    )
    assert np.abs(middle - 0.5 * (before + after)).max() < 1e-6
    assert f"where 'belt' is at {arrival:.3f} s" in found.notes[1]


TIP = tool_at(JOINTS)[:3, 3] + np.array(BASE)
"""[m] Where the tool begins."""


def on_belt(folder: Path, moves: list, rows: str, **more) -> dict:
    """A case of a program with a frame at the tool's place on a belt, which moves by rows of a table; a cube at
    the tool, and a post 0.1 m ahead and 0.1 m beside."""
    path = case(folder, moves, frames={"jig": {"on": "belt", "xyz": TIP.tolist()}}, **more)
    (folder / "belt.csv").write_text(f"time,x,y,z,qx,qy,qz,qw\n{rows}")
    content = yaml.safe_load(path.read_text())
    turn_back = at(turned=tool_at(JOINTS)[:3, :3].T)
    ahead = {"xyz": (TIP + [0.1, 0.1, 0.0]).tolist()}
    content["scene"]["obstacles"] = [
        {"name": "belt", "box": {"size": [0.1] * 3}, "moves": "belt.csv"},
        cube("torch", "tool_tip", turn_back),
        {"name": "post", "box": {"size": [0.02] * 3}, "pose": ahead},
    ]
    links = {body.name for body in arm("heron6").robot.bodies}
    content["allow"] = [[name, "*"] for name in ("belt", *sorted(links))]
    content["limits"] = {"fail": 0.06}
    return content


MOVES = "0,0,0,0,0,0,0,1\n30,0,3.0,0,0,0,0,1\n"
STANDS = "0,0,0,0,0,0,0,1\n10,0,0,0,0,0,0,1\n"
"""0.1 m/s to the left, and not at all."""


@pytest.mark.slow
def test_a_line_on_a_conveyor_passes_a_post_as_worked_out_by_hand(tmp_path):
    """It goes 30 mm ahead on the belt in 0.4 s, at 0.1 m/s with 1 m/s^2, and the belt 0.14 m to the left in 1.4 s.
    Beside the post, from 0.8 to 1.2 s, the cubes are 0.1 - 0.03 - 0.02 m apart; on a belt that stands 0.08 m more
    to the side."""
    to = {"frame": "jig", "xyz": [0.03, 0.0, 0.0], "name": "P1"}
    moves = [{"lin": {"to": to, "speed": 0.1}}, {"wait": 1.0}]
    run = cl.check(written(tmp_path, on_belt(tmp_path, moves, MOVES)))
    made = run.record.case.robots[0].trajectory
    t = made.times
    ahead = np.where(
        t < 0.1,
        0.5 * t**2,
        np.where(t < 0.3, 0.005 + 0.1 * (t - 0.1), 0.03 - 0.5 * np.maximum(0.4 - t, 0) ** 2),
    )
    wanted = TIP + np.stack([ahead, 0.1 * t, 0.0 * t], axis=1)
    names = made.joint_names
    at = [tool_at(dict(zip(names, row, strict=True)))[:3, 3] + BASE for row in made.positions]
    assert t[-1] == pytest.approx(1.4) and np.abs(np.array(at) - wanted).max() < 1e-9
    assert run.worst["clearance"] == pytest.approx(0.05, abs=1e-5) and run.verdict.exit_code == 1
    assert 0.05 - 1.3e-4 < run.record.certificate.lower_bound.min() <= run.worst["clearance"]
    assert 0.79 < run.worst["time"] < 1.21 and run.worst["move"] == "WAIT 2"
    assert "the speed of belt at once (2 times, most by 0.1 m/s at " in " ".join(
        run.verdict.warnings
    )
    still = cl.check(written(tmp_path, on_belt(tmp_path, moves, STANDS)))
    assert still.passed and still.worst["clearance"] == pytest.approx(
        np.hypot(0.05, 0.08), abs=1e-5
    )
    assert still.worst["move"] == "LIN 1 → P1" or still.worst["time"] >= 0.4


@pytest.mark.slow
@pytest.mark.parametrize("carried", [False, True])
def test_a_tool_goes_with_a_part_on_a_turntable_on_a_conveyor(tmp_path, carried):
    """All by tables of their own, and the program later and quicker: the tool keeps its place on the part. It
    rides on the plate, or stands until the plate takes it on, and from when it is put down."""
    to = {"frame": "jig", "xyz": ON_PART}
    moves = [{"lin": {"to": to}}, {"wait": 2.5}]
    path = beside_a_turntable(
        tmp_path, moves, "0.5,0.5\n1.2,0.7\n2.0,0.6\n", frames={"jig": {"on": "part"}}
    )
    quat = quaternions_of(np.array([turned((0.1, -0.05, 0.2))]))[0].tolist()
    rows = [
        [0.5, 0, 0, 0, 0, 0, 0, 1],
        [1.1, 0.05, -0.03, 0.02, *quat],
        [2.3, 0, 0.04, 0, 0, 0, 0, 1],
    ]
    (tmp_path / "belt.csv").write_text(
        "time,x,y,z,qx,qy,qz,qw\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
    )
    content = yaml.safe_load(path.read_text())
    arm_of, table = content["robots"]
    arm_of["trajectory"] |= {"start": 0.3, "rate": 1.25}
    table["base"] = {"on": "belt", "xyz": [2.0, 0.0, 0.0]}
    belt = {"name": "belt", "box": {"size": [0.1] * 3}, "moves": "belt.csv"}
    content["scene"]["obstacles"] += [belt, *torch_and_rider()]
    content["allow"] = [[name, "*"] for name in ("arm/*", "turntable/*", "belt", "part", "far")]
    if carried:
        part = next(one for one in content["scene"]["obstacles"] if one["name"] == "part")
        part.pop("on")
        part["pose"] = as_yaml(WORLD_FROM_PART)
        content["carry"] = [{"part": "part", "by": "turntable/plate", "from": 0.8, "until": 1.7}]
    run = cl.check(written(tmp_path, content))
    table = run.steps.to_pydict()
    assert (table["time"][0], table["time"][-1]) == pytest.approx((0.3, 2.3))
    error = run.record.timeline.path_error
    assert error < 3e-4 and np.abs(np.array(table["clearance"]) + error - 0.08).max() < 5e-7
    assert run.record.certificate.lower_bound.min() > 0.08 - error - 1.2e-4
    made = run.record.case.robots[0].trajectory
    on = "part" if carried else "turntable/plate"
    assert made.rides == (on,) and made.frames == ("part",) and not made.unproven
    (note,) = (one for one in run.record.case.notes if "moves by itself" in one)
    assert note.endswith(f"LIN 1, WAIT 2: seen from {on!r}, which moves by itself")


WORLD_FROM_PART = np.eye(4)
WORLD_FROM_PART[:3, :3] = turned((0.0, 0.0, 0.5))
WORLD_FROM_PART[:3, 3] = WORLD_FROM_PART[:3, :3] @ [0.1, 0.0, 0.0] + [2.0, 0.0, PLATE + 0.3]
ON_PART = (WORLD_FROM_PART[:3, :3].T @ (TIP - WORLD_FROM_PART[:3, 3])).tolist()
"""Where the part is at first, and the tool seen from it."""


def torch_and_rider() -> list[dict]:
    """A cube at the tool, and one that rides on the part 80 mm beside it."""
    beside = np.linalg.inv(WORLD_FROM_PART) @ np.array(at_base()) @ tool_at(JOINTS)
    beside[:3, 3] += beside[:3, :3] @ [0.0, 0.1, 0.0]
    return [cube("torch", "arm/tool_tip", np.eye(4)), cube("rides", "part", beside)]


def test_what_stops_is_followed_no_farther(tmp_path):
    moves = [{"lin": {"to": {"frame": "jig", "xyz": [0.03, 0.0, 0.0]}}}, {"wait": 2.0}]
    case_ = cl.load_case(
        written(tmp_path, on_belt(tmp_path, moves, MOVES.replace("30,0,3.0", "1,0,0.1")))
    )
    made = case_.robots[0].trajectory
    rests = made.positions[made.times > 1.0 + 1e-5]
    assert (np.ptp(rests, axis=0) < 1e-9).all() and len(rests)
    at = tool_at(dict(zip(made.joint_names, rests[-1], strict=True)))[:3, 3] + BASE
    assert np.abs(at - TIP - [0.03, 0.1, 0.0]).max() < 1e-9
    assert any("'belt' stands at its last sample from 1 s" in note for note in case_.notes)
    loose = Budget(obstacles={"belt": ObstacleTolerance(PlacementTolerance(0.001))})
    told = [one.text for one in notices_of(replace(case_, tolerance=loose))]
    assert any("a tolerance of belt does not move the tool" in one for one in told)


@pytest.mark.slow
def test_a_receipt_of_it_is_proven_again_and_nothing_it_goes_with_is_changed(tmp_path):
    moves = [
        {"lin": {"to": {"frame": "jig", "xyz": [0.03, 0.0, 0.0]}, "speed": 0.1}},
        {"wait": 0.2},
    ]
    loaded = cl.load_case(written(tmp_path, on_belt(tmp_path, moves, MOVES)))
    saved(loaded, tmp_path / "report")
    assert cl.verify(tmp_path / "report", loaded).proven
    with pytest.raises(cl.BadInput, match="kind obstacle changes its joints"):
        cl.gain(loaded, "obstacle", obstacle="belt")
    with pytest.raises(cl.BadInput, match="the program of robot 'heron6' goes with belt"):
        cl.gain(loaded, "timing", robot="heron6")


LINE = {"lin": {"to": {"frame": "jig", "xyz": [0.03, 0.0, 0.0]}}}
WORLD = {"lin": {"to": {"xyz": TIP.tolist()}}}
PTP = {"ptp": {"joints": JOINTS}}
TURNED = {"frame": "jig", "xyz": [0.0, 0.1, 0.0], "rpy": [0.0, 0.0, 0.0]}


OWN = {"part": "belt", "by": "tool_tip", "from": 0.5}


def zoned(move: dict) -> dict:
    ((key, one),) = move.items()
    return {key: one | {"zone": 0.01}}


@pytest.mark.parametrize(
    ("moves", "change", "told"),
    [
        ([zoned(LINE), WORLD], {}, r"moves\[0\].lin: zone: the next target is on what stands, which moves"),
        ([zoned(WORLD), LINE], {}, r"moves\[0\].lin: zone: the next target is on belt, which moves"),
        ([zoned(LINE), PTP], {}, "a corner zone beside a joint move, and 'belt' moves by itself"),
        ([zoned(PTP), LINE], {}, "a corner zone beside a joint move, and 'belt' moves by itself"),
        ([{"circ": LINE["lin"] | {"via": {"xyz": TIP.tolist()}}}], {}, "does not move as frame 'jig'"),
        ([LINE], {"moves": {"file": "belt.csv", "after": "loop"}}, r"does not stay .* \(after: loop\)"),
        ([LINE], {"moves": {"file": "belt.csv", "after": "absent"}}, r"not stay .* \(after: absent\)"),
        ([LINE], {"clock": {"slack": 0.1}}, "goes with 'belt', and their clocks are not tied"),
        ([LINE], {"after": "loop"}, r"the program begins again \(after: loop\), and 'belt' is elsewhere"),
        ([LINE], {"base": {"on": "belt"}}, "the robot stands on 'belt'"),
        ([LINE, {"wait": 1.0}], {"carry": [OWN]}, "from 0.5 s on 'belt' is carried by what a program"),
        ([LINE, {"wait": 20.0}], {}, r"moves\[1\]: the tool cannot go on at 10\..* s with 'belt', at "),
        ([{"ptp": {"to": TURNED, "speed": 0.02}}], {}, r"moves\[0\].ptp: the joints do not catch up .*'belt'"),
    ],
)  # fmt: skip
def test_what_cannot_be_followed_is_refused(tmp_path, moves, change, told):
    content = on_belt(tmp_path, moves, MOVES)
    belt = content["scene"]["obstacles"][0]
    belt["moves"] = change.get("moves", belt["moves"])
    content["robot"]["base"] = change.get("base", content["robot"]["base"])
    content["trajectory"] |= {key: change[key] for key in ("after",) if key in change}
    content |= {key: change[key] for key in ("clock", "carry") if key in change}
    with pytest.raises(cl.ClearanceError, match=told) as caught:
        cl.load_case(written(tmp_path, content))
    assert "\n" not in str(caught.value)


def test_errors_of_what_is_followed_are_errors_of_the_joints():
    """A table that is off its cubics by 1e-7 rad, as one with accelerations."""
    times, angles = np.array([-0.1, 0.2, 0.9]), np.array([[0.3], [0.5], [0.2]])
    knots = knots_of(times, angles, np.array([[0.0], [0.3], [-0.4]]))
    joint, off = ChainJoint(BESIDE, AXIS, True, 0, 1.0, 0.0), 1e-7
    carriage = Carriage("plate", tuple(steps_of_joint(joint, knots, 0, off)))
    on_plate = carriage.at(np.zeros(1)).poses[0]
    on_plate = np.linalg.inv(on_plate) @ first_pose()
    made = motion([line(on_plate, "plate"), Wait("WAIT", "moves", 0.5)], carriage).trajectory
    worst = 0.0
    for time, own in zip(made.times[10:-10:9], made.positions[10:-10:9], strict=True):
        wanted = plate_at(float(knots.values_at(np.array([0.0, time]))[-1, 0]) + off) @ on_plate
        true = joints_for(arm("heron6"), (wanted[:3, :3], wanted[:3, 3]), own)
        worst = max(worst, float(np.abs(true - own).max()))
    assert off < worst <= made.path_error


@pytest.mark.slow
def test_a_tool_goes_with_a_part_on_a_turntable_that_has_a_program_of_its_own(tmp_path):
    """The file may name the arm first; the tool keeps 80 mm from a cube that rides beside it."""
    moves = [{"lin": {"to": {"frame": "jig", "xyz": ON_PART}}}, {"wait": 2.5}]
    path = beside_a_turntable(tmp_path, moves, frames={"jig": {"on": "part"}})
    content = yaml.safe_load(path.read_text())
    table = content["robots"][1]
    turns = [{"ptp": {"joints": {"turn": at}, "speed": 0.5}} for at in (0.7, 0.6)]
    program = {"tool": {"link": "plate"}, "start": table.pop("joints"), "moves": turns}
    table["trajectory"] = {"program": program}
    content["scene"]["obstacles"] += torch_and_rider()
    content["allow"] = [[name, "*"] for name in ("arm/*", "turntable/*", "part", "far")]
    run = cl.check(written(tmp_path, content))
    clearances = run.steps["clearance"].to_numpy() + run.record.timeline.path_error
    assert np.abs(clearances - 0.08).max() < 5e-7
    assert run.record.certificate.lower_bound.min() > 0.08 - run.record.timeline.path_error - 1.2e-4
    made = next(one.trajectory for one in run.record.case.robots if one.robot.name == "arm")
    assert made.rides == ("turntable/plate",) and not made.unproven
    turns[0]["ptp"]["zone"] = 0.01
    with pytest.raises(cl.ClearanceError, match="moves by a program with corner zones"):
        cl.load_case(written(tmp_path, content))
