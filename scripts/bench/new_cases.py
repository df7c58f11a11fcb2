"""Runs `clearance new --check` on real robots and prints what was given, what was assumed, and what came of it.

    python scripts/bench/new_cases.py [--only NAME,…] [--markdown]

Robots are those of `example-robot-data` and `pybullet_data` as they lie, with their SRDF where they bring one.
Each has a motion of its own, through five positions of its turning joints that a fixed seed draws within their
limits, as a JointTrajectory in YAML or in a bag of ROS 2. Other joints are left out. No file is edited.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))  # so that the script runs from the root without an installation

from clearance.errors import NothingToMeasure  # noqa: E402
from clearance.formats.motion.trajectory_writer import written  # noqa: E402
from clearance.formats.robot.urdf.robot import load_urdf  # noqa: E402
from clearance.world.joint_positions import turns  # noqa: E402
from clearance.world.robot import Joint  # noqa: E402
from clearance.world.trajectory import Trajectory  # noqa: E402

BROUGHT = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"

N_POINTS, SHARE, SEED = 5, 0.3, 7
"""Positions of a motion, and how much of the way to its limits a joint may go from the middle between them."""

SCENE = """<?xml version="1.0"?>
<sdf version="1.9"><world name="cell"><model name="table"><pose>1.2 0 0.35 0 0 0</pose>
<link name="top"><collision name="c"><geometry><box><size>0.4 1.2 0.7</size></box></geometry></collision></link>
</model></world></sdf>
"""


class Robot(NamedTuple):
    """A robot as it lies, and what is given with it: an SRDF, how its motion is written, and a scene."""

    name: str
    urdf: str
    srdf: str = ""
    motion: str = "yaml"
    with_scene: bool = False


ROBOTS = (
    Robot("panda", "panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "bag"),
    Robot("ur5", "ur_description/urdf/ur5_robot.urdf", "ur_description/srdf/ur5.srdf", "yaml", True),
    Robot("ur10", "ur_description/urdf/ur10_robot.urdf", "", "bag", True),
    Robot("tiago", "tiago_description/robots/tiago.urdf", "", "yaml", True),
    Robot("talos", "talos_data/robots/talos_full_v2.urdf", "talos_data/srdf/talos.srdf", "yaml"),
    Robot("baxter", "baxter_description/urdf/baxter.urdf",
          "baxter_description/srdf/baxter_manipulation.srdf", "bag"),
    Robot("anymal with kinova", "anymal_b_simple_description/robots/anymal-kinova.urdf",
          "anymal_b_simple_description/srdf/anymal-kinova.srdf", "yaml", True),
    Robot("solo", "solo_description/robots/solo.urdf", "solo_description/srdf/solo.srdf", "bag"),
    Robot("icub", "icub_description/robots/icub.urdf", "icub_description/srdf/icub.srdf", "yaml"),
    Robot("pr2", "pr2_description/urdf/pr2.urdf", "pr2_description/srdf/pr2.srdf", "bag", True),
    Robot("xarm7", "xarm_description/urdf/xarm7.urdf", "xarm_description/srdf/xarm7.srdf", "yaml"),
    Robot("human", "human_description/robots/human.urdf", "", "yaml", True),
    Robot("kuka iiwa", "pybullet_data:kuka_iiwa/model.urdf", "", "bag", True),
    Robot("franka", "pybullet_data:franka_panda/panda.urdf", "", "yaml"),
    Robot("r2d2", "pybullet_data:r2d2.urdf", "", "yaml", True),
)  # fmt: skip


class Row(NamedTuple):
    """What came of one robot."""

    robot: str
    given: str
    seconds: str
    assumed: str
    exit: str
    verdict: str


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="names with commas between them")
    parser.add_argument("--markdown", action="store_true", help="print the table for the notes")
    asked = parser.parse_args()
    wanted = [one for one in ROBOTS if not asked.only or one.name in asked.only.split(",")]
    print(f"| {' | '.join(Row._fields)} |\n{'|---' * len(Row._fields)}|")
    for robot in wanted:
        row = row_of(robot)
        print(("| " + " | ".join(row) + " |") if asked.markdown else row, flush=True)


def row_of(robot: Robot) -> Row:
    """Makes the motion, runs the command, and tells of both."""
    with tempfile.TemporaryDirectory() as place:
        words, given = words_of(robot, Path(place))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "clearance", "new", f"{place}/case", *words, "--check"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        is_told = (Path(place) / "case" / "report" / "report.html").is_file()
    seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    lines = done.stdout.splitlines()
    assumed = [line.removeprefix("assumed").strip() for line in lines if line.startswith("assumed")]
    verdict = next((line for i, line in enumerate(lines) if lines[i - 1].startswith("run ")), "")
    if not is_told:
        verdict = (done.stderr.strip().splitlines() or ["no report"])[-1]
    kinds = [line.split("--accept ")[1].rstrip(")") for line in lines if "(--accept " in line]
    told = verdict.partition("(")[0].replace("  case: least clearance", "").strip()
    told += f" ({', '.join(kinds)})" if kinds else ""
    return Row(robot.name, given, f"{seconds:.1f}", "; ".join(assumed), str(done.returncode), told)


def words_of(robot: Robot, folder: Path) -> tuple[list[str], str]:
    """The words of the command for a robot, whose motion is written to the folder; and what they are, in short."""
    urdf = robot.urdf if ":" in robot.urdf else str(BROUGHT / robot.urdf)
    words, given = ["--robot", urdf], ["URDF"]
    if robot.srdf:
        words += ["--srdf", str(BROUGHT / robot.srdf)]
        given.append("SRDF")
    if robot.with_scene:
        (folder / "cell.sdf").write_text(SCENE)
        words += ["--scene", str(folder / "cell.sdf")]
        given.append("SDF")
    path = MOTIONS[robot.motion](motion_of(urdf), folder)
    return [*words, "--trajectory", str(path)], ", ".join([*given, robot.motion])


def motion_of(urdf: str) -> Trajectory:
    """Five positions about the middle of the joints' limits, a second apart."""
    try:
        robot = load_urdf(urdf)
    except NothingToMeasure:
        robot = load_urdf(urdf, geometry="visual")
    joints = [joint for joint in robot.moving_joints if turns(joint)]  # grippers and lifts rest
    rng = np.random.default_rng(SEED)
    bounds = np.array([_bounds(joint) for joint in joints])
    middle, half = bounds.mean(axis=1), 0.5 * (bounds[:, 1] - bounds[:, 0])
    rows = middle + SHARE * half * rng.uniform(-1.0, 1.0, (N_POINTS, len(joints)))
    names = tuple(joint.name for joint in joints)
    return Trajectory(np.arange(float(N_POINTS)), names, rows)


