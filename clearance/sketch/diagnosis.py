"""Conflicts: a minimal set of constraints that cannot hold together, and the proof of it.

The first suspects are a chain of distances too short for another, then the circuit that the graph (or the
merging of directions) closes around the broken equation; otherwise the broken part as a whole. The set
is thinned by trials. A conflict is proved by the sum of a chain, by contradicting directions or radii, by
the count of freedoms, or by trying every branch of a ruler-and-compass construction; without a proof the
verdict is only that nothing was found.
"""

from __future__ import annotations

import heapq
from functools import cached_property

import numpy as np

from clearance.sketch.branches import exhausted
from clearance.sketch.effort import OutOfTime
from clearance.sketch.equations import FromCircle, Linear, PointPoint, are, places
from clearance.sketch.execution import REVERSED
from clearance.sketch.graph.graph import CONTRADICTED, MERGED
from clearance.sketch.problem import DEPENDENT, RESIDUAL, Problem
from clearance.sketch.repairs import Repair, repairs_of
from clearance.sketch.solve.execute import FAILED, TOO_LARGE
from clearance.sketch.solve.search import BANDED
from clearance.sketch.trials import Trials

CHAIN = "one distance is longer than the others together"
LINEAR = "their directions, offsets or radii contradict each other"
COUNT = "they take more freedom than there is, and do not agree"
BRANCHES = "every branch of their construction was tried"


class Diagnosis:
    """A minimal conflict; its repairs, the least first, are computed on demand.

    `proof` says why it is one; empty when a search only failed. `searched` are the constraints of the
    clusters in which it failed.
    """

    def __init__(
        self, trial: Trials, conflict: list[int], proof: str, searched: list[int] | None = None
    ) -> None:
        self._trial = trial
        self._conflict = conflict
        self.proof = proof
        self.names = [trial.sketch._lists.constraints[i].name for i in conflict]
        self.searched = [trial.sketch._lists.constraints[i].name for i in searched or conflict]

    @property
    def kept_side(self) -> str:
        """The side on which two circles of the conflict touch, where the drawing has said it; else empty."""
        tables, ordered = self._trial.tables, self._trial.sketch._lists.constraints
        for row in np.flatnonzero(np.isin(tables.owner, self._conflict)).tolist():
            one = ordered[tables.owner[row]]
            if one.kind != "tangent" or one.options or not are(tables.code[row], FromCircle):
                continue
            k, m = (e.name for e in one.entities)
            inside = bool(tables.coef[row, 0] != tables.coef[row, 1])
            side = (
                f"one of {k} and {m} inside the other"
                if inside
                else f"{k} and {m} outside each other"
            )
            return f"{one.name} keeps {side}, as drawn; inside={not inside} asks for the other side"
        return ""

    @cached_property
    def repairs(self) -> list[Repair]:
        """See `Repair`; none where there is no time for all."""
        self._trial.limit = self._trial.problem.limit.again()
        try:
            with self._trial.limit:
                return repairs_of(self._trial, self._conflict)
        except OutOfTime:
            return []


def diagnose(sketch, problem: Problem, before: np.ndarray, outcome) -> Diagnosis:
    """Why a problem has no solution; the sketch is not changed. It may take as long as the solve."""
    trial = Trials(sketch, problem, before, outcome.x)
    trial.limit = problem.limit.again()
    if outcome.stopped:
        return Diagnosis(trial, [], "", not_holding(problem, outcome.best))
    if outcome.broken == REVERSED:
        return Diagnosis(trial, [], "", sketch._lists.reversed_angles(before, outcome.x))
    try:
        with trial.limit:
            return _diagnosed(trial, problem, outcome)
    except OutOfTime:
        return Diagnosis(trial, [], "", trial.everything(outcome.broken))


def not_holding(problem: Problem, x: np.ndarray) -> list[int]:
    """The constraints of which an equation does not hold."""
    rows = problem.errors(x) > RESIDUAL * problem.size
    return sorted({int(o) for o in problem.tables.owner[rows]})


def _diagnosed(trial: Trials, problem: Problem, outcome) -> Diagnosis:
    for row in _first_broken(problem, outcome):
        chain = _too_short(problem, row)
        if chain and (_is_polygon(problem, chain) or trial.is_minimal(chain)):
            return Diagnosis(trial, chain, CHAIN)
    suspects = _suspects(problem, outcome.broken) if _rest_holds(problem, outcome.x) else None
    if suspects is None:
        searched = _large_failures(problem, outcome.fates)
        if searched:
            return Diagnosis(trial, [], "", searched)
    elif not trial.solvable(suspects):
        return Diagnosis(trial, trial.thinned(suspects), COUNT)
    return _thinned(trial, suspects, outcome.broken)


def _rest_holds(problem: Problem, x: np.ndarray) -> bool:
    """Whether all equations hold that no others imply by the count."""
    error = problem.errors(x)
    error[problem.plan.dependent] = 0.0
    return bool((error <= DEPENDENT * problem.size).all())


def _thinned(trial: Trials, suspects: list[int] | None, broken: int) -> Diagnosis:
    conflict: list[int] = []
    for effort in (0, 1):  # quick trials first; their answer counts only when full ones confirm it
        trial.effort = effort
        chosen = suspects
        if chosen is None or trial.solvable(chosen):
            chosen = trial.everything(broken)
        if trial.solvable(chosen):
            continue
        conflict = trial.minimal(chosen)
        trial.effort = 1
        if trial.is_minimal(conflict):
            break
    trial.effort = 1
    proof = _proof(trial, conflict) if conflict else ""
    return Diagnosis(trial, conflict, proof, conflict or trial.everything(broken))


