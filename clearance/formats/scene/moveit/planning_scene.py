"""MoveIt's PlanningScene in YAML, as a message is printed or as robowflex writes it, to a scene.

World objects become obstacles, attached ones ride on their link, pairs of the AllowedCollisionMatrix may touch.
Not for: the robot's state, colours. Source: MoveIt, collision_detection::AllowedCollisionMatrix: an entry goes
before a default.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from clearance.errors import BadDimension, BadScene, BadShape, at
from clearance.formats.message.values import (
    Message,
    Poses,
    frame_of,
    items,
    message,
    messages,
    number,
    require_fields,
    text,
)
from clearance.formats.scene.moveit.objects import Row, SceneMeshes, object_rows
from clearance.formats.scene.request import (
    ANY,
    AttachedPart,
    SceneContent,
    SceneRequest,
    pose_row,
)
from clearance.world.names import require_own_names
from clearance.world.notice import Notice, Severity
from clearance.world.rules import pattern_of

OCTOMAP = "<octomap>"
"""The name of a map in MoveIt, by which its matrix may allow it."""

_KEYS = {
    "world",
    "robot_state",
    "allowed_collision_matrix",
    "fixed_frame_transforms",
    "robot_model_name",
}


_FIELDS = (
    *_KEYS, "name", "link_padding", "link_scale", "object_colors", "is_diff",
)  # fmt: skip


_STATE = ("joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff")


def is_planning_scene(raw: dict[str, Any]) -> bool:
    """True for plain data that has what no scene of ours has."""
    return not _KEYS.isdisjoint(raw) and "obstacles" not in raw


def planning_scene(raw: dict[str, Any], asked: SceneRequest) -> SceneContent:
    """The obstacles of a planning scene, what may touch them, and the padding of links.

    Raises:
        BadInput: what is not read (scale of links, cone, plane), or is no message; with its field.
    """
    with at(asked.shown):
        require_fields(raw, *_FIELDS)
        meshes, poses = SceneMeshes(asked), Poses()
        frames, padding = _Frames(raw, poses), _padding(raw)
        world = message(raw, "world")
        with at("world"):
            require_fields(world, "collision_objects", "octomap")
            obstacles = list(_world(world, frames, meshes, poses))
            obstacles += _octomap(message(world, "octomap"), frames, meshes, poses)
        state = message(raw, "robot_state")
        with at("robot_state"):
            require_fields(state, *_STATE)
            attached, carried = _attached(state, padding, meshes, poses)
            bases = _bases(message(state, "multi_dof_joint_state"), poses)
        pairs, not_by_default = allowed_pairs(message(raw, "allowed_collision_matrix"))
    rows = [*obstacles, *attached]
    own = _obstacle_patterns(_parts(raw), rows)
    notes = [*frames.notes(), *_lost(raw, state), *poses.notes()]
    tree = message(message(world, "octomap"), "octomap")
    if items(tree, "data") and all(row["name"] != OCTOMAP for row in rows):
        notes.append("no cell of the octomap is occupied, so there is no obstacle of it")
    return SceneContent(
        {"obstacles": rows},
        (*(f"{asked.shown}: {note}" for note in notes), *meshes.found.notes()),
        (*_unknown_scene(raw, asked.shown), *meshes.found.notices()),
        allow=tuple(
            (one, other)
            for first, second in pairs
            for one, other in itertools.product(own.get(first, [first]), own.get(second, [second]))
        ),
        not_by_default=tuple(one for name in not_by_default for one in own.get(name, [name])),
        link_padding=padding,
        attached=tuple(carried),
        frame=frames.assumed_frame,
        bases=bases,
        joints=_joints(message(state, "joint_state")),
    )


class _Frames:
    """The frames of a planning scene, each in the frame in which it plans."""

    def __init__(self, raw: Message, poses: Poses) -> None:
        self._known: dict[str, np.ndarray] = {}
        self._plain: set[str] = set()
        for where, row in messages(raw, "fixed_frame_transforms"):
            with at(where):
                require_fields(row, "header", "child_frame_id", "transform")
                self._plain.add(text(row, "child_frame_id", "").lstrip("/"))
                self._known[frame_of(row)] = poses.read(
                    message(row, "transform"), "translation", "rotation"
                )

    def of(self, given: Message) -> np.ndarray:
        """(4, 4) [m] the frame of an object.

        Raises:
            BadInput: a frame that nothing ties to those of other objects.
        """
        name = frame_of(given)
        if name in self._known:
            return self._known[name]
        self._plain.add(name)
        named = sorted(self._plain - {""})
        if len(named) > 1:
            raise BadScene(
                f"frames {named[0]!r} and {named[1]!r} are used, and nothing says where one is in the other",
                valid="one frame, or fixed_frame_transforms with it as header.frame_id and the planning frame as "
                "child_frame_id",
            )
        return np.eye(4)

    @property
    def assumed_frame(self) -> str:
        """The frame that is taken for the world, if it is named otherwise; one at most, as `of` sees to."""
        return next(iter(self._plain - {"", "world"}), "")

    def notes(self) -> list[str]:
        """Which frame is taken for the world."""
        return (
            [f"frame {self.assumed_frame!r} is taken for the world of the case"]
            if self.assumed_frame
            else []
        )


def _world(world: Message, frames: _Frames, meshes: SceneMeshes, poses: Poses) -> Iterator[Row]:
    for where, given in messages(world, "collision_objects"):
        with at(where):
            rows = object_rows(given, frames.of(given), meshes, poses)
        yield from rows


def _attached(
    state: Message, padding: dict[str, float], meshes: SceneMeshes, poses: Poses
) -> tuple[list[Row], list[AttachedPart]]:
    """The obstacles that ride on links, and what each may touch.

    Each has the padding of its link. Source: MoveIt, CollisionEnvFCL::getAttachedBodyObjects.
    """
    rows: list[Row] = []
    carried: list[AttachedPart] = []
    for where, given in messages(state, "attached_collision_objects"):
        with at(where):
            require_fields(given, "link_name", "object", "touch_links", "detach_posture", "weight")
            link = text(given, "link_name")
            links = _names(given, "touch_links", "names of links")
            touch = tuple(dict.fromkeys(map(pattern_of, links)))
            for row in _attached_rows(message(given, "object"), link, meshes, poses):
                rows.append(row | {"on": link, "padding": padding.get(link, 0.0)})
                carried.append(AttachedPart(row["name"], link, touch))
    return rows, carried


def _attached_rows(attached: Message, link: str, meshes: SceneMeshes, poses: Poses) -> list[Row]:
    """The obstacles of what a link holds, in the link's frame."""
    frame = frame_of(attached, link)
    if frame != link:
        raise BadScene(f"it is given in {frame!r}, not in its link", valid=f"frame_id: {link}")
    return object_rows(attached, np.eye(4), meshes, poses)


