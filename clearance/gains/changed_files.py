"""A changed case as files that anyone can check: the case file that it is from, what changed put in its place.

The limits stay those of that file; a margin is not written. Nothing is handed over before it is read once more and
comes to the same clearances, bit for bit. Not for: pages and figures (`folder`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from clearance.case.case_document import ScenePlace, read_schema, scene_request
from clearance.case.case_file import read_case
from clearance.case.rewritten_case import Node, rewritten_case, robot_node, robots_of
from clearance.errors import BadChange
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.motion.pose_writer import written_poses
from clearance.formats.motion.requests import PoseRequest, read_samples
from clearance.formats.motion.trajectory_writer import written
from clearance.formats.scene.request import SceneRequest
from clearance.formats.scene.scene_yaml import rows_of, written_scene
from clearance.formats.schema import case as schema
from clearance.formats.schema.obstacle import Obstacle as ObstacleRow
from clearance.gains.result import Gain
from clearance.gains.shift import first_pose
from clearance.gains.turn import ARM, Pivot
from clearance.run import Question, Run, answer
from clearance.world.case import index_of_robot
from clearance.world.notice import Severity
from clearance.world.pose_table import PoseTable

CASE, SCENE, MOVES = "case.yaml", "scene.yaml", "moves.csv"
TRAJECTORY, MESSAGE = "trajectory.csv", "trajectory.yaml"

OWN = (CASE, SCENE, MOVES, TRAJECTORY, MESSAGE)
"""All files that a changed case can have, but for meshes that are written out in its scene's file."""

WHEN = ("start", "rate", "after")
"""Keys that say when a table is followed, which stay; how another file was to be read goes."""


class CaseFiles(NamedTuple):
    """Files by name, and a line each on what is not as it was."""

    files: Mapping[str, bytes]
    notes: tuple[str, ...]


def case_files(gain: Gain, folder: Path) -> CaseFiles:
    """The changed case as files in `folder`, which need not be there.

    Raises:
        BadInput: the case was not read from a file, or what its file says cannot be said there.
    """
    if gain.case_file is None:
        raise BadChange(
            "the case is from no file that could be changed",
            valid="gain of the path of a case file",
        )
    made = _Files(gain, folder)
    ways = {
        "waypoints": made.paths,
        "timing": made.delay,
        "base": made.base,
        "obstacle": made.obstacle,
    }
    ways[gain.request.kind]()
    files = {CASE: made.case(), **made.contents}
    _require_same(gain, files, folder)
    return CaseFiles(files, tuple(made.notes))


