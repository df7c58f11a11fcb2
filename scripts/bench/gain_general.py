"""The same changes by a general optimiser: scipy's SLSQP from 20 starts, on exact clearances and their gradients.

The problem is that of our search: the same variables, the same size (of a path by a variable that no offset
exceeds), the same limits of joints. Clearances are one constraint for each stretch of the run: the least in it,
with the gradient of the pair that has it. Not for: ours (`clearance.gains`).
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from gain_cases import Perturbation, change_of
from gain_files import CaseOnDisk

import clearance as cl
from clearance.gains.offsets import JointOffsets
from clearance.gains.shortfalls import Requirement, State, keeps, measured, proven

STARTS = 20

STRETCHES = 24
"""Of the run; each has one constraint."""

BEYOND = 0.02
"""[m] Above the limit, what counts as near; a stretch that has nothing near is so far above it."""

ENOUGH = 2e-7
"""[m] Below the limit by no more is kept, as for ours."""

PROVEN_WITHIN = 1e-6
"""[m] Below the limit, what is proven of the motion between the samples."""

WIDEST = 2.0
"""[-] Of the size of the known change, how large any variable may be."""


class OutOfTime(Exception):
    """The seconds that it was given are over."""


@dataclass(frozen=True)
class GeneralChange:
    """What the general optimiser came to.

    Attributes:
        size: the least that keeps all at the samples; None if none does. seconds: of CPU.
        starts: searches that came to an end. between: our certificate proves the motion between them as well.
    """

    size: float | None
    seconds: float
    starts: int
    between: bool


@dataclass(frozen=True, eq=False)
class Linear:
    """Rows a (x, t) <= b beside the clearances, and bounds of |x|; t is the size of a path, else absent."""

    a: np.ndarray
    b: np.ndarray


def general_change(one: CaseOnDisk, n_intervals: int, seconds: float) -> GeneralChange:
    """The least size that it finds within so many seconds of CPU.

    Args:
        n_intervals: of the splines of a path, as ours were.
    """
    change = change_of(cl.load_case(one.file), one.kind, one.who, n_intervals)
    began, rng = time.process_time(), np.random.default_rng(0)
    problem = _Problem(change, one.known, began + seconds)
    n_ended = 0
    for i in range(STARTS):
        start = np.zeros(problem.n_variables)
        if i:
            way = rng.normal(size=problem.n_variables)
            start = float(rng.uniform(0.0, one.known)) * way / change.size(way)
        try:
            problem.solve(start)
        except OutOfTime:
            break
        n_ended += 1
    used, best = time.process_time() - began, problem.best
    if best is None:
        return GeneralChange(None, used, n_ended, False)
    between = keeps(proven(change.case_of(best), -PROVEN_WITHIN))
    return GeneralChange(change.size(best), used, n_ended, between)


class _Problem:
    """The programme of one case; the best that was seen of it at any time."""

    def __init__(self, change: Perturbation, known: float, ends: float) -> None:
        self.change, self.ends = change, ends
        self.n_variables = len(change.first_reach)
        self.best: np.ndarray | None = None
        self.widest = WIDEST * known * change.first_reach / change.first_reach.max()
        if isinstance(change, JointOffsets):
            self.widest = WIDEST * known / np.repeat(change.weights, change.n_splines)
        self.is_path = isinstance(change, JointOffsets)
        self.linear = _linear(change, self.widest) if isinstance(change, JointOffsets) else None
        self.state = lru_cache(maxsize=1)(self._state)

    def solve(self, start: np.ndarray) -> None:
        """One search from a start."""
        from scipy.optimize import minimize

        unit = self.is_path
        z = np.append(start, self.change.size(start)) if unit else start
        bounds = [(-far, far) for far in self.widest] + ([(0.0, None)] if unit else [])
        above = {"type": "ineq", "fun": self._clearances, "jac": self._slopes}
        kept = [above]
        if self.linear is not None:
            a, b = self.linear.a, self.linear.b
            kept.append({"type": "ineq", "fun": lambda z: b - a @ z, "jac": lambda _: -a})
        last = np.zeros(len(z))
        last[-1] = 1.0
        aim, slope = (
            (lambda z: z[-1], lambda _: last) if unit else (lambda z: z @ z, lambda z: 2.0 * z)
        )
        minimize(
            aim, z, jac=slope, method="SLSQP", bounds=bounds, constraints=kept,
            options={"maxiter": 100, "ftol": 1e-10},
        )  # fmt: skip

    def _state(self, key: bytes) -> tuple[np.ndarray, np.ndarray]:
        """[m] What each stretch has above the limit, and what it grows by; a point that keeps all is noted."""
        if time.process_time() > self.ends:
            raise OutOfTime
        x = np.frombuffer(key)
        found = measured(
            self.change.case_of(x), x, Requirement(0.0, 0.0, np.zeros(0)), BEYOND + ENOUGH
        )
        if found.worst <= ENOUGH and self._is_less(x) and self._keeps(x):
            self.best = x.copy()
        return _stretches(found, self.change)

    def _is_less(self, x: np.ndarray) -> bool:
        return self.best is None or self.change.size(x) < self.change.size(self.best)

    def _keeps(self, x: np.ndarray) -> bool:
        if not isinstance(self.change, JointOffsets):
            return True
        kept = self.change.kept
        return bool((kept.a @ x - kept.b <= 1e-6).all())

    def _clearances(self, z: np.ndarray) -> np.ndarray:
        return self.state(z[: self.n_variables].tobytes())[0]

    def _slopes(self, z: np.ndarray) -> np.ndarray:
        slopes = self.state(z[: self.n_variables].tobytes())[1]
        return np.hstack([slopes, np.zeros((len(slopes), 1))]) if self.is_path else slopes


def _stretches(state: State, change: Perturbation) -> tuple[np.ndarray, np.ndarray]:
    """(k,) [m] the least above the limit in each stretch of the run, and (k, m) what it grows by."""
    n_steps = len(state.record.motions[0].times)
    above, slopes = np.full(STRETCHES, BEYOND), np.zeros((STRETCHES, len(state.x)))
    for approach in state.near:
        found = change.gradient(approach)
        if found is None:
            continue
        own = -state.missing(approach)
        for row in np.argsort(own)[::-1].tolist():
            k = int(approach.steps[row]) * STRETCHES // n_steps
            if own[row] < above[k]:
                above[k], slopes[k] = own[row], found[row]
    return above, slopes


def _linear(offsets: JointOffsets, widest: np.ndarray) -> Linear:
    """No offset exceeds t, and the limits of joints that can be reached at all."""
    samples = np.kron(np.diag(offsets.weights), offsets.few_samples)
    ones = np.ones((len(samples), 1))
    kept = offsets.kept
    reached = np.flatnonzero(abs(kept.a) @ widest > kept.b)
    limits = kept.a[reached].toarray() if len(reached) else np.zeros((0, len(widest)))
    a = np.vstack(
        [
            np.hstack([samples, -ones]),
            np.hstack([-samples, -ones]),
            np.hstack([limits, np.zeros((len(limits), 1))]),
        ]
    )
    return Linear(a, np.concatenate([np.zeros(2 * len(samples)), kept.b[reached]]))
