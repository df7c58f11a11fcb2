"""The errors of a machine as arguments of kernels, and their rows.

Not for: making rows (`rows`), and the motion of points by them (`reach`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline

TURN, SLIDE, FRAME, TOGETHER = 0.0, 1.0, 2.0, 3.0
"""Kinds of rows."""

ORIGIN, AXIS, KIND, FIRST, OFFSET, CHORD, SLIDE_LENGTH, FIRST_AT_REST = 0, 3, 6, 7, 8, 9, 10, 11
"""Places in a row: a point of the axis or the frame's origin [m]; the unit axis; the kind; the error [rad] or [m]
by itself; the offset of a frame [m]; 2 sin(half of the greatest turn); the greatest slide [m]; the part of the
error without motion. A motion together has its velocity in place of the origin, its spin in place of the axis, and
in place of the last number the share of the motion that a wrong clock causes."""

N_NUMBERS = 12


class Extras(NamedTuple):
    """Further errors of links, from the tip to the base: of the frames of carried parts, and of joints at a moment
    in the past.

    Attributes:
        starts: (n + 1,) of each link or body. origins: (m, 3) [m] in its frame. xyz: (m,) [m]. angle: (m,) [rad].
        axes: (m, 3) unit, in its frame, for a joint, which has either xyz or angle; 0 for a frame, for any axis.
    """

    starts: Integers
    origins: Floats2
    xyz: Floats
    angle: Floats
    axes: Floats2


class Errors(NamedTuple):
    """The sizes of the errors of a case, over the links and bodies of its `World`.

    Attributes:
        joint: (links,) [rad or m] of the joint above each. xyz, angle: (links,) [m], [rad] of the frame of that
            joint, or of the place of a root.
        delay: (links,) [s] the greatest error of the clock of the joint above. owner: (links,) whose clock that
            is, or -1 without such an error.
        of_links, of_bodies: further errors, of links and of standing bodies.
        surface: (bodies,) [m] the greatest excess of the surface of each.
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
    """The rows of each body, and sums over them.

    Attributes:
        rows: (bodies, most rows, N_NUMBERS). n_rows: (bodies,).
        sums: (bodies, N_SUMS) by columns: `OFFSETS` [m] of all frames together; `REST` [m] of second order;
            `REST_AT_REST` [m] its part without motion; `REACH` [m] the greatest motion of any point of the body by
            errors and joints; `TURNED` [rad] its greatest turn; `SURFACE` [m] the greatest excess of its surface;
            `RESIDUAL` [m] the greatest motion of a point without the one motion together, or -1 unless there is
            exactly one.
    """

    rows: Floats3
    n_rows: Integers
    sums: Floats2


OFFSETS, REST, REST_AT_REST, REACH, TURNED, SURFACE, RESIDUAL = range(7)

N_SUMS = 7


@inline
def new_body_rows(n_bodies, most_rows):
    """Empty rows."""
    return BodyRows(
        np.zeros((n_bodies, most_rows, N_NUMBERS)), np.zeros(n_bodies, dtype=np.int64),
        np.zeros((n_bodies, N_SUMS)),
    )  # fmt: skip
