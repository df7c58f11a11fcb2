"""A case as plain numbers for a proof: by the readers of the package and its plain data, not by what measures.

What is taken over is in `NOTES.md`: files as they are read, links and joints, samples at the steps, pairs and
rules. Not for: proving.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import NoReceipt
from clearance.receipt.case_errors import errors_of, is_covered, surfaces_of
from clearance.receipt.proof.joint_paths import arcs_of
from clearance.receipt.proof.motion_data import NONE, Errors, Joints, Shape, Stretch
from clearance.world.case import Case, Omission
from clearance.world.forest import WORLD, forest_of, joined_positions
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import BodyIndex, Pair, bodies_of, selected_pairs
from clearance.world.phase import Phase
from clearance.world.timeline import timeline_of
from clearance.world.timing import time_text


@dataclass(frozen=True, eq=False)
class CaseData:
    """A case as it is proven.

    Attributes:
        names, shapes: of all bodies, links robot by robot, then obstacles.
        rules: names of what can judge a pair, and, where tolerances are covered, of the same with them; then the
            stretches are there once more, with errors. times: (n,) [s] of the steps.
        n_pairs: how many pairs there are in all. unmeasured: what is left out, and why.
    """

    name: str
    shapes: tuple[Shape, ...]
    rules: tuple[str, ...]
    times: np.ndarray
    stretches: tuple[Stretch, ...]
    n_pairs: int
    unmeasured: tuple[Omission, ...]

    @property
    def n_intervals(self) -> int:
        """How many intervals the run has."""
        return max(1, len(self.times) - 1)

    @property
    def has_errors(self) -> bool:
        """True if what tolerances leave is proven too."""
        return any(stretch.errors is not None for stretch in self.stretches)

    @cached_property
    def digest(self) -> str:
        """sha256 of all numbers and names."""
        digest = hashlib.sha256()
        identity = (self.name, self.rules, [shape.name for shape in self.shapes])
        digest.update(repr(identity).encode())
        for array in _arrays(self):
            digest.update(repr((array.shape, array.dtype.str)).encode())
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()


def case_data(case: Case) -> CaseData:
    """The numbers of a case.

    Raises:
        BadInput: a case that no receipt can be written of, and why.
    """
    require_covered(case)
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    bodies = bodies_of(case)
    number = {body: i for i, body in enumerate(bodies)}
    stretches: list[Stretch] = []
    phases: list[Phase] = []
    pairs: set[Pair] = set()
    omitted: dict[Omission, None] = {}
    for phase in timeline.phases:
        selection = selected_pairs(phase)
        omitted |= dict.fromkeys(selection.unmeasured)
        pairs |= set(selection.pairs)
        if selection.pairs:
            rows = np.array([(number[a], number[b]) for a, b in selection.pairs])
            judged = np.array(selection.rules), np.array(selection.paddings)
            stretches.append(_stretch(phase, bodies, rows, *judged))
            _require_one_way(stretches[-1])
            phases.append(phase)
    rules = case.limits.rule_names
    if is_covered(case):
        surfaces = surfaces_of(case, bodies)
        stretches += [
            _with_errors(stretch, errors_of(phase.case, bodies), surfaces, len(rules))
            for stretch, phase in zip(stretches, phases, strict=True)
        ]
        rules = (*rules, *(with_tolerances(rule) for rule in rules))
    return CaseData(
        case.name,
        tuple(_shape(case, body) for body in bodies),
        rules,
        timeline.times,
        tuple(stretches),
        len(pairs),
        tuple(omitted),
    )


def with_tolerances(rule: str) -> str:
    """How what tolerances leave to the pairs of a rule is called."""
    return f"{rule}, with tolerances"


def _with_errors(stretch: Stretch, errors: Errors, surfaces: np.ndarray, n_rules: int) -> Stretch:
    """The same with errors, claimed by rules that count on."""
    padding = stretch.padding + surfaces[stretch.pairs].sum(axis=1)
    return stretch._replace(rules=stretch.rules + n_rules, padding=padding, errors=errors)


def require_covered(case: Case) -> None:
    """Nothing, if receipts can be written of a case.

    Raises:
        BadInput: why they cannot.
    """
    if case.clock.slack != 0.0:
        raise NoReceipt(
            "no receipt for cases whose clocks are not tied", where="clock", valid="clock: common"
        )


def _shape(case: Case, body: BodyIndex) -> Shape:
    shape = body.shape_in(case)
    if body.body_in(case).is_cloud:
        faces = np.arange(len(shape.vertices))[:, None]
    else:
        faces = shape.triangles()
    return Shape(body.name_in(case), shape.vertices, faces, shape.ball_radius)


def _stretch(
    phase: Phase,
    bodies: Sequence[BodyIndex],
    pairs: np.ndarray,
    rules: np.ndarray,
    padding: np.ndarray,
) -> Stretch:
    case, links = phase.case, forest_of(phase.case).links
    rows = np.arange(phase.n_steps) if phase.n_steps > 1 else np.zeros(2, dtype=np.int64)
    positions = joined_positions(case, phase.motions, rows)
    rates, cubic = np.zeros_like(positions), np.zeros(positions.shape[1], dtype=bool)
    start = 0
    for motion in phase.motions:
        columns = slice(start, start + motion.positions.shape[1])
        _require_plain(motion)
        if motion.velocities is not None:
            rates[:, columns], cubic[columns] = motion.velocities[rows], True
        start = columns.stop
    carriers = np.array([body.frame_in(case) for body in bodies])
    poses = np.array(
        [
            case.obstacles[body.i_body].world_from_body if body.is_obstacle else np.eye(4)
            for body in bodies
        ]
    )
    joints = Joints(
        links.parents, links.kinds, links.axes, links.parent_from_joint, links.columns,
        links.factors, links.offsets,
    )  # fmt: skip
    times = phase.times if phase.n_steps > 1 else phase.times[[0, 0]]
    carriers = np.where(carriers == WORLD, NONE, carriers)
    return Stretch(
        phase.first, times, positions, rates, cubic, joints, carriers, poses, pairs, rules, padding
    )


def _require_plain(motion: Motion) -> None:
    """Refuses what a later kind of motion may have: it would go on curves that the proof does not know.

    Raises:
        BadInput: accelerations are given.
    """
    if getattr(motion, "accelerations", None) is not None:
        raise NoReceipt(
            "no receipt for trajectories with accelerations", valid="positions and velocities"
        )


def _require_one_way(stretch: Stretch) -> None:
    """Nothing, if each orientation turns from step to step in one way that can be told.

    Raises:
        BadInput: half a turn between two steps: both ways are equally long.
    """
    try:
        arcs_of(stretch)
    except ValueError as error:
        start = stretch.times[int(error.args[0])]
        raise NoReceipt(
            f"no receipt where something turns by half a turn from one step to the next, at {time_text(start)} s",
            valid="a sample between",
        ) from None


def _arrays(data: CaseData) -> Iterator[np.ndarray]:
    yield data.times
    for shape in data.shapes:
        yield from (shape.points, shape.faces, np.array([shape.radius]))
    for stretch in data.stretches:
        yield np.array([stretch.first])
        for part in stretch:
            if isinstance(part, Joints):
                yield from part
            elif isinstance(part, Errors):
                yield from (*part[:3], *part.of_links, *part.of_bodies)
            elif isinstance(part, np.ndarray):
                yield part
