"""How an obstacle moves: its pose over time. Not for: joints (`trajectory`), and files (room `formats`)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import BadInput, BadPose, BadShape, BadTime, NotFinite
from clearance.tolerance import LARGEST, ROTATION
from clearance.world.field_types import names_in, numbers_of, owned
from clearance.world.slerp import aligned, slerp
from clearance.world.timing import AS_GIVEN, Timing, require_increasing

WORLD_FRAMES = ("world", "map", "odom", "earth")
"""Names of frames that stand, beside those of links. Source: ROS, REP 105."""


@dataclass(frozen=True, eq=False)
class PoseTable:
    """Samples of a pose. Between them a body's origin moves straight, and it turns about one axis at constant
    speed.

    Attributes:
        times: (n,) [s], strictly increasing. positions: (n, 3) [m] of the body's origin, in the world or in what
            it stands on.
        quaternions: (n, 4) xyzw of length one; signs are chosen so that neighbours are nearest.
        timing: when the table is followed. frame: the frame of the poses, where their file names one.
        began: [s] the clock of a recording's messages at its time 0; None for what has no such clock.

    Raises:
        BadShape, NotFinite: not one finite number each. BadTime: times that do not increase, or one sample where
        the
            table is to loop. BadPose: a quaternion that is not of length one within `tolerance.ROTATION`, or a
            place beyond `tolerance.LARGEST`.
    """

    times: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    timing: Timing = AS_GIVEN
    frame: str = ""
    began: float | None = None

    def __post_init__(self) -> None:
        for name, width in (("times", 0), ("positions", 3), ("quaternions", 4)):
            object.__setattr__(self, name, _numbers(getattr(self, name), name, width, len(self)))
        if len(self) < 1:
            raise BadShape("there is no sample", valid="at least one row")
        require_increasing(self.times)
        with np.errstate(over="ignore"):
            lengths = np.linalg.norm(self.quaternions, axis=1)
        off = np.flatnonzero(~(np.abs(lengths - 1.0) <= ROTATION))
        if len(off):
            row = int(off[0])
            raise BadPose(
                f"the quaternion {self.quaternions[row].tolist()} at {self.times[row]:g} s has length "
                f"{lengths[row]:.9g}",
                valid=f"length 1 within {ROTATION:g}, the scalar last",
            )
        if np.abs(self.positions).max() > LARGEST:
            raise BadPose(
                f"a position is {np.abs(self.positions).max():g} m away",
                valid=f"{LARGEST:g} m or less",
            )
        require_samples_to_loop(len(self), self.timing)
        object.__setattr__(self, "quaternions", aligned(self.quaternions / lengths[:, None]))

    def __len__(self) -> int:
        return int(np.size(self.times))

    @property
    def columns(self) -> np.ndarray:
        """(n, 7) positions and quaternions side by side."""
        return np.column_stack([self.positions, self.quaternions])

    def at_places(self, positions: np.ndarray) -> PoseTable:
        """The same turns bit for bit, since what is made of length one twice is not, at places (n, 3) [m]."""
        moved = replace(self, positions=positions)
        object.__setattr__(moved, "quaternions", self.quaternions)
        return moved

    def after(self, step: int, share: float | np.ndarray) -> np.ndarray:
        """(7,) the pose when a share (0 to 1) of the interval after a sample has passed; of the last, its own.

        For shares (k, 1) all poses, (k, 7).
        """
        ends = slice(step, step + 2)
        start, end = self.columns[ends][[0, -1]]
        turned = slerp(start[3:], end[3:], np.asarray(share)[..., 0] if np.ndim(share) else share)
        return np.concatenate([start[:3] + share * (end[:3] - start[:3]), turned], axis=-1)


def require_samples_to_loop(n_samples: int, timing: Timing) -> None:
    """Nothing, if a table can be followed as its timing says.

    Raises:
        BadTime: one sample with `loop`.
    """
    if timing.after == "loop" and n_samples < 2:
        raise BadTime("one sample where `after: loop` is asked", valid="two samples or more")


def _numbers(given: object, name: str, width: int, n_rows: int) -> np.ndarray:
    columns = [str(column) for column in names_in(given)]
    if columns and [column[-1:] for column in columns] != [*"xyzw"[:width]]:
        in_order = f"x, y, z{', w' if width == 4 else ''}, in this order"
        raise BadInput(f"the columns are {', '.join(columns)}", where=name, valid=in_order)
    numbers = np.ascontiguousarray(numbers_of(given, (), name))
    wanted = (n_rows, width) if width else (n_rows,)
    if numbers.shape != wanted:
        raise BadShape(f"shape {numbers.shape} is given", where=name, valid=f"{wanted}")
    if not np.isfinite(numbers).all():
        raise NotFinite("a number is NaN or infinite", where=name, valid="finite numbers")
    return owned(numbers)
