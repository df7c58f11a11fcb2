"""`clearance view`: a replay, or the folder of one, playing live in meshcat.

In the browser: meshcat's panel (open it at the top right) plays, pauses and scrubs; a slider walks
through the steps and buttons jump to the worst step and to where each limit is entered. Not for:
making reports.
"""

from __future__ import annotations

import json
import math
import signal
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import MissingFile
from clearance.extras import importing
from clearance.record.replay import (
    FILE_NAME,
    LINK,
    MOVING,
    PART,
    STANDING,
    DrawnBody,
    Replay,
    load_replay,
)
from clearance.record.status import STATUSES

if TYPE_CHECKING:
    from clearance.view.viewer import LiveScene

COLOURS = {"clear": 0x2B7A4B, "near": 0xC77D0A, "violated": 0xC0281C, "contact": 0x8A0F45}
ROBOTS, LINK_NOT_MEASURED = (0x5C7390, 0x7D6796, 0x4B7F78, 0x94705C), 0xA9B4C0
OTHERS = {STANDING: (0xB9B4A8, 0.5), MOVING: (0x9C9480, 0.72), PART: (0xB3892F, 1.0)}
"""Colour and opacity of what is no link."""

FOLDERS = {LINK: "links", STANDING: "obstacles", MOVING: "moving", PART: "parts"}
"""Where bodies of a kind are in meshcat's tree."""

REGION, WAY_OUT = 0xE01010, 0x4A0008


class Playback:
    """A record that is playing; the server runs until `close`, or as a context manager until its
    end."""

    def __init__(self, replay: Replay) -> None:
        with importing("view", "the live view"):
            from clearance.view.viewer import LiveScene

        self.replay = replay
        self._stage = LiveScene()
        fill(self._stage, replay)

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        return self._stage.url

    def wait(self) -> None:
        """Returns when the user interrupts, or when this process is asked to end. To be called in the main
        thread."""
        with _until_interrupted():
            threading.Event().wait()

    def close(self) -> None:
        """Ends the server."""
        self._stage.close()

    def __enter__(self) -> Playback:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()


def show(what: Replay | str | Path, open_browser: bool = True) -> None:
    """Plays a replay, or the folder of a report, until the user interrupts; prints the address.

    Raises:
        MissingFile: the folder is not there or holds no report. BadSyntax: its replay is damaged.
    """
    with play(what) as playback, _until_interrupted():
        print(f"{playback.replay.name} is playing at {playback.url} (Ctrl-C ends it)", flush=True)
        if open_browser:
            webbrowser.open(playback.url, new=2)
        playback.wait()