def _bounds(joint: Joint) -> tuple[float, float]:
    """Its limits; a half turn either way where it has none."""
    return max(joint.lower, -np.pi), min(joint.upper, np.pi)


def write_yaml(motion: Trajectory, folder: Path) -> Path:
    """A JointTrajectory as `ros2 topic echo` prints it."""
    path = folder / "path.yaml"
    path.write_bytes(written(motion, path.name).content)
    return path


def write_bag(motion: Trajectory, folder: Path) -> Path:
    """A bag of ROS 2 with one JointTrajectory."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    types, kind = store.types, "trajectory_msgs/msg/JointTrajectory"
    point, duration = (
        types["trajectory_msgs/msg/JointTrajectoryPoint"],
        types["builtin_interfaces/msg/Duration"],
    )
    none = np.empty(0)
    points = [
        point(row, none, none, none, duration(int(time), 0))
        for time, row in zip(motion.times, motion.positions, strict=True)
    ]
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "")
    message = types[kind](header, [*motion.joint_names], points)
    with Writer(folder / "run", version=9) as writer:
        connection = writer.add_connection("/planned", kind, typestore=store)
        writer.write(connection, 1, bytes(store.serialize_cdr(message, kind)))
    return folder / "run"


MOTIONS: dict[str, Callable[[Trajectory, Path], Path]] = {"yaml": write_yaml, "bag": write_bag}
"""How a motion is given."""

if __name__ == "__main__":
    main()
