"""The result of a search for the least change. Not for: the search (`answer`), how it is told (`sentences`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NoReturn

import numpy as np

from clearance.errors import refuse_truth
from clearance.gains.obstruction import Obstruction
from clearance.gains.request import Request
from clearance.gains.tool_path_error import ToolPathError
from clearance.gains.tool_poses import ToolMove
from clearance.gains.unjudged import unjudged_effects
from clearance.run import Run
from clearance.world.case import Case


@dataclass(frozen=True, eq=False)
class Gain:
    """The result of a search for the least change.

    Attributes:
        request: what was to be changed.
        clearances_kept: every limit of clearance is proven to hold by the margin, in the changed case.
        case: the changed case; the best that was reached where its clearances are not kept.
        change: (3,) [m] of a shift, (4,) with the angle [rad] where a turn is allowed; (n, k) [rad or m] of the
            samples of a path, one such array for each of several robots; (1,) [s] of a delay, or the share
            by which a path takes longer.
        size: of it [m], [rad] or [s]; of a path [rad], where 0.5 m of a slide count as 1 rad; 0 where nothing had
            to be changed. lower_bound: no smaller change of the kind is enough; 0 where nothing is known.
        who: the robot or obstacle that is changed.
        before, after: certified runs of both cases, by their own limits.
        blocked: what stays too near, where clearances are not kept. binding: what the best that was reached is
            up against, a line each.
        n_measured: how many cases were measured.
        tool_moves: how far the tool is moved where it is to stay about where it is.
        tool_path: how far it is off where its path is kept; else None.
        joint_names: of the columns of a path's change. case_file: what the case was read from, if it was.
    """

    request: Request
    clearances_kept: bool
    case: Case
    change: np.ndarray | tuple[np.ndarray, ...]
    size: float
    lower_bound: float
    who: str
    before: Run
    after: Run
    blocked: Obstruction | None
    n_measured: int
    joint_names: tuple[str, ...] = field(default=())
    binding: tuple[str, ...] = field(default=())
    case_file: Path | None = None
    tool_moves: tuple[ToolMove, ...] = ()
    tool_path: ToolPathError | None = None

    def __bool__(self) -> NoReturn:
        refuse_truth(self, "kept")

    def __repr__(self) -> str:
        kept = "kept" if self.kept else "not kept"
        return f"<Gain of {self.case!r}: {self.request.kind} of {self.who}, {kept}, {self.size:.4g} {self.unit}>"

    @cached_property
    def unjudged(self) -> tuple[str, ...]:
        """The effects of the change that no rule sees, a line each."""
        if self.size == 0.0:
            return ()
        return tuple(unjudged_effects(self.before.record, self.after.record))

    @property
    def kept(self) -> bool:
        """True if every clearance is proven to hold by the margin, and a check passes the changed case."""
        return self.clearances_kept and self.after.passed

    @property
    def unit(self) -> str:
        """Of `size` and `lower_bound`."""
        if self.request.slow_down:
            return "share"
        return {"waypoints": "rad", "timing": "s"}.get(self.request.kind, "m")
