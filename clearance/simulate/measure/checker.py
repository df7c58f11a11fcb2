"""How close a robot comes at one configuration: for planners, controllers and tests that ask many times.

What one question finds is cached for the next, so configurations near the last one are answered in 10 to 51 us on
four real robots (AMD EPYC). Not for: motions (`run.check`, which also says what happens between the samples).
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter

import numpy as np

from clearance.errors import BadInput, BadShape, NotFinite, at
from clearance.progress import never_silent
from clearance.record.names import pair_names
from clearance.simulate.measure.asked_pairs import AskedPairs, nearest_of_many
from clearance.simulate.measure.asked_positions import AskedPositions
from clearance.simulate.measure.inside import DoubtfulPairs
from clearance.tolerance import REACH
from clearance.world.case import Case
from clearance.world.field_types import numbers_of
from clearance.world.kinematics import moving_positions
from clearance.world.motion import Motion
from clearance.world.notice import worst_first
from clearance.world.one_time import phase_at, time_dependent_parts
from clearance.world.pairs import Selection, measured_selection, nothing_to_measure, selected_pairs
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausibility import notices_of
from clearance.world.reach import require_within_reach

_BY_CLEARANCE = itemgetter(0, 1)
"""Contact first, then the least clearance, the first of those alike."""

Configuration = np.ndarray | Sequence[float] | Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Clearance:
    """How close a robot comes to its scene at one configuration, and where.

    Attributes:
        distance: [m] the least over all measured pairs, less their padding; 0 less that where a pair touches or
            overlaps, or one is inside the other.
        contact: True where a pair touches, overlaps, or one is inside the other; such a pair comes first.
        link, obstacle: names of the pair that attains it; links carry their robot's name where there are several.
        point_link, point_obstacle: (3,) witness points [m] in the world frame.
        undecided: names of the pairs of which it is open whether one body is inside the other, since a surface has
            holes, if `inside` is accepted; the distance is that of their surfaces alone.
    """

    distance: float
    link: str
    obstacle: str
    point_link: np.ndarray
    point_obstacle: np.ndarray
    undecided: tuple[tuple[str, str], ...] = ()
    contact: bool = False


@dataclass(frozen=True, eq=False)
class ClearanceOfMany:
    """The same at each of n configurations, row by row.

    Attributes:
        distances: (n,) [m]. pairs: (n,) indices into `Checker.pairs`. points: (n, 2, 3) [m] on link and obstacle.
        undecided: (n,) True where it is open of a pair whether one body is inside the other.
        contacts: (n,) True where a pair touches, overlaps, or one is inside the other.
    """

    distances: np.ndarray
    pairs: np.ndarray
    points: np.ndarray
    undecided: np.ndarray
    contacts: np.ndarray


class Checker:
    """The least clearance of a case's robots at any configuration.

    Answers are those of `check` at a step with the same positions, to the last bit, whatever was asked before: the
    nearest pair, padding taken off. Rules of `limits` do not choose the pair, and tolerances are not counted.
    Threads may share a checker, but its questions are answered one at a time; give each thread its own.

    Args:
        case: its trajectories say only which joints a configuration gives, and in which order.
        time: [s] of the case's run, from which windows of time, parts in hands, obstacles that move, and actors
            that come and go are taken; where two phases of the run meet, the later. Without it obstacles that
            move are where their tables begin, parts that are carried lie where they are before, rows of `allow`
            that hold for a time excuse nothing, and nobody is absent: a warning names each.
        accept: kinds of suspect input to accept ("units", "limits", …), with those that the case accepts.

    Attributes:
        joint_names: the joints that a configuration gives, robot by robot: those of the trajectory in its order;
            without one, all moving joints that the case does not fix. They carry their robot's name where there
            are several. The others are where the case has them, or at 0.
        pairs: (link, obstacle) names of what is measured.
        notices: what is suspect about the case, and warnings; `check` would say them with its verdict.

    Raises:
        SuspectInput: suspect input, as in `check`, in the case or in joints that no configuration gives.
        NothingToMeasure: no pair remains. BadDimension: a body far beyond any place that a robot works at.
        BadTime: a time outside the run.

    Warns:
        UserWarning: no time is given, and the case is otherwise at other times of its run; or it has tolerances.
    """

    @never_silent(lambda: "a Checker prepares the bodies of its case")
    def __init__(
        self, case: Case, *, time: float | None = None, accept: Sequence[str] = ()
    ) -> None:
        if not isinstance(case, Case):
            raise BadInput(
                f"a {type(case).__name__} is given", valid="a Case, as `load_case` gives it"
            )
        self._made_of = case, time, tuple(accept)
        self._names = [placed.joints_given for placed in case.robots]
        self.joint_names = tuple(
            case.prefix_of(placed) + name for placed in case.robots for name in placed.joints_given
        )
        self._asked = AskedPositions(case, self._names, accept)
        self.notices = worst_first((*notices_of(case), *self._asked.at_rest()))
        self._asked.require_not_suspect(self.notices)
        case, measured = _measured(case, time)
        self.case, pairs = case, measured.pairs
        require_within_reach(case, [_at_rest(placed) for placed in case.robots])
        self.pairs = list(zip(*pair_names(case, pairs), strict=True))
        self._fixed, self._columns = _placing(case, self._names)
        self._doubtful = DoubtfulPairs(case, pairs)
        self._lock = threading.Lock()
        self._position = self._fixed[None].copy()
        self._alike = []
        for padding in sorted({*measured.paddings}):
            places = np.flatnonzero(np.array(measured.paddings) == padding)
            own = [pairs[i] for i in places]
            self._alike.append(AskedPairs(case, own, places, padding, self._position))

    def __reduce__(self) -> tuple[Callable[[Case], Checker], tuple[Case]]:
        """Another process makes its own, of the same case."""
        case, time, accept = self._made_of
        return partial(Checker, time=time, accept=accept), (case,)

    def __repr__(self) -> str:
        return f"<Checker of {self.case!r}, pairs {len(self.pairs)}>"

    def distance(self, configuration: Configuration) -> Clearance:
        """The least clearance at one configuration and where it is attained.

        Args:
            configuration: (k,) [rad] or [m] as `joint_names`, or a value for each of these names, in any order.

        Raises:
            BadShape, NotFinite, BadInput: not one number within `tolerance.REACH` for each joint.
            SuspectInput: a joint far beyond its limits, or in another unit as it seems; a body that may be inside
                one whose surface has holes; unless that is accepted.

        Warns:
            UserWarning: a joint is slightly beyond its limits; once for each checker. Neighbours, which are not
                measured, are apart at home and meet; once for each pair.

        Exactness, Ties: as `check`, method exact.
        """
        given = self._given(configuration)
        with self._lock:
            self._position[0][self._columns] = given
            found = self._alike[0].at_position()
            for alike in self._alike[1:]:
                found = min(found, alike.at_position(), key=_BY_CLEARANCE)
            undecided = tuple([self.pairs[i] for i, _ in self._doubtful.at(self._position)])
        if undecided:
            self._asked.require_decided(undecided)
        (link, obstacle), (a, b) = self.pairs[found.place], found.points
        return Clearance(found.clearance, link, obstacle, a, b, undecided, not found.is_separate)

    def distances(self, configurations: np.ndarray) -> ClearanceOfMany:
        """The least clearance at each of n configurations, in one compiled call.

        Args:
            configurations: (n, k), or a table whose columns are `joint_names`, in any order.

        Raises:
            BadShape, NotFinite, BadInput, SuspectInput: as `distance`.
        """
        given = self._given(configurations, n_dimensions=2)
        positions = np.tile(self._fixed, (len(given), 1))
        positions[:, self._columns] = given
        with self._lock:
            found = nearest_of_many([alike.at(positions) for alike in self._alike])
            in_doubt = self._doubtful.at(positions)
        undecided = np.zeros(len(positions), dtype=bool)
        undecided[[row for _, row in in_doubt]] = True
        if in_doubt:
            self._asked.require_decided([self.pairs[i] for i, _ in in_doubt])
        return ClearanceOfMany(
            found.clearances, found.places, found.points, undecided, ~found.is_separate
        )

    def _given(self, configuration: Configuration, n_dimensions: int = 1) -> np.ndarray:
        """The configuration, (k,) or (n, k), as the joints are named."""
        given = numbers_of(configuration, self.joint_names, "configuration")
        if given.ndim != n_dimensions or given.shape[-1] != len(self.joint_names):
            raise BadShape(
                f"the shape is {given.shape}",
                where="configuration",
                valid=self._wanted(n_dimensions),
            )
        if not self._asked.are_usual(given):
            if not (np.abs(given) <= REACH).all():
                raise NotFinite(
                    "a joint position is NaN or beyond any reach",
                    where="configuration",
                    valid=f"{REACH:g} or less",
                )
            with at("configuration"):
                self._asked.judge(np.atleast_2d(given))
        return given

    def _wanted(self, n_dimensions: int) -> str:
        rows = "n rows of " if n_dimensions == 2 else ""
        return f"{rows}one number for each of {', '.join(self.joint_names)}"


def _measured(case: Case, time: float | None) -> tuple[Case, Selection]:
    """The case at a time [s] of its run, and its pairs; warnings say what is left out."""
    if case.tolerance is not None:
        text = (
            "this Checker counts no tolerances: clearances are nominal; `check` proves what remains"
        )
        warnings.warn(text, stacklevel=4)
    if time is not None:
        phase = phase_at(case, time)
        measured = selected_pairs(phase)
        if not measured.pairs:
            raise nothing_to_measure()
        return phase.case, measured
    if text := "; ".join(time_dependent_parts(case)):
        warnings.warn(
            f"this Checker knows no time: {text}; give time=, [s] of the run", stacklevel=4
        )
    return case, measured_selection(case)


def _placing(case: Case, names: Sequence[tuple[str, ...]]) -> tuple[np.ndarray, np.ndarray]:
    """(columns,) where all is that no configuration gives, and the columns that one does."""
    fixed, columns, n_before = [], [], 0
    for placed, given in zip(case.robots, names, strict=True):
        row = moving_positions(placed, given, np.zeros((1, len(given))))[0]
        place = {joint.name: i for i, joint in enumerate(placed.robot.moving_joints)}
        columns += [n_before + place[name] for name in given]
        fixed.append(row)
        n_before += len(row)
    fixed += [o.moves.columns[0] for o in case.obstacles if o.moves is not None]
    return np.concatenate(fixed), np.array(columns, dtype=np.int64)


def _at_rest(placed: PlacedRobot) -> Motion:
    n_joints = len(placed.robot.moving_joints)
    return Motion(
        replace(placed, trajectory=None), np.zeros(1), np.zeros((1, n_joints)), np.zeros(1)
    )
