"""The errors of a machine as kernels take them, and the rows that they become.

Not for: making rows (`rows`), and what they do to points (`reach`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline

TURN, SLIDE, FRAME, TOGETHER = 0.0, 1.0, 2.0, 3.0
"""Kinds of rows."""

ORIGIN, AXIS, KIND, FIRST, OFFSET, CHORD, WAY, FIRST_AT_REST = 0, 3, 6, 7, 8, 9, 10, 11
"""Places in a row: a point of the axis or the frame's origin [m]; the unit axis; the kind; the error [rad] or [m]
by itself; the offset of a frame [m]; 2 sin(half of all that it can turn); [m] all that it can slide; what of the
error is there without motion. Of a motion together: its velocity in place of the origin, its spin in place of the
axis, and in place of the error the share of it that is there since a clock may be off."""

N_NUMBERS = 12


class Extras(NamedTuple):
    """Errors of what links hang on beside those of their joints, from the tip to the base: of frames of what is
    carried by something that is carried, and of joints at a moment that has passed.

    Attributes:
        starts: (n + 1,) of each. origins: (m, 3) [m] in the frame of what hangs there. xyz: (m,) [m]. angle: (m,)
            [rad]. axes: (m, 3) unit, in that frame, of a joint, whose other size is 0; 0 of a frame, for any axis.
    """

    starts: Integers
    origins: Floats2
    xyz: Floats
    angle: Floats
    axes: Floats2


class Errors(NamedTuple):
    """How large the errors of a case are, over the links and bodies of its `World`.

    Attributes:
        joint: (links,) [rad or m] of the joint above each. xyz, angle: (links,) [m], [rad] of the frame that it
            hangs on, or of where a root stands.
        delay: (links,) [s] how far the clock of the joint above may be off. owner: (links,) whose clock that is,
            or -1 where it is not off.
        of_links, of_bodies: further frames, of links and of bodies that stand.
        surface: (bodies,) [m] how far the surface of each may stand out.
        most_rows: of any body.
    """

    joint: Floats
    xyz: Floats
    angle: Floats
    delay: Floats
    owner: Integers
    of_links: Extras
    of_bodies: Extras
    surface: Floats
    most_rows: int


class BodyRows(NamedTuple):
    """The rows of each body, and what is summed up of them.

    Attributes:
        rows: (bodies, most rows, N_NUMBERS). n_rows: (bodies,).
        sums: (bodies, N_SUMS) [m] offsets of all frames together; the second-order rest; what of it errors make
            without motion; how far the errors and the motion can move any point of the body; [rad] how far they
            can turn it; [m] how far the surface may stand out; how far any point can get from where the velocity
            of one motion together puts it, or -1 where there is none, or more than one.
    """

    rows: Floats3
    n_rows: Integers
    sums: Floats2


OFFSETS, REST, REST_AT_REST, REACH, TURNED, SURFACE, BESIDE = range(7)

N_SUMS = 7


class JointMotion(NamedTuple):
    """What joints do beside their errors, over half an interval of time and what clocks may be off.

    Attributes:
        swing, bend: (links,) as in `IntervalMiddle`. turned: (links,) [rad] further turns about any axis.
        half: [s] half of the interval.
    """

    swing: np.ndarray
    bend: np.ndarray
    turned: np.ndarray
    half: float


@inline
def new_body_rows(n_bodies, most_rows):
    """Rows of no errors."""
    return BodyRows(
        np.zeros((n_bodies, most_rows, N_NUMBERS)), np.zeros(n_bodies, dtype=np.int64),
        np.zeros((n_bodies, N_SUMS)),
    )  # fmt: skip
