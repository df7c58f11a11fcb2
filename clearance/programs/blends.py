"""Corner zones of a controller that skips a move where two overlap. Not for: what a zone admits (`corner`).

Source: Universal Robots, The URScript programming language (movel: overlapping blends).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadProgram, at
from clearance.programs.arm import Arm
from clearance.programs.joint_way import JointWay
from clearance.programs.legs import Corner, PlannedWay
from clearance.programs.moves import JointMove, PathMove

TOUCH = 1e-9
"""[m] Zones that overlap by less touch: files round them."""


def require_apart(arm: Arm, ways: Sequence[PlannedWay]) -> None:
    """Nothing, if no corner zones at the ends of one move overlap, nor hold its other end.

    Raises:
        BadProgram: they do; with the move.
    """
    before = 0.0
    for move, way, *_ in ways:
        zone = move.zone if isinstance(move, JointMove | PathMove) else 0.0
        if way is not None and before + zone > 0.0:
            ends = np.array([0.0, 1.0])
            poses = (
                arm.poses(way.joints(ends))
                if isinstance(way, JointWay)
                else way.poses(np.column_stack([ends, 0.0 * ends]))
            )
            length = float(np.linalg.norm(poses[1, :3, 3] - poses[0, :3, 3]))
            if before + zone > length + TOUCH:
                with at(move.where):
                    sizes = f"{before * 1e3:.4g} and {zone * 1e3:.4g} mm at the ends of {length * 1e3:.4g} mm"
                    fault = f"blends overlap ({sizes}): the controller skips a move"
                    raise BadProgram(fault, valid="smaller radii r, which do not overlap")
        before = zone


def doubts_on(corner: Corner) -> list[str]:
    """A line on a zone of which a part is left out."""
    move = corner.moves[0]
    if not corner.is_cut or (corner.joints is None and move.zone <= corner.radius + TOUCH):
        return []
    radius = f"a blend of {move.zone * 1e3:.4g} mm"
    text = f"{move.name}: {radius} is taken as half of a move at most"
    return [f"{text}, and the controller cuts the corner farther"]