def _parts(raw: Message) -> dict[str, list[str]]:
    """The names of the obstacles of each object of several shapes."""
    objects = [one for _, one in messages(message(raw, "world"), "collision_objects")]
    objects += [one for _, one in _attached_objects(message(raw, "robot_state"))]
    n_shapes = {
        text(one, "id"): len(items(one, "primitives")) + len(items(one, "meshes"))
        for one in objects
    }
    return {name: [f"{name}/{i}" for i in range(n)] for name, n in n_shapes.items() if n > 1}


def _obstacle_patterns(parts: dict[str, list[str]], rows: list[Row]) -> dict[str, list[str]]:
    """Patterns of the obstacles of each object of several shapes, by that of its name; one, if of no other."""
    patterns = {}
    for name, own in parts.items():
        before = f"{name}/"
        alone = sum(row["name"].startswith(before) for row in rows) == len(own)
        one = [f"{pattern_of(name)}/*"]
        patterns[pattern_of(name)] = one if alone else [pattern_of(part) for part in own]
    return patterns


def _padding(raw: Message) -> dict[str, float]:
    """[m] by link; those of 0 are left out.

    Raises:
        BadDimension: a scale that is not 1, a padding below 0.
    """
    for where, row in messages(raw, "link_scale"):
        with at(where):
            require_fields(row, "link_name", "scale")
            if number(row.get("scale", 1.0), "scale") != 1.0:
                problem = f"link {text(row, 'link_name')!r} is scaled by {row['scale']}"
                raise BadDimension(problem, valid="1, and padding")
    found = {}
    for where, row in messages(raw, "link_padding"):
        with at(where):
            require_fields(row, "link_name", "padding")
            padding = number(row.get("padding", 0.0), "padding")
            if padding < 0.0:
                raise BadDimension(f"padding is {padding} m", valid="0 or more")
            found[text(row, "link_name")] = padding
    return {link: padding for link, padding in found.items() if padding}


def _octomap(given: Message, frames: _Frames, meshes: SceneMeshes, poses: Poses) -> Iterator[Row]:
    """The obstacle of a map with occupied cells, called `OCTOMAP` as in MoveIt."""
    tree = message(given, "octomap")
    require_fields(given, "header", "origin", "octomap")
    require_fields(tree, "header", "binary", "id", "resolution", "data")
    if not items(tree, "data"):
        return
    with at("octomap"):
        placed = frames.of(given) @ poses.read(message(given, "origin"))
        mapped = meshes.octomap(tree)
        if mapped is not None:
            yield {"name": OCTOMAP, **mapped, "pose": pose_row(placed)}