class _Files:
    """The files of one changed case, as they come together."""

    def __init__(self, gain: Gain, folder: Path) -> None:
        assert gain.case_file is not None
        self.gain, self.folder, self.file = gain, folder, gain.case_file
        self.read = InputFiles(self.file.parent)
        self.given, self.scene_at = read_schema(self.file, self.read)
        self.contents: dict[str, bytes] = {}
        self.notes: list[str] = []
        self._changes: list[Any] = []

    def case(self) -> bytes:
        """The content of the case file."""

        def change(node: Node) -> None:
            if "name" not in node:
                node["name"] = self.gain.case.name
            for one in self._changes:
                one(node)

        return rewritten_case(self.read.read(self.file), self.file, self.folder, change)

    def paths(self) -> None:
        """The tables of all paths that are changed, each of several with its robot's name."""
        robots = self.gain.case.robots
        names = self.gain.request.robot or (self.gain.who,)
        for name in names:
            self.path(index_of_robot(robots, name), f"_{name}" if len(names) > 1 else "")

    def path(self, i_robot: int, suffix: str = "") -> None:
        """A table of joints, which the case names, and the same as a message."""
        placed = self.gain.case.robots[i_robot]
        for plain in (TRAJECTORY, MESSAGE):
            stem, kind = plain.split(".")
            name = f"{stem}{suffix}.{kind}"
            text, notes = written(placed.given_trajectory, name)
            self.contents[name] = text
            self.notes += [f"{name}: {note}" for note in notes]
        self._table({"file": TRAJECTORY.replace(".", f"{suffix}.")}, i_robot)

    def delay(self) -> None:
        """A start, or a rate, in place of another."""
        timing = self.gain.case.robots[self._i_robot].timing
        key = "rate" if self.gain.request.slow_down else "start"
        self._table({key: getattr(timing, key)}, self._i_robot)
        self._changes.append(self._with_carries)

    def _with_carries(self, node: Node) -> None:
        """The times of parts that the delayed robot carries."""
        before, after = (one.record.case.carries for one in (self.gain.before, self.gain.after))
        for i, (was, now) in enumerate(zip(before, after, strict=True)):
            if was == now:
                continue
            if i >= len(self.given.carry):
                raise BadChange(
                    f"the times at which part {now.part!r} is carried stand in the file of the scene",
                    valid="a row of carry in the case",
                )
            for key, time in (("from", now.window.start), ("until", now.window.end)):
                if key in node["carry"][i]:
                    node["carry"][i][key] = time

    def base(self) -> None:
        """A place of a robot's base."""
        i_robot = self._i_robot
        robots = [one.record.case.robots for one in (self.gain.before, self.gain.after)]
        before, after = (one[i_robot].world_from_base for one in robots)

        def change(node: Node) -> None:
            robot = robots_of(node)[i_robot]
            robot["base"] = self._pose(robot.get("base", {}), before, after)

        self._changes.append(change)
        if self.gain.tool_path is not None and self.gain.size > 0.0:
            self.path(i_robot)

    def obstacle(self) -> None:
        """A place of an obstacle, in the case file or in a scene's file of ours."""
        if self.scene_at.field == "scene.":
            self._changes.append(lambda node: self._move(node["scene"]["obstacles"]))
            return
        content, asked = self.scene_at.content, self._scene_request
        if any(one.severity is Severity.SUSPECT for one in content.notices):
            raise BadChange(
                "its file brings suspect input, which a scene made from it would hide",
                where=asked.shown,
                valid="a scene in YAML, as clearance convert makes one",
            )
        rows = [dict(row) for row in rows_of(content)]
        self._move(rows, written_out=True)
        made = written_scene(
            replace(content, scene={"obstacles": rows}), asked, self.folder, "clearance gain"
        )
        self.contents |= {SCENE: made.content, **made.meshes}
        self._changes.append(self._with_scene)

    @property
    def _i_robot(self) -> int:
        return index_of_robot(self.gain.case.robots, self.gain.who)

    def _table(self, section: Node, i_robot: int) -> None:
        """What is said of a robot's table."""

        def change(node: Node) -> None:
            _, holder = robot_node(node, i_robot)
            old = holder["trajectory"]
            old = {"file": old} if isinstance(old, str) else dict(old)
            if "file" in section:
                old = {key: value for key, value in old.items() if key in (*WHEN, "wrap")}
            made = {**section, **old} if "file" in section else {**old, **section}
            holder["trajectory"] = made["file"] if [*made] == ["file"] else made

        self._changes.append(change)

    def _move(self, rows: list[Node], *, written_out: bool = False) -> None:
        """Moves the obstacle among the rows of a scene.

        Args:
            written_out: the rows are those of a scene's file, paths as seen from there.
        """
        name = self.gain.who
        row = next(row for row in rows if row["name"] == name)
        made = next(one for one in self.gain.case.obstacles if one.name == name)
        if made.moves is None:
            was = self.gain.before.record.case.obstacles
            before = next(one for one in was if one.name == name).world_from_body
            row["pose"] = self._pose(row.get("pose", {}), before, made.world_from_body)
            return
        self.contents[MOVES] = self._poses(made.moves)
        old = row["moves"]
        times = {} if isinstance(old, str) else {key: old[key] for key in WHEN if key in old}
        file = MOVES if not written_out else str(self.folder.absolute() / MOVES)
        row["moves"] = {"file": file, **times}

    def _pose(self, given: Node, before: np.ndarray, after: np.ndarray) -> Node:
        """A pose of a file in another place; where it is turned with the quaternion that it was made of."""
        turn, change = self.gain.request.turn, self.gain.change
        if turn is None or change[3] == 0.0:
            return {**given, "xyz": after[:3, 3].tolist()}
        place, quaternion = Pivot(turn, before).placed(np.append(change[:3], change[3] * ARM))
        others = {key: one for key, one in given.items() if key not in ("rpy", "quat_xyzw")}
        return {**others, "xyz": place, "quat_xyzw": quaternion}

    def _poses(self, made: PoseTable) -> bytes:
        """The obstacle's table with other places; where it is not turned, turns as they stand in its file."""
        given: ObstacleRow = next(
            one for one in self.given.scene.obstacles if one.name == self.gain.who
        )
        assert given.moves is not None
        path = resolved(given.moves.file, self.scene_at.folder)
        asked = PoseRequest(self.read.unread(path), given.moves.length)
        samples = read_samples(asked, self.read.shown(path)).samples
        plain = replace(samples, positions=made.positions, frame="", child="", stamp=0)
        turn, change = self.gain.request.turn, self.gain.change
        if turn is not None and change[3] != 0.0:
            was = next(
                one.moves
                for one in self.gain.before.record.case.obstacles
                if one.name == self.gain.who
            )
            assert was is not None
            pivot, x = Pivot(turn, first_pose(was)), np.append(change[:3], change[3] * ARM)
            plain = replace(plain, quaternions=pivot.moved_table(was, x)[1])
        text, notes = written_poses(plain, MOVES)
        self.notes += [f"{MOVES}: {note}" for note in notes]
        return text

    @property
    def _scene_request(self) -> SceneRequest:
        from clearance.plain_yaml import parse_yaml

        raw = parse_yaml(self.read.read(self.file), self.file.name)
        assert isinstance(raw, dict)
        return scene_request(raw, self.read)

    def _with_scene(self, node: Node) -> None:
        """Names the scene's new file, and says what the old one said of robots and of what may touch."""
        node["scene"] = SCENE
        node.pop("includes", None)  # the new file has what they say
        for key, rows in _of_scene(self.gain, self.given, self.scene_at):
            node[key] = [*node.get(key, ()), *rows]
        for robot, given, placed in zip(
            robots_of(node), self.given.entries(), self.gain.case.robots, strict=True
        ):
            if placed.padding != given.robot.padding:
                robot["padding"] = {link: float(level) for link, level in placed.padding.items()}


