"""The branches of ruler-and-compass steps: every closed step with two possible points has another.

Tried where the sketch's own branch does not do: to satisfy a `same_side`, and to prove that a small
construction has no place at all. Not for: numeric clusters (`roots`).
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from clearance.sketch.equations import Across, FromLine, Lengths, Linear, MiddleOn, are
from clearance.sketch.execution import WRONG_SIDE, ExecutionResult, at_unit, run
from clearance.sketch.graph.graph import IN_GRAPH, POINT, TURN
from clearance.sketch.mobility import Equations, dependent
from clearance.sketch.problem import DEPENDENT, RESIDUAL, Problem, replanned
from clearance.sketch.roots import other_solutions
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.execute import FAILED, Run, execute
from clearance.sketch.solve.search import RESTARTS, solve_cluster
from clearance.sketch.start import Sides, sides_hold, started

MOST = 10
"""Choices up to which all their combinations are tried: 1024 runs of a plan."""

TRIED = 40_000
"""Steps of a plan, over all branches, up to which a closed circuit's branches are tried: a tenth of a second."""

EXCHANGED = 400
"""Equations of a circuit up to which those are found that its others imply: a hundredth of a second."""

STRAIGHT = (Linear, FromLine, MiddleOn, Across)
"""Equations that keep a point on a straight line: two of them meet in one point."""


def choices(problem: Problem) -> list[int]:
    """The closed steps (indices) that choose one of two places."""
    s, out = problem.system.plain, []
    for k, step in enumerate(problem.plan.steps):
        if step.numeric or len(step.rows) != 2:
            continue
        equations = [s.equations[row] for row in step.rows]
        point = s.kind[step.vertex] == POINT and step.partner < 0
        if point and not all(isinstance(e, STRAIGHT) for e in equations):
            out.append(k)
        elif s.kind[step.vertex] == TURN and not any(isinstance(e, Across) for e in equations):
            out.append(k)
    return out


def run_with_sides(
    problem: Problem, before: np.ndarray, sides: Sides, effort: int = 2
) -> ExecutionResult:
    """The outcome of a problem; where a `same_side` does not hold, the nearest one in which all do.

    The same where an equation does not hold that others imply by the count; see `_with_circuits`.
    """
    outcome = run(problem, before, sides, effort)
    if effort:
        outcome = _with_circuits(outcome, before, sides, effort)
    problem = outcome.problem
    if outcome.broken != WRONG_SIDE or effort == 0:
        return outcome
    found = [o for o in _turned(problem, before, sides, outcome) if o.broken == -1]
    if not found:
        found = _by_roots(problem, sides, outcome)
    return min(found, key=lambda o: float(np.linalg.norm(o.x - before)), default=outcome)


def _with_circuits(
    outcome: ExecutionResult, before: np.ndarray, sides: Sides, effort: int
) -> ExecutionResult:
    """The outcome; where an equation does not hold that others imply by the count, that of the branch on which it
    does, or that of a plan without an equation that is implied indeed."""
    for _ in range(outcome.problem.plan.dependent.size):
        problem, broken = outcome.problem, outcome.broken
        if broken not in problem.plan.dependent:
            break
        turned = _closing(problem, before, sides, _circuit_choices(problem, broken))
        if turned:
            return run(problem, before, sides, effort, turned)
        other = _otherwise_planned(outcome, before)
        found = None if other is None else run(other, before, sides, effort)
        if found is None or not (found.broken < 0 or found.broken in found.problem.plan.dependent):
            break
        outcome = found
    return outcome


