"""What a scene file says of the robots beside its obstacles: what may touch, what links hold, and padding.

Not for: reading it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from clearance.case.allow import PatternNames, body_names
from clearance.errors import UnknownLink, nearest_name
from clearance.formats.scene.request import ANY, SceneContent
from clearance.world.body import Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.notice import Notice, Severity, listed, naming
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_rest import misplaced, rests_otherwise
from clearance.world.pose_table import WORLD_FRAMES
from clearance.world.robot import JointKind
from clearance.world.rules import Allowance, matches, pattern_of
from clearance.world.timeline import timeline_of
from clearance.world.timing import Window

ORIGIN = 1e-9
"""[m] and [-] How far a link's pose may be off the world's and count as the same."""


def with_scene_rows(case: Case, content: SceneContent) -> tuple[Case, list[str]]:
    """The case with the rows of its scene file after its own, and notes on what could not be taken over.

    Suspect input is added where the frame of the file is a link that is not the world's origin.

    Raises:
        UnknownLink: the frame of the file is neither a link nor the world.
    """
    found = (
        *_on_frame(case, content.frame),
        *_on_bases(case, content),
        *_on_joints(case, content),
        *_on_frames_of_poses(case),
        *_on_padding_left_out(case, content),
    )
    case = replace(case, notices=(*case.notices, *found))
    if not content.allow and not content.link_padding:
        return case, []
    names = body_names(case)
    rows, notes = [], []
    n_links, unknown, unclear = 0, dict[str, None](), list[str]()
    for pair in _each_by_name(case, content, names):
        missing = [name for name in pair if not _any(name, (*names.links, *names.obstacles))]
        unknown |= dict.fromkeys(missing)
        if any(_n_owners(case, name) > 1 for name in pair):
            unclear.append(" - ".join(pair))
        elif not missing:
            row = _row(pair, names)
            n_links += row is None
            rows += [] if row is None else [row]
    if rows:
        notes.append(f"{len(rows)} pairs of the scene's file may touch and are not measured")
    if n_links:
        notes.append(
            f"{n_links} allowed pairs of the scene's file are left out: of two links, of which srdf says more, or "
            "of two obstacles that stand"
        )
    notes += naming("allowed pairs of bodies that are not there are left out", unknown)
    said = "allowed pairs of the scene's file are left out, as it does not say which robot is meant"
    notes += naming(said, unclear)
    robots = tuple(_padded(placed, content.link_padding) for placed in case.robots)
    if content.link_padding:
        notes.append(
            "padding of the scene's file is a distance taken off the clearance, not a larger shape"
        )
    return replace(case, robots=robots, allow=(*case.allow, *rows)), notes


def _on_frame(case: Case, frame: str) -> Iterator[Notice]:
    """A notice for each robot that has the frame of a scene's file as a link, but not where the world is."""
    if not frame or frame in WORLD_FRAMES:
        return
    links = body_names(case).links
    if frame not in links:
        raise UnknownLink(
            f"frame {frame!r} is no link",
            where="frame",
            valid=nearest_name(frame, (*links, WORLD_FRAMES[0])),
        )
    for placed in case.robots:
        link = frame.removeprefix(case.prefix_of(placed))
        if link in placed.robot.link_names and not _is_world(placed, link):
            yield Notice(
                Severity.SUSPECT,
                "frame",
                f"CHECK FRAME: the scene's file is in the frame of link {frame!r}, but is read as the world's. "
                "This link moves or is not at the origin: obstacles may be misplaced; place the robot to agree",
            )


def _on_bases(case: Case, content: SceneContent) -> Iterator[Notice]:
    """A notice for each place where the scene's file says that a robot stands, and no robot of the case does."""
    for joint, pose in content.bases.items():
        standing = (placed.world_from_base for placed in case.robots if placed.mount is None)
        yield from misplaced("the scene's file", joint, pose, standing)


def _on_joints(case: Case, content: SceneContent) -> Iterator[Notice]:
    """A warning on joints that rest elsewhere than the scene's file has them; names of two robots say nothing."""
    owners = Counter(one.name for placed in case.robots for one in placed.robot.moving_joints)
    for placed in case.robots:
        asked = placed.trajectory
        known = set() if asked is None else {*asked.joint_names, *dict(asked.elsewhere)}
        told = {
            name: position
            for name, position in content.joints.items()
            if owners[name] == 1 and name not in known
        }
        yield from rests_otherwise(placed, told, case.prefix_of(placed), "the scene's file says")


