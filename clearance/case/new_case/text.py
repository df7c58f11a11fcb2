"""The scene of a new case: our YAML of what a scene file holds, or that file where our YAML would say less. And
the text of the case file, for people to edit: each key with what it says, and keys that are often wanted next.

Not for: what stands in it (`files`), reading a scene (`scene.request`), nor its text (`scene.scene_yaml`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from clearance.case.new_case.robot import NewCaseRequest
from clearance.case.scene_rows import with_attached_parts, with_scene_rows
from clearance.errors import shown
from clearance.formats.files.input_files import path_from, resolved
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import (
    SKIP,
    SceneContent,
    SceneRequest,
    includes_of,
    read_scene,
)
from clearance.formats.scene.scene_yaml import written_scene
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.formats.text.notes import counted
from clearance.formats.text.yaml_text import flow
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.notice import KINDS
from clearance.world.placed_robot import PlacedRobot

SCENE = "scene.yaml"


@dataclass(frozen=True)
class NewScene:
    """What a new case says of its scene.

    Attributes:
        name: the scene's file; None where nothing stands around the robot. remark: beside it.
        contents: of the files to write, by name.
        carry, allow, padding: what its file says of links. taken, notes: a line each. includes: as in a case.
    """

    name: str | None
    remark: str
    contents: Mapping[str, bytes] = field(default_factory=dict)
    carry: Sequence[Mapping[str, Any]] = ()
    allow: Sequence[tuple[str, str]] = ()
    padding: Mapping[str, float] = field(default_factory=dict)
    taken: Sequence[str] = ()
    notes: Sequence[str] = ()
    includes: Mapping[str, str] = field(default_factory=dict)


def new_scene(
    given: NewCaseRequest,
    placed: PlacedRobot,
    meshes: MeshStore,
    folder: Path,
) -> NewScene:
    """The scene in a file, as a case in `folder` is to name it.

    A file whose reader warns of something is named as it is, so that each check warns of it too.

    Raises:
        BadInput: as its reader says.
    """
    if given.scene is None:
        return NewScene(None, "assumed: nothing stands around the robot")
    package_dirs = tuple(Path(one) for one in given.package_dirs)
    said = includes_of(given.includes, Path())
    asked = SceneRequest(resolved(given.scene, Path()), meshes.files, package_dirs, said)
    content = read_scene(asked)
    rows = content.scene["obstacles"]  # type: ignore[index]  # as the reader checked
    heading = f"scene from {asked.shown}: {counted(len(rows), 'obstacle')}"
    case, notes = _with_rows(content, asked, placed, meshes)
    if content.notices or case.notices:
        headings = (f"{heading}; it stays the file that it is, since it brings a warning",)
        return NewScene(
            path_from(folder, given.scene),
            "as it is, since it brings a warning",
            taken=headings,
            includes=_seen_from(folder, given.includes),
        )
    made = written_scene(content, asked, folder, "clearance new")
    return NewScene(
        SCENE,
        f"from {asked.shown}",
        {SCENE: made.content, **made.meshes},
        [_carried(carry) for carry in case.carries],
        [row.between for row in case.allow],
        case.robots[0].padding,
        (heading,),
        (*content.notes, *notes),
    )


def _with_rows(
    content: SceneContent, asked: SceneRequest, placed: PlacedRobot, meshes: MeshStore
) -> tuple[Case, list[str]]:
    """The case with what the scene's file says of links, and notes on that."""
    scene = validated(Scene, content.scene, asked.shown)
    obstacles, _ = make_obstacles(scene.obstacles, asked.path.parent, meshes)
    case, row_notes = with_scene_rows(Case("new", (placed,), obstacles), content)
    case, attached_notes = with_attached_parts(case, content)
    return case, [*row_notes, *attached_notes]


def _seen_from(folder: Path, includes: Mapping[str, str]) -> dict[str, str]:
    """What is taken for models, paths as a case in a folder has them."""
    return {
        uri: model if model == SKIP or "://" in model else path_from(folder, model)
        for uri, model in includes.items()
    }


def _carried(carry: Carry) -> dict[str, Any]:
    """A part that is carried all the time, as a case file has it."""
    touch = {"touch": list(carry.touch)} if carry.touch else {}
    return {"part": carry.part, "by": carry.by, "from": carry.window.start, **touch}


TOUCHING = "these pairs touch at every step"
"""What is said of pairs that may be meant to touch."""


@dataclass(frozen=True)
class CaseText:
    """What a new case file says.

    Attributes:
        name: of the case. made_from: the files, as they are shown.
        robot: its keys and values, in order. link: its first with a shape, for examples.
        resting: what stands under `joints`. states: of which one could stand there.
        trajectory: its keys, the file at least; `motion` says where it comes from, `motion_notes` how it was read.
            motion_keys: keys that the trajectory needs but that only the reader knows, as YAML, and why.
        touching: pairs that touch at every step, to be allowed where that is meant.
        remarks: why a key is as it is, by key.
        limits: `fail` and `warn` [m]; None where not given.
    """

    name: str
    made_from: Sequence[str]
    robot: Mapping[str, Any]
    link: str
    resting: Mapping[str, Any]
    states: Sequence[str]
    scene: NewScene
    trajectory: Mapping[str, Any]
    motion: str
    motion_notes: Sequence[str] = ()
    motion_keys: Sequence[tuple[str, str]] = ()
    touching: Sequence[tuple[str, str]] = ()
    remarks: Mapping[str, str] = field(default_factory=dict)
    limits: Mapping[str, float | None] = field(default_factory=dict)


