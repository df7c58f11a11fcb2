"""The drawing data of a record: shapes, poses frame by frame, and the line between the witness points.

The page in a report and the live viewer both draw from this, so they show the same frames. Geometry
and poses are float32, which is for the eye only; times, clearances and witness points stay float64.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import BadSyntax, MissingFile
from clearance.world.pairs import OBSTACLE

FILE_NAME = "replay.npz"
_FORMAT = 6


LINK, STANDING, MOVING, PART = "link", "obstacle", "moving", "part"
"""Kinds of bodies as they are drawn: links, obstacles that stand (a robot's own floor too), that move, and parts
that are carried at some time."""


@dataclass(frozen=True)
class DrawnBody:
    """A body as it is drawn: `kind` is one of those above, `i_shape` its place in the shapes, `i_robot` its
    robot's or -1."""

    name: str
    kind: str
    measured: bool
    i_shape: int
    i_robot: int = OBSTACLE


@dataclass(frozen=True)
class DrawnCarry:
    """A part in the hands of a body from a time to another [s]; `i_part`, `i_by` are their places in the bodies,
    `i_by` -1 where what carries it is not drawn."""

    part: str
    by: str
    i_part: int
    i_by: int
    start: float
    end: float


@dataclass(frozen=True)
class DrawnContact:
    """One overlap: in which frame, between whom, where its arrow starts and points (world frame, [m]).

    `exact` and `volume_exact` are False where `penetration` [m] and `volume` [m^3] are upper bounds; lower ones
    stand beside them.
    """

    frame: int
    link: str
    obstacle: str
    penetration: float
    penetration_at_least: float
    volume: float
    volume_at_least: float
    exact: bool
    volume_exact: bool
    start: tuple[float, float, float]
    direction: tuple[float, float, float]


class EarlierBody(NamedTuple):
    """Where a body of a replay was before.

    Attributes:
        i_body: its place in the replay's bodies. poses: as those of `Replay`. shown: (frames,) uint8.
    """

    i_body: int
    poses: np.ndarray
    shown: np.ndarray


class DrawnMoment(NamedTuple):
    """A moment of one pair: its frame, clearance [m], index into `STATUSES`, witness points (6,) [m] in the world
    frame, and the places of its two bodies, -1 where one is not drawn."""

    frame: int
    clearance: float
    status: int
    line: tuple[float, ...]
    bodies: tuple[int, int]


@dataclass(frozen=True)
class DrawnRule:
    """A rule that frames are held against: its name and its limits [m]."""

    name: str
    fail: float
    warn: float


@dataclass(frozen=True, eq=False)
class Replay:
    """The frames of one record.

    Attributes:
        rules: what frames are held against.
        worst: the most critical moment of what decides the verdict.
        n_steps: number of steps of the record; those of `steps` that are not `between` are frames.
        shapes: vertices (n, 3) float32 [m] and triangles (m, 3) int32 of each different shape.
        poses: for each body (frames, 7) or, where it stands still, (1, 7) float32: xyz [m] and
            quat_xyzw, in the world frame.
        shown: for each body (frames,) or (1,) uint8, 0 while it is not in the cell.
        carries: who carries what from when until when.
        steps, times, clearances: (frames,) step index, [s], [m].
        times_b: (frames,) [s] when the second body of the line is there, if its clock is another; else NaN.
        rule: (frames,) int32 into `rules`, of what judges it.
        between: (frames,) uint8, 1 for a moment between that step and the next, where the motion is worse than at
            both.
        known: (frames,) uint8, 0 where the clearance is only a proven lower bound; then the line has no
            length and nothing is nearest.
        status: (frames,) uint8 indices into `STATUSES`.
        lines: (frames, 6) [m] witness points on the two bodies in the world frame.
        nearest: (frames, 2) int32 indices into `bodies` of the two; -1: there is none.
        move: (frames,) int32 indices into `moves`, the names of a program's moves; -1: none is made.
        contacts: the overlaps that are drawn, frames first.
        regions: of each contact the common region's vertices (n, 3) float32 [m] in the world frame and
            triangles (m, 3) int32.
    """

    name: str
    rules: tuple[DrawnRule, ...]
    n_steps: int
    bodies: tuple[DrawnBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    poses: tuple[np.ndarray, ...]
    shown: tuple[np.ndarray, ...]
    carries: tuple[DrawnCarry, ...]
    worst: DrawnMoment
    steps: np.ndarray
    times: np.ndarray
    times_b: np.ndarray
    clearances: np.ndarray
    between: np.ndarray
    known: np.ndarray
    status: np.ndarray
    rule: np.ndarray
    lines: np.ndarray
    nearest: np.ndarray
    move: np.ndarray
    moves: tuple[str, ...] = ()
    contacts: tuple[DrawnContact, ...] = ()
    regions: tuple[tuple[np.ndarray, np.ndarray], ...] = ()

    @property
    def i_worst(self) -> int:
        """The frame of the most critical moment."""
        return self.worst.frame

    def save(self, path: Path) -> None:
        """Writes everything into one compressed file; the same replay gives the same bytes."""
        arrays = {name: getattr(self, name) for name in _FRAME_ARRAYS}
        for i, (vertices, triangles) in enumerate(self.shapes):
            arrays[f"vertices_{i}"], arrays[f"triangles_{i}"] = vertices, triangles
        for i, (poses, shown) in enumerate(zip(self.poses, self.shown, strict=True)):
            arrays[f"poses_{i}"], arrays[f"shown_{i}"] = poses, shown
        for i, (vertices, triangles) in enumerate(self.regions):
            arrays[f"region_vertices_{i}"], arrays[f"region_triangles_{i}"] = vertices, triangles
        head = {
            "format": _FORMAT,
            "name": self.name,
            "worst": self.worst,
            "rules": [asdict(rule) for rule in self.rules],
            "carries": [asdict(carry) for carry in self.carries],
            "n_steps": self.n_steps,
            "n_shapes": len(self.shapes),
            "bodies": [asdict(body) for body in self.bodies],
            "contacts": [asdict(contact) for contact in self.contacts],
            "moves": self.moves,
        }
        text = json.dumps(head, sort_keys=True).encode()
        np.savez_compressed(path, head=np.frombuffer(text, dtype=np.uint8), **arrays)


_FRAME_ARRAYS = (
    "steps", "times", "times_b", "clearances", "between", "known", "status", "rule", "lines", "nearest",
    "move",
)  # fmt: skip


def load_replay(path: Path) -> Replay:
    """The replay that `Replay.save` wrote.

    Raises:
        MissingFile: no such file. BadSyntax: it is not a replay of this version.
    """
    if not path.is_file():
        raise MissingFile(
            "no replay here", where=str(path), valid="a folder that `clearance check --out` wrote"
        )
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            head = json.loads(stored["head"].tobytes())
            if head["format"] != _FORMAT:
                raise ValueError(f"format {head['format']}")
            return _from_arrays(head, dict(stored))
    except Exception as error:  # np.load raises many kinds for a damaged archive
        raise BadSyntax(
            f"not a replay of this version ({type(error).__name__}: {error})",
            where=str(path),
            valid="run `clearance check` again",
        ) from None


def _moment(row: list) -> DrawnMoment:
    frame, clearance, status, line, bodies = row
    return DrawnMoment(frame, clearance, status, tuple(line), tuple(bodies))


def _from_arrays(head: dict, arrays: dict[str, np.ndarray]) -> Replay:
    n_shapes, n_bodies = head["n_shapes"], len(head["bodies"])
    return Replay(
        name=head["name"],
        worst=_moment(head["worst"]),
        rules=tuple(DrawnRule(**rule) for rule in head["rules"]),
        carries=tuple(DrawnCarry(**carry) for carry in head["carries"]),
        n_steps=head["n_steps"],
        moves=tuple(head["moves"]),
        bodies=tuple(DrawnBody(**body) for body in head["bodies"]),
        shapes=tuple((arrays[f"vertices_{i}"], arrays[f"triangles_{i}"]) for i in range(n_shapes)),
        poses=tuple(arrays[f"poses_{i}"] for i in range(n_bodies)),
        shown=tuple(arrays[f"shown_{i}"] for i in range(n_bodies)),
        contacts=tuple(
            DrawnContact(
                **row | {"start": tuple(row["start"]), "direction": tuple(row["direction"])}
            )
            for row in head["contacts"]
        ),
        regions=tuple(
            (arrays[f"region_vertices_{i}"], arrays[f"region_triangles_{i}"])
            for i in range(len(head["contacts"]))
        ),
        **{name: arrays[name] for name in _FRAME_ARRAYS},
    )