def _otherwise_planned(outcome: ExecutionResult, before: np.ndarray) -> Problem | None:
    """The problem planned without those equations of a circuit that its others imply.

    The count takes the circuit's last equation for implied. A theorem may imply another one instead, as parallel
    sides imply equal lengths. Without the last one the outcome has a freedom then, and may have collapsed. So the
    derivatives are those at the end of a descent on all equations, if it finds a place. None where no other
    equation is implied, and where the count does not allow the exchange.
    """
    problem, x = at_unit(outcome.problem, outcome.x)
    plan, broken = problem.plan, outcome.broken
    rows = np.array(sorted(plan.circuits[plan.dependent.tolist().index(broken)][:-1]))
    if rows.size > EXCHANGED:
        return None
    part = int(problem.row_part[broken])
    whole = np.flatnonzero((problem.row_part == part) & (problem.fate == IN_GRAPH))
    columns = Columns(problem.system, problem.vertices_of(part), whole)
    drawn = started(*at_unit(outcome.problem, before), ())[0]
    found = solve_cluster(columns, drawn, problem.rule(1))
    x = x if found is None else found
    circuit = Equations(problem, part, rows, x, problem.system)
    implied = rows[dependent(circuit.at(x)[1])].tolist()
    if not implied:
        return None
    last = frozenset([*implied, *plan.dependent.tolist()]) - {broken}
    other = replanned(outcome.problem, last)
    return None if broken in other.plan.dependent else other


def _circuit_choices(problem: Problem, row: int) -> list[int]:
    """The choices that place what the circuit around an implied equation names; none where it has too many."""
    plan, ends = problem.plan, problem.system.ends
    inside = {
        int(v) for k in np.flatnonzero(plan.dependent == row) for v in ends[plan.circuits[k]].flat
    }
    steps = [k for k in choices(problem) if plan.steps[k].vertex in inside]
    return steps if len(plan.steps) * 2 ** len(steps) <= TRIED else []


def _turned(problem: Problem, before: np.ndarray, sides: Sides, outcome):
    """Outcomes with steps turned, the fewest first; those before a side's points, its points first."""
    steps = _nearest_choices(problem, sides)
    for count in range(1, len(steps) + 1):
        best = []
        for chosen in combinations(steps, count):
            problem.limit.require_time()
            best.append(run(problem, before, sides, turned=frozenset(chosen)))
        yield from best
        if any(o.broken == -1 for o in best):
            return


def _nearest_choices(problem: Problem, sides: Sides) -> list[int]:
    """Up to `MOST` choices in the parts of the sides: the steps of their points and lines, then the last."""
    s = problem.system
    concerned = {int(s.vertex_of[problem.alias[i]]) for side in sides for i in side}
    parts = {int(problem.part[v]) for v in concerned if v > 0}
    placed = {k: problem.plan.steps[k].vertex for k in choices(problem)}
    steps = [k for k, v in placed.items() if int(problem.part[v]) in parts]
    own = [k for k in steps if placed[k] in concerned]
    return (own + [k for k in reversed(steps) if k not in own])[:MOST]


def _by_roots(problem: Problem, sides: Sides, outcome) -> list:
    """Outcomes at other roots of the small numeric clusters."""
    return [
        ExecutionResult(problem, x, outcome.fates, -1, residual)
        for x, residual in other_solutions(problem, outcome.x)
        if sides_hold(x, sides, problem.size)
    ]


def exhausted(problem: Problem, before: np.ndarray, sides: Sides) -> bool:
    """Whether the problem is a ruler-and-compass construction of which no branch is a solution.

    False when that cannot be decided: freedom remains, a cluster is numeric, or there are too many branches.
    """
    steps, kind = choices(problem), problem.system.kind
    undecided = any(
        step.numeric or (kind[step.vertex] == POINT and step.partner >= 0)
        for step in problem.plan.steps
    )
    if undecided or len(steps) > MOST or (are(problem.system.code, Lengths)).any():
        return False
    return bool(problem.is_rigid.all()) and _closing(problem, before, sides, steps) is None


def _closing(
    problem: Problem, before: np.ndarray, sides: Sides, steps: list[int]
) -> frozenset[int] | None:
    """The fewest steps to turn for a branch on which all holds; None where there is none."""
    start, _ = started(problem, before, ())
    allowed = DEPENDENT if problem.plan.dependent.size else RESIDUAL
    for mask in sorted(range(2 ** len(steps)), key=int.bit_count):
        problem.limit.require_time()
        turned = frozenset(k for bit, k in enumerate(steps) if mask >> bit & 1)
        x = start.copy()
        chosen = Run(start, problem.rule(RESTARTS), turned)
        fates = execute(problem.system, problem.plan, x, chosen)
        if (fates == FAILED).any():
            continue
        x = x[problem.alias]
        holds = problem.residual(x)[0] <= allowed * problem.size
        if holds and sides_hold(x, sides, problem.size):
            return turned
    return None
