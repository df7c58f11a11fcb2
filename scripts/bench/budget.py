"""Prints what tolerances cost and how tight their proof is, over the scenes, with the figures of a typical cell.

    python scripts/bench/budget.py [--scenes NAME ...] [--budgets N] [--random N] [--starts N] [--csv FILE]

For each section of a scene, at the step at which least is proven: the least found by errors at random, and by
errors that are made as bad as found, on distances measured anew; none may be below the proof. Beside it the
expected standard deviation over that of distances measured anew, and CPU time over that without tolerances, of the
steps alone and certified. `--budgets` further tolerances are drawn at random.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from budget_samples import (
    Apart,
    Errors,
    Key,
    Machine,
    Size,
    body_name,
    random_errors,
    scaled,
    sizes_of,
    slopes,
    surfaces_of,
    typical,
)
from harness import SCENES, SHARED, Row, least_time

import clearance as cl
from clearance.budget.errors_of import surface_of
from clearance.budget.expected import deviations, witness_of
from clearance.budget.proven import PairsWithErrors, proven_between, proven_of_steps
from clearance.record.measurement import Measurement
from clearance.run.answers import measurement_plan
from clearance.run.question import Question
from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.sections import Section
from clearance.tolerance import CERTIFY_GAP
from clearance.world.budget import Budget
from clearance.world.case import Case
from clearance.world.pairs import Pair

NAMES = ("box_box", "box_pipe", "hot_cell", "iiwa_pipe_rack", "panda_shelf", "turntable_cell")

NEAREST = 3
"""Pairs that are sampled beside the one that decides, a tenth as often: the nearest."""

ROUNDS = 5
"""How often all errors are turned against the distance at once; then one after another."""

MOST, DECADES = 6.0, 1.5
"""The greatest random tolerances are up to so many times those of a typical cell, down by so many decades."""

ROUNDING = 1e-12
"""[m] By which a measured distance may be off."""

SMALLEST = ["--scenes", "box_box", "--budgets", "1", "--random", "50", "--starts", "10"]


@dataclass(frozen=True, eq=False)
class Loaded:
    """A section of a case, what was measured of it, and its pairs, whose arrays are kept."""

    name: str
    section: Section
    found: Measurement
    apart: Apart


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__, words, scenes=[*NAMES], budgets=0, random=10_000, starts=1000
    )
    rows: list[Row] = []
    for one in (one for name in asked.scenes for one in sections_of(name)):
        case = one.section.phase.case
        for i in range(asked.budgets + 1):
            rng = np.random.default_rng(i)
            factor = MOST * 10.0 ** (-DECADES * rng.random())
            budget = typical(case)
            if i:
                budget = scaled(budget, lambda most, f=factor, rng=rng: f * most * rng.random())
            row = row_of(one, budget, rng, asked.random, asked.starts)
            if row is not None:
                rows.append(
                    {"scene": one.name, "budget": i, **row, **({} if i else cost_of(one, budget))}
                )
        harness.write_csv(rows, asked.csv)
    harness.show("tolerances", rows)
    return rows


def sections_of(name: str) -> Iterator[Loaded]:
    """The sections of a scene, or shared case, that have a clearance at all."""
    place = SCENES if (SCENES / name).is_dir() else SHARED
    case = cl.load_case(place / name / "case.yaml")
    case = replace(case, tolerance=typical(case))
    for section in measurement_plan(Question(case)).sections.sections:
        found = measure(section.in_motion)
        if section.tied and np.nanmax(found.clearance) > 0.0:
            yield Loaded(name, section, found, Apart())


def row_of(
    of: Loaded, budget: Budget, rng: np.random.Generator, n: int, n_starts: int
) -> Row | None:
    """How tight the proof of a budget is; None where bodies touch without errors.

    Raises:
        SystemExit: a sample is below what is proven.
    """
    rows = proven_of_steps(PairsWithErrors(of.section.in_motion, budget), of.found)
    apart = (of.found.clearance > 0.0) & (rows.pair >= 0)
    if not apart.any():
        return None
    step = int(np.argmin(np.where(apart, rows.proven, np.inf)))
    moment = Moment(
        of, replace(of.section.phase.case, tolerance=budget), step, int(rows.pair[step])
    )
    nominal, proven = moment.nominal(), float(rows.proven[step])
    worst = min(moment.at_random(n, rng), moment.as_bad_as_found(n_starts, rng))
    names = " - ".join(body_name(moment.case, body) for body in moment.pairs[0])
    if worst < proven - ROUNDING:
        raise SystemExit(
            f"below what is proven: {of.name}, {names}, step {step}: {worst} < {proven}"
        )
    return {
        "pair": names, "nominal_mm": 1e3 * nominal, "proven_mm": 1e3 * proven, "worst_mm": 1e3 * worst,
        "tightness": (nominal - proven) / (nominal - worst), "deviation": deviation_of(of, moment, step, n, rng),
    }  # fmt: skip


def cost_of(of: Loaded, budget: Budget) -> Row:
    """CPU time with tolerances over that without: of the steps, and certified."""
    pairs = PairsWithErrors(of.section.in_motion, budget)
    rows = proven_of_steps(pairs, of.found)

    def seconds(work: Callable[[], object]) -> float:
        work()
        return least_time(work, 5)[0]

    steps = seconds(lambda: measure(of.section.in_motion))
    extra = seconds(lambda: proven_of_steps(pairs, of.found))
    motion = seconds(lambda: certify_motion(of.section.in_motion, of.found, CERTIFY_GAP))
    more = seconds(lambda: proven_between(pairs, rows, CERTIFY_GAP))
    return {
        "steps_cost": 1 + extra / steps,
        "certified_cost": 1 + (extra + more) / (steps + motion),
    }


class Moment:
    """The pairs of a section at one step: the deciding one, and the nearest without errors."""

    def __init__(self, of: Loaded, case: Case, step: int, pair: int) -> None:
        self.case, self.apart = case, of.apart
        self.machine = Machine(case, of.section.phase.motions, step)
        self.sizes = sizes_of(case)
        frames, pairs = self.machine.frames({}, 1), of.section.pairs
        gaps = [float(self.apart.of(case, one, frames)[0][0]) for one in pairs]
        order = [i for i in np.argsort(gaps, kind="stable").tolist() if i != pair]
        self.pairs = [pairs[i] for i in (pair, *order[:NEAREST])]

    def nominal(self) -> float:
        """[m] the distance of the deciding pair without errors."""
        return float(self.apart.of(self.case, self.pairs[0], self.machine.frames({}, 1))[0][0])

    def left(self, pair: Pair, errors: Errors, n: int) -> tuple[np.ndarray, dict[Key, np.ndarray]]:
        """(n,) [m] what is left of a pair, and its slopes."""
        frames = self.machine.frames(errors, n)
        gaps, points = self.apart.of(self.case, pair, frames)
        a, b = (frames[body_name(self.case, body)] for body in pair)
        return gaps - surfaces_of(self.case.tolerance, self.case, pair), slopes(a, b, points)

    def at_random(self, n: int, rng: np.random.Generator) -> float:
        """[m] the least of n samples of the deciding pair, and a tenth as many of each other."""
        least = np.inf
        for i, pair in enumerate(self.pairs):
            m = n if i == 0 else max(1, n // 10)
            least = min(
                least, float(self.left(pair, random_errors(self.sizes, m, rng), m)[0].min())
            )
        return least

    def as_bad_as_found(self, n: int, rng: np.random.Generator) -> float:
        """[m] the least of n starts from which the errors of the deciding pair go against its distance."""
        errors = random_errors(self.sizes, n, rng)
        for value in errors.values():
            value[:, 0] = 0.0
        best, kept = np.full(n, np.inf), errors
        for _ in range(ROUNDS):
            left, slope = self.left(self.pairs[0], errors, n)
            better, best = left < best, np.minimum(best, left)
            kept = {k: np.where(better, errors[k], kept[k]) for k in errors}
            errors = {k: _against(slope, k, size, errors[k]) for k, size in self.sizes.items()}
        i = int(np.argmin(best))
        return self._one_by_one(float(best[i]), {k: v[:, i] for k, v in kept.items()})

    def _one_by_one(self, best: float, errors: dict[Key, np.ndarray]) -> float:
        """[m] the least when one error after another goes to the end, or against its slope, that leaves least."""
        for _ in range(2 * len(errors)):
            tries = list(self._tries(errors))
            rows = {k: np.stack([one[k] for one in tries], axis=1) for k in errors}
            left = self.left(self.pairs[0], rows, len(tries))[0]
            i = int(np.argmin(left))
            if left[i] >= best:
                break
            best, errors = float(left[i]), tries[i]
        return best

    def _tries(self, errors: dict[Key, np.ndarray]) -> Iterator[dict[Key, np.ndarray]]:
        yield errors
        slope = self.left(self.pairs[0], {k: v[:, None] for k, v in errors.items()}, 1)[1]
        for key, size in self.sizes.items():
            for one in (size.most, -size.most) if size.n == 1 else ():
                yield {**errors, key: np.array([one])}
            if size.n == 3:
                yield {**errors, key: _against(slope, key, size, errors[key][:, None])[:, 0]}


def _against(slope: dict[Key, np.ndarray], key: Key, size: Size, now: np.ndarray) -> np.ndarray:
    """The error of its greatest size that lessens the distance most; as it is where it does nothing."""
    if key not in slope:
        return now
    way = slope[key]
    length = np.sqrt((way * way).sum(axis=0))
    return np.where(length > 0.0, -way / np.where(length > 0.0, length, 1.0) * size.most, now)


def deviation_of(of: Loaded, moment: Moment, step: int, n: int, rng: np.random.Generator) -> float:
    """The expected deviation of the deciding pair, over that of n distances with errors as it takes them."""
    case, pair, motions = moment.case, moment.pairs[0], of.section.phase.motions
    points = moment.apart.of(case, pair, moment.machine.frames({}, 1))[1].copy()
    witness = witness_of(case, case.tolerance, motions, pair, np.array([step]), points)
    errors = {}
    for key, size in moment.sizes.items():
        v = rng.normal(size=(size.n, n))
        share = rng.random(n) ** (1.0 / size.n)
        errors[key] = v / np.sqrt((v * v).sum(axis=0)) * size.most * share
    gaps = moment.apart.of(case, pair, moment.machine.frames(errors, n))[0].copy()
    for body in pair:
        gaps -= surface_of(case, case.tolerance, body) * rng.uniform(-1.0, 1.0, n)
    return float(deviations(case, case.tolerance, witness)[0] / gaps.std())


if __name__ == "__main__":
    main()