def _of_scene(
    gain: Gain, given: schema.Case, scene_at: ScenePlace
) -> Iterator[tuple[str, list[Any]]]:
    """Rows of a case that stand in the file of its scene, by key."""
    allow = [list(row.between) for row in gain.case.allow[len(given.allow) :]]
    if allow:
        yield "allow", allow
    carries = [
        {
            "part": one.part,
            "by": one.by,
            "from": one.window.start,
            **({"touch": list(one.touch)} if one.touch else {}),
        }
        for one in gain.case.carries[len(given.carry) :]
    ]
    if carries:
        yield "carry", carries


def _require_same(gain: Gain, files: Mapping[str, bytes], folder: Path) -> None:
    """Nothing, if the files are read as the case that was measured; a fault of this program otherwise."""
    back = InputFiles(folder)
    for name, content in files.items():
        back.put(folder / name, content)
    found = answer(Question(read_case(folder / CASE, back)))
    if _figures(found) != _figures(gain.after):
        raise AssertionError("the changed case as it is written is not the one that was measured")


def _figures(run: Run) -> tuple[str, bytes, bytes]:
    """What a run came to, bit for bit."""
    rows = run.record.rows
    columns = [rows.numbers(name).tobytes() for name in ("clearance", "lower_bound")]
    return run.status, columns[0], columns[1]