def _lost(raw: Message, state: Message) -> Iterator[str]:
    """What has no place in a scene."""
    joints = [message(state, key) for key in ("joint_state", "multi_dof_joint_state")]
    if any(items(one, name) for one in joints for name in ("name", "joint_names")):
        yield "the robot's state is not taken: joints are as the case says"
    world = message(raw, "world")
    n_named = sum(
        len(items(one, "subframe_names"))
        for _, one in (*messages(world, "collision_objects"), *_attached_objects(state))
    )
    if n_named:
        yield f"{n_named} subframes of objects are passed over: nothing here is given in them"


def _bases(given: Message, poses: Poses) -> dict[str, np.ndarray]:
    """(4, 4) [m] by joint: where the robot's state puts it, if that is not the frame's origin."""
    with at("multi_dof_joint_state"):
        names = _names(given, "joint_names")
        found = {}
        for name, (where, row) in zip(names, messages(given, "transforms"), strict=False):
            with at(where):
                found[name] = poses.read(row, "translation", "rotation")
    return {name: pose for name, pose in found.items() if not np.array_equal(pose, np.eye(4))}


def _joints(given: Message) -> dict[str, float]:
    """[rad or m] by joint: where the robot's state has it, as far as that is a number."""
    with at("robot_state.joint_state"):
        named = zip(_names(given, "name"), items(given, "position"), strict=False)
        finite = ((name, one) for name, one in named if type(one) in (int, float))
        return {name: float(one) for name, one in finite if math.isfinite(one)}


def _unknown_scene(raw: Message, shown: str) -> Iterator[Notice]:
    """A warning on a message that only changes another scene."""
    if raw.get("is_diff") is True:
        text = f"{shown} changes another scene (is_diff: true): objects that only that scene has are not measured"
        yield Notice(Severity.WARNING, "scene", text)


def _attached_objects(state: Message) -> Iterator[tuple[str, Message]]:
    for where, given in messages(state, "attached_collision_objects"):
        yield where, message(given, "object")


_MATRIX = ("entry_names", "entry_values", "default_entry_names", "default_entry_values")

MOST_NAMES = 2000
"""Of which there are two million pairs."""


def allowed_pairs(matrix: Message) -> tuple[list[tuple[str, str]], list[str]]:
    """The pairs of names of which an entry is true, each once, as patterns of those names alone; with `ANY` for a
    default that is true; and the names whose default is false.

    A default holds for pairs of which there is no entry, and of two defaults the false one; where the entries of a
    name forbid something, its default is left out, so that more is measured and not less.

    Raises:
        BadShape: rows and names that are not as many. BadInput: an entry that is neither true nor false.
        DuplicateName: two rows of one name.
    """
    with at("allowed_collision_matrix"):
        require_fields(matrix, *_MATRIX)
        names = _names(matrix, "entry_names")
        if len(names) > MOST_NAMES:
            raise BadScene(f"{len(names)} entry_names are given", valid=f"{MOST_NAMES} or fewer")
        rows = [_row(row, len(names)) for row in items(matrix, "entry_values")]
        require_own_names("entry_name", names)
        if len(rows) != len(names):
            raise BadShape(
                f"{len(rows)} entry_values of {len(names)} entry_names", valid="one each"
            )
        patterns = [pattern_of(name) for name in names]
        pairs = [
            (patterns[i], patterns[j])
            for i in range(len(names))
            for j in range(i + 1, len(names))
            if rows[i][j] and rows[j][i]
        ]
        columns = zip(*rows, strict=True)
        forbidding = {
            name for name, *own in zip(names, rows, columns, strict=True) if not all(map(all, own))
        }
        defaults = _defaults(matrix)
    by_default = [name for name, is_allowed in defaults if is_allowed and name not in forbidding]
    pairs += [(pattern_of(name), ANY) for name in by_default]
    return pairs, [pattern_of(name) for name, is_allowed in defaults if not is_allowed]


def _defaults(matrix: Message) -> list[tuple[str, bool]]:
    names = _names(matrix, "default_entry_names")
    values = items(matrix, "default_entry_values")
    if len(values) != len(names):
        raise BadShape(f"{len(values)} default_entry_values of {len(names)}", valid="one each")
    return [*zip(names, _row(values, len(names)), strict=True)]


def _names(given: Message, key: str, valid: str = "names") -> list[str]:
    names = items(given, key)
    if not all(isinstance(name, str) for name in names):
        raise BadScene("a name is no text", where=key, valid=valid)
    return names


def _row(given: object, n: int) -> list[bool]:
    row = given.get("enabled") if isinstance(given, dict) and len(given) == 1 else given
    if not isinstance(row, list) or len(row) != n:
        raise BadShape(
            f"{given!r:.60} is given", where="entry_values", valid=f"{n} of true or false"
        )
    if not all(value in (0, 1) for value in row):
        raise BadScene(f"{given!r:.60} is given", where="entry_values", valid="true or false")
    return [bool(value) for value in row]
