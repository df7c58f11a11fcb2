"""Runs `clearance check` on the robots of `example-robot-data` and prints what is measured of each.

    python scripts/bench/example_robots.py [--robots FOLDER] [--all] [--markdown]

One command a robot: a case with the URDF as it lies, every joint at rest as near to 0 as its limits allow, its
first joint moved by 0.1, and one box beside it. Of each folder one URDF is taken (`--all`: every one).
`pip install example-robot-data` brings the robots.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))  # so that the script runs from the root without an installation

from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402

from clearance.errors import ClearanceError  # noqa: E402
from clearance.formats.files.input_files import InputFiles  # noqa: E402
from clearance.formats.mesh_store import MeshStore  # noqa: E402
from clearance.formats.robot.formats import read_robot  # noqa: E402
from clearance.formats.robot.request import RobotRequest  # noqa: E402
from clearance.world.robot import Joint, Robot  # noqa: E402

BROUGHT = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"

COLUMNS = (
    "robot",
    "URDF",
    "links",
    "measured",
    "frames",
    "seen only",
    "notices",
    "notes",
    "exit",
    "verdict",
)

CASE = """robot: {{urdf: {urdf}, geometry: {geometry}, collada_up_axis: {axis}}}
scene:
  obstacles:
  - {{name: box, box: {{size: [0.1, 0.1, 0.1]}}, pose: {{xyz: [2.0, 0.0, 0.5]}}}}
trajectory: path.csv
"""


class Row(NamedTuple):
    """What came of one robot."""

    robot: str
    urdf: str
    links: str
    measured: str
    frames: str
    seen_only: str
    notices: str
    notes: str
    exit: str
    verdict: str


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--robots", type=Path, default=BROUGHT, metavar="FOLDER")
    parser.add_argument("--all", action="store_true", help="every URDF of a folder, not one")
    parser.add_argument("--markdown", action="store_true", help="print the table for the notes")
    asked = parser.parse_args()
    rows = []
    for urdf in urdfs(asked.robots, asked.all):
        rows.append(row_of(urdf, asked.robots))
        print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    show(rows, asked.markdown)


def urdfs(folder: Path, every: bool) -> Iterator[Path]:
    """The URDF files of each folder: all, or the first that has links."""
    for robot in sorted(path for path in folder.iterdir() if path.is_dir()):
        found = sorted(robot.rglob("*.urdf"))
        if not every:
            found = [path for path in found if b"<link" in path.read_bytes()][:1]
        yield from found


def row_of(urdf: Path, folder: Path) -> Row:
    """Reads the robot, runs the command, and tells of both."""
    name = urdf.relative_to(folder).parts[0].removesuffix("_description").removesuffix("_data")
    geometry, axis = "collision", "ros"
    try:
        robot = read(urdf, geometry, axis)
    except ClearanceError as error:
        if "geometry: visual" not in str(error):
            return Row(name, urdf.name, "", "", "", "", "", "", "2", str(error).partition(": ")[2])
        geometry = "visual"
        robot = read(urdf, geometry, axis)
    if any(notice.kind == "axis" for notice in robot.notices):
        axis = "file"
    code, verdict = answer(urdf, robot, geometry, axis)
    unseen = [notice for notice in robot.notices if notice.kind == "geometry"]
    n_seen = int(unseen[0].text.split()[0]) if unseen else 0
    told = [
        f"{notice.kind} ({notice.severity})"
        for notice in robot.notices
        if notice.kind != "geometry"
    ]
    n_links, n_measured = len(robot.link_names), len(robot.bodies)
    kinds = [f"geometry: {geometry}"] * (geometry != "collision") + [f"axis: {axis}"] * (
        axis != "ros"
    )
    return Row(
        name,
        urdf.name,
        str(n_links),
        str(n_measured),
        str(n_links - n_measured - n_seen),
        str(n_seen),
        ", ".join([*told, *kinds]),
        str(len(robot.notes)),
        str(code),
        verdict,
    )


def read(urdf: Path, geometry: str, axis: str) -> Robot:
    """The robot as the command reads it."""
    return read_robot(RobotRequest(urdf, (), geometry, axis), MeshStore(InputFiles(urdf.parent)))


def answer(urdf: Path, robot: Robot, geometry: str, axis: str) -> tuple[int, str]:
    """The exit code of the command and its verdict, or its error line."""
    with tempfile.TemporaryDirectory() as place:
        case = Path(place) / "case.yaml"
        case.write_text(CASE.format(urdf=json.dumps(str(urdf)), geometry=geometry, axis=axis))
        (case.parent / "path.csv").write_text(path_of(robot))
        command = [sys.executable, "-m", "clearance", "check", str(case), "--json"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    if not done.stdout:
        return done.returncode, done.stderr.strip().splitlines()[-1].removeprefix("error: ")
    told = json.loads(done.stdout)
    gap = told["worst"]["clearance"] * 1000
    suspects = "".join(f" ({one['kind']})" for one in told.get("suspects", []))
    return done.returncode, f"{told['verdict']}{suspects} {gap:.1f} mm"


def path_of(robot: Robot) -> str:
    """Two samples: every joint as near to 0 as its limits allow, then the first moved by 0.1."""
    joints = robot.moving_joints
    if not joints:
        return "time\n0\n1\n"
    rest = [min(max(0.0, joint.lower), joint.upper) for joint in joints]
    moved = [rest[0] + _step(joints[0]), *rest[1:]]
    rows = [",".join(map(repr, [float(t), *values])) for t, values in enumerate((rest, moved))]
    return "\n".join([",".join(["time", *(f'"{joint.name}"' for joint in joints)]), *rows, ""])


def _step(joint: Joint) -> float:
    """0.1, or what the limits leave of it, towards the middle."""
    middle = 0.5 * (joint.lower + joint.upper) if joint.upper - joint.lower < 1e9 else 1.0
    step = min(0.1, 0.5 * (joint.upper - joint.lower))
    return step if middle >= min(max(0.0, joint.lower), joint.upper) else -step


def show(rows: list[Row], markdown: bool) -> None:
    """Prints the rows as a table."""
    if markdown:
        print("| " + " | ".join(COLUMNS) + " |")
        print("|---" * len(COLUMNS) + "|")
        for row in rows:
            print("| " + " | ".join(row) + " |")
        return
    table = Table(*COLUMNS)
    for row in rows:
        table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else 200).print(table)


if __name__ == "__main__":
    main()