@contextmanager
def _until_interrupted() -> Iterator[None]:
    """Ends the block, without an error, at Ctrl-C or where this process is asked to end."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        return
    finally:
        signal.signal(signal.SIGTERM, before)


def play(what: Replay | str | Path) -> Playback:
    """A live viewer of a replay, or of the folder of a report, that runs in the background.

    Raises:
        MissingFile: the folder is not there or holds no report. BadSyntax: its replay is damaged.
        Unavailable: a library of the extra `view` is missing.
    """
    return Playback(what if isinstance(what, Replay) else _replay_in(Path(what)))


def _replay_in(folder: Path) -> Replay:
    if not folder.is_dir():
        raise MissingFile(
            "no such folder", where=str(folder), valid="a folder that `clearance check --out` wrote"
        )
    return load_replay(folder / FILE_NAME)


def fill(stage: LiveScene, replay: Replay) -> None:
    """Puts everything that `replay` holds on the stage: bodies, marks, animation, controls,
    camera."""
    times = (replay.times - replay.times[0]).tolist()
    box = _box(replay)
    size = float(np.linalg.norm(box[1] - box[0]))
    for i, body in enumerate(replay.bodies):
        path = f"{FOLDERS[body.kind]}/{i} {body.name.replace('/', ' ')}"
        vertices, triangles = replay.shapes[body.i_shape]
        if len(triangles):
            stage.mesh(path, vertices, triangles, *_look(body))
        else:
            stage.points(path, vertices, _look(body)[0])
        _place(stage, path, replay.poses[i], times)
        _show(stage, path, replay.shown[i], times)
    _marks(stage, replay, times, size)
    _contacts(stage, replay, times, size)
    stage.look(box.mean(axis=0), box.mean(axis=0) + 1.5 * size * _free_side(replay))
    _controls(stage, replay, times)
    stage.finish()


def _look(body: DrawnBody) -> tuple[int, float]:
    """Colour and opacity of a body."""
    if body.kind == LINK:
        return (ROBOTS[body.i_robot % len(ROBOTS)] if body.measured else LINK_NOT_MEASURED), 1.0
    return OTHERS[body.kind]


def _show(stage: LiveScene, path: str, shown: np.ndarray, times: list[float]) -> None:
    """Hides a body while it is not in the cell."""
    if not shown.all():
        seen = np.broadcast_to(shown, len(times)).astype(bool).tolist()
        stage.animate(path, "visible", "bool", times, seen)


def _place(stage: LiveScene, path: str, poses: np.ndarray, times: list[float]) -> None:
    from scipy.spatial.transform import Rotation

    first = np.eye(4)
    first[:3, :3], first[:3, 3] = Rotation.from_quat(poses[0, 3:]).as_matrix(), poses[0, :3]
    stage.place(path, first)
    if len(poses) > 1:
        stage.animate(path, "position", "vector3", times, poses[:, :3].tolist())
        stage.animate(path, "quaternion", "quaternion", times, poses[:, 3:].tolist())


def _marks(stage: LiveScene, replay: Replay, times: list[float], size: float) -> None:
    """One line with two dots for each status that occurs; the one that holds is visible."""
    positions, turns, scales = line_tracks(replay.lines)
    for code in np.unique(replay.status).tolist():
        path = f"clearance/{STATUSES[code]}"
        colour = COLOURS[STATUSES[code]]
        stage.rod(f"{path}/line", size / 400, colour)
        stage.animate(f"{path}/line", "position", "vector3", times, positions)
        stage.animate(f"{path}/line", "quaternion", "quaternion", times, turns)
        stage.animate(f"{path}/line", "scale", "vector3", times, scales)
        for name, columns in (("first", slice(0, 3)), ("second", slice(3, 6))):
            stage.ball(f"{path}/{name} point", size / 180, colour)
            stage.animate(
                f"{path}/{name} point",
                "position",
                "vector3",
                times,
                replay.lines[:, columns].tolist(),
            )
        stage.animate(path, "visible", "bool", times, (replay.status == code).tolist())


def _contacts(stage: LiveScene, replay: Replay, times: list[float], size: float) -> None:
    """Each overlap in red, with an arrow along the way out; seen in its frame only."""
    shown = zip(replay.contacts, replay.regions, strict=True)
    for i, (contact, (vertices, triangles)) in enumerate(shown):
        path = f"contacts/{i}"
        if len(triangles):
            stage.region(f"{path}/region", vertices, triangles, REGION)
        foot = np.array(contact.start)
        reach = np.array(contact.direction) * size / 12
        stage.arrow(f"{path}/arrow", foot, foot + reach, size / 450, WAY_OUT)
        at, keys = contact.frame, [(times[contact.frame], True)]
        keys = [(times[0], False)] * (at > 0) + keys
        keys += [(time, False) for time in times[at + 1 : at + 2]]
        stage.animate(path, "visible", "bool", *zip(*keys, strict=True))


def line_tracks(lines: np.ndarray) -> tuple[list, list, list]:
    """Middle, turn (quat_xyzw of the least turn from z) and scale of a unit rod that reaches from
    point to point.

    Args:
        lines: (n, 6) [m].
    """
    along = lines[:, 3:] - lines[:, :3]
    lengths = np.linalg.norm(along, axis=1)
    unit = np.where(
        lengths[:, None] > 0, along / np.maximum(lengths, 1e-300)[:, None], [0.0, 0.0, 1.0]
    )
    x, y, z = unit.T
    down = z < -1 + 1e-12  # half a turn about x where the line points straight down
    turns = np.column_stack(
        [np.where(down, 1.0, -y), np.where(down, 0.0, x), 0 * z, np.where(down, 0.0, 1 + z)]
    )
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    scales = np.column_stack([np.ones_like(z), np.ones_like(z), np.maximum(lengths, 1e-9)])
    return (0.5 * (lines[:, :3] + lines[:, 3:])).tolist(), turns.tolist(), scales.tolist()


def _controls(stage: LiveScene, replay: Replay, times: list[float]) -> None:
    """A step slider and the buttons; times aim at the middle of a frame, which rounding cannot
    miss."""
    middles = _middles(np.array(times)).tolist()
    worst = replay.i_worst
    stage.slider(
        "step", f"(i) => {{const t = {json.dumps(middles)}[Math.round(i)]; {_JUMP}}}", len(middles)
    )
    micrometres = math.floor(replay.clearances[worst] * 1e6)  # down: never more than was measured
    jumps = {f"worst: {micrometres / 1000:.3f} mm at {replay.times[worst]:.3f} s": worst}
    for code, name in ((1, "first near miss"), (2, "first violation"), (3, "first contact")):
        if (replay.status == code).any():
            jumps[name] = int(np.argmax(replay.status == code))
    for carry in replay.carries:
        jumps[f"{carry.by} takes {carry.part} at {carry.start:.3f} s"] = _frame_at(
            replay, carry.start
        )
    if replay.contacts:
        deepest = max(replay.contacts, key=lambda contact: contact.penetration)
        jumps[f"deepest contact: {math.ceil(deepest.penetration * 1e6) / 1000:.3f} mm"] = (
            deepest.frame
        )
    for name, frame in jumps.items():
        stage.button(name, f"() => {{const t = {middles[frame]!r}; {_JUMP}}}")


def _frame_at(replay: Replay, time: float) -> int:
    """The first frame at a time or after it."""
    return min(int(np.searchsorted(replay.times, time)), len(replay.times) - 1)


# play first: only an animation that has started can be set to a time
_JUMP = (
    "this.animator.play(); this.animator.pause(); "
    "this.animator.seek(t); this.animator.display_progress(t);"
)


def _middles(times: np.ndarray) -> np.ndarray:
    """(n,) a time inside each frame; the last one a little late, where meshcat stops at the end."""
    return np.append(0.5 * (times[:-1] + times[1:]), times[-1] + 1e-3)


def _free_side(replay: Replay) -> np.ndarray:
    """(3,) unit: from where to look, askance from the side on which the robot stands to its nearest
    obstacles."""
    x, y, _ = (replay.lines[:, :3] - replay.lines[:, 3:]).mean(axis=0)
    turn = np.arctan2(y, x) + 0.9
    return np.array([np.cos(turn) * np.cos(0.4), np.sin(turn) * np.cos(0.4), np.sin(0.4)])


def _box(replay: Replay) -> np.ndarray:
    """(2, 3) [m] of where all that moves is over all frames and the witness points, a fifth wider."""
    points = [replay.lines.reshape(-1, 3)]
    for body, poses in zip(replay.bodies, replay.poses, strict=True):
        if body.kind != STANDING:
            points.append(poses[:, :3])
    everything = np.concatenate(points)
    low, high = everything.min(axis=0), everything.max(axis=0)
    return np.array([low - 0.2 * (high - low), high + 0.2 * (high - low)])