def _on_frames_of_poses(case: Case) -> Iterator[Notice]:
    """A notice for each obstacle whose file of poses names another frame than the case does with `on`."""
    for obstacle in case.obstacles:
        frame = "" if obstacle.moves is None else obstacle.moves.frame
        if frame and frame not in _frames_of(case, obstacle):
            read_as = "the world's" if obstacle.mount is None else f"those of {obstacle.mount.on!r}"
            yield Notice(
                Severity.SUSPECT,
                "frame",
                f"CHECK FRAME: poses of obstacle {obstacle.body.name!r} are in frame {frame!r}, but are read as "
                f"{read_as}; give `on: {frame}` if that is a link, or poses in the world",
            )


def _frames_of(case: Case, obstacle: Obstacle) -> Collection[str]:
    """Names of the frame in which the poses of an obstacle are read."""
    if obstacle.mount is not None:
        return obstacle.mount.on, obstacle.mount.on.rpartition("/")[2]
    links = [(placed, link) for placed in case.robots for link in placed.robot.link_names]
    elsewhere = {link for placed, link in links if not _is_world(placed, link)}
    return {*WORLD_FRAMES, *(link for _, link in links)} - elsewhere


def _is_world(placed: PlacedRobot, link: str) -> bool:
    """True for a link that stands at the origin of the world."""
    above = {joint.child: joint for joint in placed.robot.joints}
    pose = np.eye(4)
    while link in above:
        joint = above[link]
        if joint.kind is not JointKind.FIXED:
            return False
        pose, link = joint.parent_from_joint @ pose, joint.parent
    standing = placed.world_from_base @ pose
    return placed.mount is None and bool(np.abs(standing - np.eye(4)).max() < ORIGIN)


def _each_by_name(
    case: Case, content: SceneContent, names: PatternNames
) -> Iterator[tuple[str, str]]:
    """The pairs that the scene's file allows; a default for each link, or obstacle, that none forbids."""
    for first, second in content.allow:
        is_of_obstacle = _any(first, names.obstacles)
        if second != ANY or (is_of_obstacle and len(case.robots) > 1):
            yield first, second
            continue
        for other in names.links if is_of_obstacle else names.obstacles:
            if not any(matches(other, one) for one in content.not_by_default):
                yield first, pattern_of(other)


def _n_owners(case: Case, pattern: str) -> int:
    """How many robots have a link that is called so, without their names."""
    return sum(_any(pattern, placed.robot.link_names) for placed in case.robots)


def _row(pair: tuple[str, str], names: PatternNames) -> Allowance | None:
    """The row of a link and an obstacle, or of two obstacles that can meet."""
    for one, other in (pair, pair[::-1]):
        if _any(one, names.links) and _any(other, names.obstacles):
            return Allowance((one, other))
    if names.obstacles_meet and all(_any(name, names.obstacles) for name in pair):
        return Allowance(pair)
    return None


def _padded(placed: PlacedRobot, given: dict[str, float]) -> PlacedRobot:
    """The robot with padding of those of its links for which the case gives none."""
    own = {link: given[link] for link in placed.robot.link_names if link in given}
    return replace(placed, padding=own | placed.padding)


def _on_padding_left_out(case: Case, content: SceneContent) -> Iterator[Notice]:
    """A warning on padding of links that no robot has: clearances are larger than asked for."""
    links = sorted({link for placed in case.robots for link in placed.robot.link_names})
    missing = [
        link for link, padding in content.link_padding.items() if padding and link not in links
    ]
    if missing:
        text = (
            f"padding of the scene's file is left out, since no robot has such links: "
            f"{listed([repr(link) for link in missing], 6)}; {nearest_name(missing[0], links)}"
        )
        yield Notice(Severity.WARNING, "padding", text)


def _any(pattern: str, names: Collection[str]) -> bool:
    return pattern in names or (
        not {*"*?["}.isdisjoint(pattern) and any(matches(name, pattern) for name in names)
    )


def with_attached_parts(case: Case, content: SceneContent) -> tuple[Case, list[str]]:
    """The case in which the parts that its scene file attaches to links are carried by them, and notes.

    A part that the case says something of is left to it.
    """
    own = {carry.part for carry in case.carries}
    attached = [one for one in content.attached if one.part not in own]
    if not attached:
        return case, []
    names = body_names(case)
    known = (*names.links, *names.obstacles)
    motions = [kinematic_motion(placed) for placed in case.robots]
    start = float(timeline_of(case, motions).times[0])
    carries, unknown = [], dict[str, None]()
    for one in attached:
        there = [name for name in one.touch if any(matches(body, name) for body in known)]
        unknown |= dict.fromkeys(name for name in one.touch if name not in there)
        carries.append(Carry(one.part, one.link, Window(start), tuple(there)))
    parts = [f"{one.part} by {one.link}" for one in attached]
    notes = [
        *naming("attached objects of the scene's file are carried all the time", parts),
        *naming("touch_links that are not there are left out", unknown),
    ]
    return replace(case, carries=(*case.carries, *carries)), notes