def _proof(trial: Trials, conflict: list[int]) -> str:
    """Why these constraints cannot hold together; empty without a proof."""
    part = trial.part(conflict)
    if (part.fate == CONTRADICTED).any():
        return LINEAR
    sides = trial.sketch.sides(set(conflict))
    if part.plan.dependent.size:
        outcome = trial.run(conflict)
        implied = outcome.broken in outcome.problem.plan.dependent
        return COUNT if implied and _rest_holds(outcome.problem, outcome.x) else ""
    return BRANCHES if exhausted(part, trial.before, sides) else ""


def _first_broken(problem: Problem, outcome) -> list[int]:
    """The worst equation, and those of the first closed step that found no place."""
    fates = zip(problem.plan.steps, outcome.fates.tolist(), strict=True)
    failed = (step.rows for step, fate in fates if fate == FAILED and not step.numeric)
    rows = next(failed, ())
    return [r for r in (*rows, outcome.broken) if r >= 0]


def _large_failures(problem: Problem, fates: np.ndarray) -> list[int]:
    """The constraints of the large clusters whose search failed: too large to be thinned by trials."""
    out: set[int] = set()
    for step, fate in zip(problem.plan.steps, fates.tolist(), strict=True):
        if fate in (FAILED, TOO_LARGE) and step.numeric and len(step.rows) >= BANDED:
            out |= {int(o) for o in problem.tables.owner[list(step.rows)]}
    return sorted(out)


def _suspects(problem: Problem, broken: int) -> list[int] | None:
    """The constraints (by index) of the circuit around a broken equation, if there is one."""
    owner, plan, var = problem.tables.owner, problem.plan, problem.system.var
    for k in np.flatnonzero(plan.dependent == broken):
        rows = plan.circuits[k]
        touched = np.unique(var[rows][var[rows] >= 0])
        merged = np.flatnonzero(problem.fate == MERGED)
        near = merged[np.isin(var[merged], touched).any(axis=1)]
        joined = problem.tables.together
        first = places(Linear, var[problem.tables.first_rows(joined)]).a
        together = set(np.array(joined)[np.isin(first, touched)].tolist())
        return sorted({int(o) for o in owner[rows]} | {int(o) for o in owner[near]} | together)
    return None


def _too_short(problem: Problem, broken: int) -> list[int]:
    """A distance and a chain of other distances that cannot span it, if there is one (else empty).

    The shortest chain between the broken distance's ends, by Dijkstra's method.
    """
    tables, ends = problem.tables, places(PointPoint, problem.system.var)
    if not are(tables.code[broken], PointPoint):
        return []
    value = tables.value
    rows = np.flatnonzero(
        are(tables.code, PointPoint) & (problem.row_part == problem.row_part[broken])
    )
    near: dict[int, list[tuple[int, float, int]]] = {}
    for row in rows:
        a, b = int(ends.px[row]), int(ends.qx[row])
        near.setdefault(a, []).append((b, float(value[row]), int(row)))
        near.setdefault(b, []).append((a, float(value[row]), int(row)))
    for longest in (broken, *_heaviest(near, broken, ends)):
        chain = _spanned(near, longest, int(ends.px[longest]), int(ends.qx[longest]))
        if chain and sum(value[r] for r in chain) < value[longest]:
            return sorted({int(o) for o in tables.owner[[longest, *chain]]})
    return []


def _is_polygon(problem: Problem, chosen: list[int]) -> bool:
    """Whether constraints are the sides of a polygon, one clearly longer than the others together: without any one
    of them the others are an open chain, which lies anywhere."""
    tables = problem.tables
    rows = np.isin(tables.owner, chosen)
    if not are(tables.code[rows], PointPoint).all():
        return False
    ends, sides = places(PointPoint, tables.var[rows]), tables.value[rows]
    over = 2.0 * sides.max() - sides.sum()
    twice = (np.unique([ends.px, ends.qx], return_counts=True)[1] == 2).all()
    return bool(twice and over > DEPENDENT * problem.size)


def _heaviest(near: dict, broken: int, ends: PointPoint) -> list[int]:
    """The other distances at the broken one's ends, the longest first: one of them may be too long."""
    at = [e for end in (int(ends.px[broken]), int(ends.qx[broken])) for e in near[end]]
    return [row for _, _, row in sorted(at, key=lambda e: -e[1]) if row != broken][:4]


def _spanned(near: dict, without: int, start: int, goal: int) -> list[int]:
    """The equations of the shortest chain from start to goal that does not use one of them."""
    came, waiting, done = {}, [(0.0, start, -1, -1)], set()
    while waiting:
        length, at, before, row = heapq.heappop(waiting)
        if at in done:
            continue
        done.add(at)
        came[at] = (before, row)
        if at == goal:
            break
        for other, step, by in near.get(at, []):
            if by != without:
                heapq.heappush(waiting, (length + step, other, at, by))
    chain = []
    while goal != start and goal in came:
        goal, row = came[goal]
        chain.append(row)
    return chain if goal == start else []


__all__ = ["BRANCHES", "CHAIN", "COUNT", "LINEAR", "Diagnosis", "Repair", "diagnose"]
