"""What it takes to draw a record again: shapes, poses frame by frame, and the line between the
witness points.

The page in a report and the live viewer both draw from this, so they show the same frames. Geometry
and poses are float32, which is for the eye only; times, clearances and witness points stay float64.
Not for: measuring.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from clearance.errors import BadSyntax, MissingFile
from clearance.geometry.polyhedron import Polyhedron
from clearance.simulate.record import Record
from clearance.simulate.replay_contact import DrawnContact, drawn_contacts
from clearance.simulate.replay_frames import ReplayFrames, kept_moments, least_of
from clearance.simulate.resumable_rows import IN_MEMORY, MeasuredRows
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion

MAX_FRAMES = 3000
"""Most frames kept: at 20 links these are 1.7 MB of poses, and no screen is wider in pixels."""

FILE_NAME = "replay.npz"
_FORMAT = 3


@dataclass(frozen=True)
class DrawnBody:
    """A body as it is drawn: `kind` is "link" or "obstacle", `i_shape` its place in the shapes."""

    name: str
    kind: str
    measured: bool
    i_shape: int


@dataclass(frozen=True, eq=False)
class Replay:
    """The frames of one record.

    Attributes:
        limits: (fail, warn) [m].
        n_steps: number of steps of the record; those of `steps` that are not `between` are frames.
        shapes: vertices (n, 3) float32 [m] and triangles (m, 3) int32 of each different shape.
        poses: for each body (frames, 7) or, where it stands still, (1, 7) float32: xyz [m] and
            quat_xyzw, in the world frame.
        steps, times, clearances: (frames,) step index, [s], [m].
        between: (frames,) uint8, 1 for a moment between that step and the next, where the motion is worse than at
            both.
        known: (frames,) uint8, 0 where the clearance is only a proven lower bound; then the line has no
            length and nothing is nearest.
        status: (frames,) uint8 indices into `STATUSES`.
        lines: (frames, 6) [m] witness points on link and obstacle in the world frame.
        nearest: (frames, 2) int32 indices into `bodies` of link and obstacle; -1: there is none.
        contacts: the overlaps that are drawn, frames first.
        regions: of each contact the common region's vertices (n, 3) float32 [m] in the world frame and
            triangles (m, 3) int32.
    """

    name: str
    limits: tuple[float, float]
    n_steps: int
    bodies: tuple[DrawnBody, ...]
    shapes: tuple[tuple[np.ndarray, np.ndarray], ...]
    poses: tuple[np.ndarray, ...]
    steps: np.ndarray
    times: np.ndarray
    clearances: np.ndarray
    between: np.ndarray
    known: np.ndarray
    status: np.ndarray
    lines: np.ndarray
    nearest: np.ndarray
    contacts: tuple[DrawnContact, ...] = ()
    regions: tuple[tuple[np.ndarray, np.ndarray], ...] = ()

    @property
    def i_worst(self) -> int:
        """The first frame of least known clearance."""
        return int(np.argmin(np.where(self.known, self.clearances, np.inf)))

    def save(self, path: Path) -> None:
        """Writes everything into one compressed file; the same replay gives the same bytes."""
        arrays = {name: getattr(self, name) for name in _FRAME_ARRAYS}
        for i, (vertices, triangles) in enumerate(self.shapes):
            arrays[f"vertices_{i}"], arrays[f"triangles_{i}"] = vertices, triangles
        for i, poses in enumerate(self.poses):
            arrays[f"poses_{i}"] = poses
        for i, (vertices, triangles) in enumerate(self.regions):
            arrays[f"region_vertices_{i}"], arrays[f"region_triangles_{i}"] = vertices, triangles
        head = {
            "format": _FORMAT,
            "name": self.name,
            "limits": self.limits,
            "n_steps": self.n_steps,
            "n_shapes": len(self.shapes),
            "bodies": [asdict(body) for body in self.bodies],
            "contacts": [asdict(contact) for contact in self.contacts],
        }
        text = json.dumps(head, sort_keys=True).encode()
        np.savez_compressed(path, head=np.frombuffer(text, dtype=np.uint8), **arrays)


_FRAME_ARRAYS = ("steps", "times", "clearances", "between", "known", "status", "lines", "nearest")


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
        with np.load(path, allow_pickle=False) as stored:
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


def _from_arrays(head: dict, arrays: dict[str, np.ndarray]) -> Replay:
    n_shapes, n_bodies = head["n_shapes"], len(head["bodies"])
    return Replay(
        name=head["name"],
        limits=tuple(head["limits"]),
        n_steps=head["n_steps"],
        bodies=tuple(DrawnBody(**body) for body in head["bodies"]),
        shapes=tuple((arrays[f"vertices_{i}"], arrays[f"triangles_{i}"]) for i in range(n_shapes)),
        poses=tuple(arrays[f"poses_{i}"] for i in range(n_bodies)),
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


def replay_of(
    record: Record, max_frames: int = MAX_FRAMES, rows: MeasuredRows = IN_MEMORY
) -> Replay:
    """The replay of a record: every step, or where there are more than `max_frames` a choice that
    keeps the least clearance of every stretch, the worst step, the step of every pair's minimum,
    and the deepest contact; and moments between them where the motion is worse."""
    kept = kept_steps(record, max_frames)
    moments = kept_moments(record)
    contacts, regions = drawn_contacts(record, kept)
    frames = ReplayFrames.of(record, kept, moments, rows)
    bodies, shapes, poses = _drawn_bodies(record, frames.positions)
    index = {(body.kind, body.name): i for i, body in enumerate(bodies)}
    nearest = [
        (index.get(("link", a), -1), index.get(("obstacle", b), -1)) for a, b in frames.pairs
    ]
    place_of = {
        int(step): i
        for i, step in enumerate(frames.arrays["steps"])
        if not frames.arrays["between"][i]
    }
    return Replay(
        name=record.case.name,
        limits=(record.case.limits.fail, record.case.limits.warn),
        n_steps=record.steps.num_rows,
        bodies=bodies,
        shapes=shapes,
        poses=poses,
        nearest=np.array(nearest, dtype=np.int32).reshape(-1, 2),
        contacts=tuple(replace(one, frame=place_of[int(kept[one.frame])]) for one in contacts),
        regions=regions,
        **frames.arrays,
    )


def kept_steps(record: Record, max_frames: int) -> np.ndarray:
    """(frames,) int64 increasing step indices: all, or the choice that `replay_of` describes."""
    clearances = least_of(record.steps)
    n_steps = len(clearances)
    if n_steps <= max_frames:
        return np.arange(n_steps)
    pair_steps = [minimum.step for minimum in record.pair_minima]
    deepest = [] if record.deepest is None else [record.deepest.step]
    kept = {0, n_steps - 1, record.worst_step, *pair_steps, *deepest}
    edges = np.linspace(0, n_steps, max(1, (max_frames - len(kept)) // 2) + 1).astype(np.int64)
    starts = np.unique(edges[:-1])
    least = [
        a + int(np.argmin(clearances[a:b]))
        for a, b in zip(starts, [*starts[1:], n_steps], strict=True)
    ]
    return np.array(sorted(kept.union(starts.tolist(), least)), dtype=np.int64)


def _drawn_bodies(record: Record, positions: Sequence[np.ndarray]) -> tuple[tuple, tuple, tuple]:
    shapes: list[tuple[np.ndarray, np.ndarray]] = []
    seen: dict[bytes, int] = {}
    bodies: list[DrawnBody] = []
    poses: list[np.ndarray] = []
    for motion, reached in zip(record.motions, positions, strict=True):
        placed = motion.placed
        world_from_link = link_poses(placed, reached)
        for body in placed.robot.bodies:
            i_link = placed.robot.link_names.index(body.name)
            name, measured = (
                link_label(record, motion, body.name),
                body.name not in placed.exclude_links,
            )
            bodies.append(DrawnBody(name, "link", measured, _shape_index(body.shape, shapes, seen)))
            poses.append(_packed(world_from_link[:, i_link]))
    for obstacle in record.case.obstacles:
        i_shape = _shape_index(obstacle.body.shape, shapes, seen)
        bodies.append(DrawnBody(obstacle.name, "obstacle", True, i_shape))
        poses.append(_packed(np.asarray(obstacle.world_from_body)[None]))
    return tuple(bodies), tuple(shapes), tuple(poses)


def link_label(record: Record, motion: Motion, link: str) -> str:
    """A link's name as the tables of a record give it: with its robot's name where there are
    several."""
    return f"{motion.placed.robot.name}/{link}" if len(record.motions) > 1 else link


def _packed(poses: np.ndarray) -> np.ndarray:
    """(n, 7) float32 xyz and quat_xyzw, one row where nothing moves."""
    from scipy.spatial.transform import Rotation

    if (poses == poses[0]).all():
        poses = poses[:1]
    rotations = Rotation.from_matrix(poses[:, :3, :3]).as_quat(canonical=True)
    return np.column_stack([poses[:, :3, 3], rotations]).astype(np.float32)


def _shape_index(
    shape: Polyhedron, shapes: list[tuple[np.ndarray, np.ndarray]], seen: dict[bytes, int]
) -> int:
    vertices, triangles = shape.vertices.astype(np.float32), shape.triangles().astype(np.int32)
    key = vertices.tobytes() + triangles.tobytes()
    if key not in seen:
        seen[key] = len(shapes)
        shapes.append((vertices, triangles))
    return seen[key]
