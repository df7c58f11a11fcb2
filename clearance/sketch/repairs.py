"""Repairs of a conflict: which dimensions to change, to what, so that all constraints can hold.

One dimension at a time is dropped, everything else solved, and the dimension measured; or all dimensions
of the conflict share the change by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.sketch.constraints import measured
from clearance.sketch.equations import Rows
from clearance.sketch.problem import DEPENDENT, Tables, joined, problem_of
from clearance.sketch.solver import is_degenerate
from clearance.sketch.trials import Trials

SHARED = 300
"""Equations up to which a change shared by all dimensions is computed (a dense least-squares problem)."""

FIRM = 1e3
"""[-] Weight of the equations that may not give way against those of the conflict's dimensions."""


@dataclass(frozen=True)
class Repair:
    """Dimensions to change so that the conflict can be solved.

    Attributes:
        changes: new value by constraint name, in the constraint's own unit ([m], [rad] or [-]).
        size: root of the summed squares of the changes, angles as arcs at the sketch's size.
    """

    changes: dict[str, float]
    size: float


def repairs_of(trial: Trials, conflict: list[int]) -> list[Repair]:
    """One dimension changed at a time, and all together; the least change first."""
    ordered, size = trial.sketch._lists.constraints, trial.problem.size
    dimensions = [i for i in conflict if ordered[i].given is not None]
    whole = [int(k) for k in np.unique(trial.tables.owner)]
    tried = []
    for i in dimensions:
        outcome = trial.run([k for k in whole if k != i])
        if outcome.broken != -1:  # there are more conflicts than this one
            outcome = trial.run([k for k in conflict if k != i])
        if outcome.broken == -1:
            tried.append((outcome.x, {i: measured(ordered[i], outcome.x.tolist())}))
    shared = _shared(trial, conflict, dimensions)
    if shared is not None and len(dimensions) > 1:
        tried.append(shared)
    found = [_repair(ordered, size, n) for x, n in tried if _holds(trial, conflict, n, x)]
    return sorted(found, key=lambda r: (r.size, len(r.changes)))


def _holds(trial: Trials, conflict: list[int], numbers: dict[int, float], x: np.ndarray) -> bool:
    """Whether the conflict with other numbers holds at x (n,), where every line and circle has an extent.

    A dimension has no sign. So it may not say what was measured: a radius below 0, a point on a line's other side.
    """
    changed = trial.tables.numbers.copy()
    changed[list(numbers)] = list(numbers.values())
    problem = problem_of(replace(trial.tables, numbers=changed), x, trial.problem)
    off = problem.errors(x)[np.isin(trial.tables.owner, conflict)].max(initial=0.0)
    return bool(off <= DEPENDENT * problem.size) and not is_degenerate(problem, x)


def _repair(ordered, size: float, numbers: dict[int, float]) -> Repair:
    scale = {i: size if ordered[i].kind == "angle" else 1.0 for i in numbers}
    total = sum((scale[i] * (v - ordered[i].number)) ** 2 for i, v in numbers.items())
    return Repair({ordered[i].name: float(v) for i, v in numbers.items()}, float(np.sqrt(total)))


def _shared(
    trial: Trials, conflict: list[int], dimensions: list[int]
) -> tuple[np.ndarray, dict[int, float]] | None:
    """The place (n,) and numbers of the least change of all dimensions at once; None if not found."""
    from scipy.optimize import least_squares

    tables = _smallest(trial, conflict)
    if tables is None:
        return None
    soft = np.isin(tables.owner, dimensions) & (tables.scale != 0.0)
    free = np.unique(tables.var[tables.var >= 0])
    weight = np.where(soft, 1.0, FIRM)
    alias = joined(tables).alias
    var = np.where(tables.var >= 0, alias[tables.var], -1)
    rows = Rows(tables.code, var, tables.coef, tables.value)

    def violation(numbers: np.ndarray) -> np.ndarray:
        x = trial.before.copy()
        x[free] = numbers
        trial.limit.require_time()
        return weight * rows.errors(x[alias])

    fitted = least_squares(
        violation, trial.before[free], xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=300
    )
    x = trial.before.copy()
    x[free] = fitted.x
    exact = trial.run_from(x[alias], [k for k in np.unique(tables.owner) if k not in dimensions])
    if exact.broken != -1:
        return None
    ordered, numbers = trial.sketch._lists.constraints, exact.x.tolist()
    return exact.x, {i: measured(ordered[i], numbers) for i in dimensions}


def _smallest(trial: Trials, conflict: list[int]) -> Tables | None:
    """The tables of the whole sketch, of the conflict alone, or None, by their number of equations."""
    for tables in (trial.tables, trial.tables.only(trial.marks(conflict))):
        if 0 < tables.code.size <= SHARED:
            return tables
    return None