def text_of(case: CaseText) -> str:
    """The case file."""
    return "\n".join([*_lines(case), ""])


def _lines(case: CaseText) -> Iterator[str]:
    yield f"# Made by `clearance new` from {shown(', '.join(case.made_from))}; yours to edit."
    yield "# Metres, radians, seconds. A key behind a # is one that is often wanted."
    yield f"name: {flow(case.name)}"
    yield "robot:"
    yield from (f"  {line}" for line in _robot(case))
    yield from _scene(case)
    yield from (f"# {shown(note)}" for note in case.motion_notes)
    path = case.trajectory["file"] if [*case.trajectory] == ["file"] else case.trajectory
    yield f"trajectory: {flow(path)}  # {shown(case.motion)}"
    for key, why in case.motion_keys:
        yield f"# trajectory: {flow(case.trajectory)[:-1]}, {key}}}  # {shown(why)}"
    if case.scene.carry:
        yield "carry:  # from the scene's file, in which links hold them"
        yield from (f"- {flow(one)}" for one in case.scene.carry)
    yield from _allow(case)
    yield "limits:"
    assumed = "  # assumed: only contact fails, any gap passes; 0.005 asks for 5 mm"
    fail, warn = case.limits.get("fail"), case.limits.get("warn")
    yield f"  fail: {fail or 0.0}{assumed if fail is None else ''}"
    yield f"  {'# ' if warn is None else ''}warn: {warn or 0.02}  # closer than this is a near miss"
    yield "  # joints: fail  # a joint beyond its limits is a violation, not a warning"
    yield f"# accept: [units]  # suspect input that is meant: {', '.join(KINDS)}"
    yield "# report: {author: J. Doe, revision: A}  # shown on the page, with fields to sign"


def _robot(case: CaseText) -> Iterator[str]:
    for key, value in case.robot.items():
        remark = case.remarks.get(key) or _REMARKS.get(key, "")
        yield f"{key}: {flow(value)}" + (f"  # {remark}" if remark else "")
    if "base" not in case.robot:  # an SRDF moves it, and each check warns until this is said
        yield f"# base: {{xyz: [0.0, 0.0, 0.0], rpy: [0.0, 0.0, 0.0]}}{_remark(case, 'base')}"
    yield from _resting(case)
    if "self_clearance" not in case.robot:
        yield "# self_clearance: true  # links of the robot against each other, too"
    if "srdf" not in case.robot:
        yield "# srdf: robot.srdf  # with self_clearance: which pairs of links are excused, and why"
    elif case.robot.get("self_clearance"):
        yield "# trust_never: true  # pairs that the SRDF calls Never are excused too; now they are measured"
    yield f"# exclude_links: [{flow(case.link)}]  # not measured, as a link that is bolted to what it stands on"


def _resting(case: CaseText) -> Iterator[str]:
    if not case.resting:
        return
    assumed = {
        name for name, value in case.resting.items() if value == 0.0 and name in case.remarks
    }
    mark = "# " if len(assumed) == len(case.resting) else ""
    yield f"{mark}joints:  # those that the trajectory does not move"
    if case.states:
        yield f"  # state: {flow(case.states[0])}  # where a state says; there are {flow(case.states)}"
    for name, value in case.resting.items():
        mark = "# " if name in assumed else ""  # left to the check, which notes that nobody gave it
        yield f"{mark}  {flow(name)}: {flow(value)}{_remark(case, name)}"


def _scene(case: CaseText) -> Iterator[str]:
    scene, remark = case.scene, f"  # {shown(case.scene.remark)}"
    if scene.name is not None:
        yield f"scene: {flow(scene.name)}{remark}"
        if scene.includes:
            yield f"includes: {flow(scene.includes)}"
        return
    yield "scene:"
    yield f"  obstacles: []{remark}; in place of []:"
    yield "  # - {name: table, box: {size: [1.0, 1.0, 0.02]}, pose: {xyz: [0.5, 0.0, -0.01]}}"
    yield "  # - {name: fixture, mesh: {file: fixture.stl, scale: 0.001}, pose: {xyz: [0.6, 0.0, 0.0]}}"


def _allow(case: CaseText) -> Iterator[str]:
    if case.scene.allow:
        yield "allow:  # pairs that are not measured; from the scene's file"
        yield from (f"- {flow(list(pair))}" for pair in case.scene.allow)
    elif not case.touching:
        yield f"# allow: [[{flow(case.link)}, table]]  # pairs that are not measured; wildcards in quotes"
    if case.touching:
        yield f"# {TOUCHING.capitalize()}; where that is meant, uncomment:"
        yield from [] if case.scene.allow else ["# allow:"]
        yield from (f"# - {flow(list(pair))}" for pair in case.touching)


def _remark(case: CaseText, key: str) -> str:
    return f"  # {shown(case.remarks[key])}" if key in case.remarks else ""


_REMARKS = {
    "xacro": "xacro makes URDF of it, which evaluates the Python in it",
    "package_dirs": "where package://x is looked for first",
    "geometry": "or visual, or collision_or_visual: visual where a link has no other",
    "self_clearance": "links of the robot against each other, too",
    "srdf": "which pairs of links are excused, and why",
    "joint_limits": "narrower than the robot's file; what goes beyond is a warning",
    "controllers": "path tolerances, kept for notes",
    "padding": "taken off the clearance of these links; from the scene's file",
}
