"""Random budgets against samples of what they allow: `python scripts/bench/budget_campaign.py --budgets 1000`.

Of each case, its sections by turns, at the step at which a random budget leaves least: errors at random, and
errors that are made as bad as found, on distances measured anew. Rows go to a journal, and what is in it is not
done again, so that a campaign may be stopped and taken up. It ends at the first sample below what is proven.
`--between` samples the motion from step to step instead: the interval of which least is proven, and one at
random, at several times in each. `--summary` prints what the journal holds.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from budget import scaled, typical
from budget_samples import (
    Apart,
    Errors,
    Key,
    Machine,
    Size,
    body_name,
    random_errors,
    sizes_of,
    slopes,
    surfaces_of,
)
from inputs import SCENES, SHARED

import clearance as cl
from clearance.budget.proven import PairsWithErrors, proven_between, proven_of_steps
from clearance.kernels.budget.sweep import BudgetRows
from clearance.record.measurement import Measurement
from clearance.run.answers import measurement_plan
from clearance.run.question import Question
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.sections import Section
from clearance.tolerance import CERTIFY_GAP
from clearance.world.budget import Budget
from clearance.world.case import Case
from clearance.world.pairs import Pair

COLUMNS = (
    "case", "section", "budget", "step", "pair", "nominal", "proven", "at_random", "as_bad_as_found", "samples",
)  # fmt: skip
NEAREST = 3
"""Pairs that are sampled beside the one that decides, a tenth as often: the nearest."""

ROUNDS = 5
"""How often all errors are turned against the distance at once; then one after another."""

MOST, DECADES = 6.0, 1.5
"""The greatest tolerances are up to so many times those of a typical cell, down by so many decades."""

TIMES = 8
"""Times in an interval at which errors are drawn, one of them where the least was seen."""

ROUNDING = 1e-12
"""[m] By which a measured distance may be off."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """A section of a case, what was measured of it, and its pairs, whose arrays are kept."""

    name: str
    case: Case
    section: Section
    found: Measurement
    apart: Apart


def sections_in(paths: list[Path]) -> Iterator[Loaded]:
    """The sections of some case files that have a clearance at all."""
    for path in paths:
        case = cl.load_case(path)
        case = replace(case, tolerance=typical(case))
        for section in measurement_plan(Question(case)).sections.sections:
            found = measure(section.in_motion)
            if section.tied and np.nanmax(found.clearance) > 0.0:
                yield Loaded(path.parent.name, case, section, found, Apart())


class Moment:
    """The pairs of a section at one time."""

    def __init__(self, of: Loaded, case: Case, step: int, pair: int, share: float = 0.0) -> None:
        self.case, self.apart = case, of.apart
        self.machine = Machine(case, of.section.phase.motions, step, share)
        self.sizes = sizes_of(case)
        self.pairs = self._nearest(of.section.pairs, pair)

    def _nearest(self, pairs: tuple[Pair, ...], pair: int) -> list[Pair]:
        """The deciding pair, then the nearest without errors."""
        frames = self.machine.frames({}, 1)
        gaps = [float(self.apart.of(self.case, one, frames)[0][0]) for one in pairs]
        order = [i for i in np.argsort(gaps, kind="stable").tolist() if i != pair]
        return [pairs[i] for i in (pair, *order[:NEAREST])]

    def left(self, pair: Pair, errors: Errors, n: int):
        """(n,) [m] what is left of a pair, and its slopes."""
        frames = self.machine.frames(errors, n)
        gaps, points = self.apart.of(self.case, pair, frames)
        a, b = (frames[body_name(self.case, body)] for body in pair)
        budget = self.case.tolerance
        assert budget is not None
        return gaps - surfaces_of(budget, self.case, pair), slopes(a, b, points)

    def at_random(self, n: int, rng: np.random.Generator) -> float:
        """[m] the least of n samples of the deciding pair, and a tenth as many of each other."""
        least = np.inf
        for i, pair in enumerate(self.pairs):
            m = n if i == 0 else max(1, n // 10)
            errors = random_errors(self.sizes, m, rng)
            least = min(least, float(self.left(pair, errors, m)[0].min()))
        return least

    def as_bad_as_found(self, n: int, rng: np.random.Generator) -> float:
        """[m] the least of n starts from which the errors of the deciding pair go against its distance."""
        errors = random_errors(self.sizes, n, rng)
        for value in errors.values():
            value[:, 0] = 0.0
        best, kept = np.full(n, np.inf), errors
        for _ in range(ROUNDS):
            left, slope = self.left(self.pairs[0], errors, n)
            better = left < best
            best = np.minimum(best, left)
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


def sampled(of: Loaded, i_budget: int, n_random: int, n_starts: int) -> tuple | None:
    """The row of a budget; None where bodies touch without errors."""
    rng = np.random.default_rng(i_budget)
    budget = scaled(of.case, rng, MOST * 10.0 ** (-DECADES * rng.random()))
    pairs = PairsWithErrors(of.section.in_motion, budget)
    rows = proven_of_steps(pairs, of.found)
    apart = (of.found.clearance > 0.0) & (rows.pair >= 0)
    if not apart.any():
        return None
    step = int(np.argmin(np.where(apart, rows.proven, np.inf)))
    case = replace(of.section.phase.case, tolerance=budget)
    moment = Moment(of, case, step, int(rows.pair[step]))
    proven = float(rows.proven[step])
    found = moment.at_random(n_random, rng), moment.as_bad_as_found(n_starts, rng)
    names = " - ".join(body_name(case, body) for body in moment.pairs[0])
    n = n_random + (len(moment.pairs) - 1) * max(1, n_random // 10)
    nominal = float(moment.left(moment.pairs[0], {}, 1)[0][0])
    nominal += surfaces_of(budget, case, moment.pairs[0])
    numbers = (f"{1e3 * v:.9f}" for v in (nominal, proven, *found))
    row = of.name, of.section.number, i_budget, step, names, *numbers, n + n_starts
    if min(found) < proven - ROUNDING:
        raise SystemExit(f"below what is proven: {', '.join(map(str, row))}")
    return row


def sampled_between(of: Loaded, i_budget: int, n_random: int, n_starts: int) -> tuple | None:
    """The row of a budget over the intervals; None where bodies touch without errors."""
    rng = np.random.default_rng(i_budget)
    budget = scaled(of.case, rng, MOST * 10.0 ** (-DECADES * rng.random()))
    pairs = PairsWithErrors(of.section.in_motion, budget)
    steps = proven_of_steps(pairs, of.found)
    rows = proven_between(pairs, steps, CERTIFY_GAP)
    touches = ~(of.found.clearance > 0.0)
    apart = np.flatnonzero(~(touches[:-1] | touches[1:]) & (steps.pair[:-1] >= 0))
    if len(apart) == 0:
        return None
    worst = int(apart[np.argmin(rows.proven[apart])])
    told = None
    for step in (int(rng.choice(apart)), worst):
        row = _over_interval(of, budget, step, (steps, rows), n_random, n_starts, rng)
        found = of.name, of.section.number, i_budget, step, *row
        if min(row[3:5]) < row[2] - 1e3 * ROUNDING:
            raise SystemExit(f"below what is proven: {', '.join(map(str, found))}")
        told = found if told is None else (*found[:-1], told[-1] + found[-1])
    return told


def _over_interval(
    of: Loaded,
    budget: Budget,
    step: int,
    proven: tuple[BudgetRows, BudgetRows],
    n_random: int,
    n_starts: int,
    rng: np.random.Generator,
) -> tuple:
    """Names of the pair, [mm] nominal, proven, least at random and made worse, samples: of one interval."""
    steps, rows = proven
    case = replace(of.section.phase.case, tolerance=budget)
    pair = int(rows.pair[step] if rows.pair[step] >= 0 else steps.pair[step])
    shares = [share for share in (float(rows.share[step]),) if 0.0 < share < 1.0]
    shares += rng.random(TIMES - len(shares)).tolist()
    least, n = np.full(3, np.inf), 0
    for share in shares:
        moment = Moment(of, case, step, pair, share)
        nominal = moment.left(moment.pairs[0], {}, 1)[0][0]
        nominal += surfaces_of(budget, case, moment.pairs[0])
        m, starts = max(1, n_random // TIMES), max(1, n_starts // TIMES)
        found = nominal, moment.at_random(m, rng), moment.as_bad_as_found(starts, rng)
        least = np.minimum(least, np.array(found))
        n += m + (len(moment.pairs) - 1) * max(1, m // 10) + starts
    names = " - ".join(body_name(case, body) for body in moment.pairs[0])
    told = (least[0], float(rows.proven[step]), *least[1:])
    return names, *(float(f"{1e3 * v:.9f}") for v in told), n


def run(asked: argparse.Namespace, paths: list[Path]) -> None:
    """Goes on with a campaign until all budgets are done, or its time is up."""
    end = time.monotonic() + asked.seconds
    with asked.journal.open("a+", newline="") as file:
        file.seek(0)
        done = {(r[0], int(r[1]), int(r[2])) for r in csv.reader(file)}
        loaded: dict[str, list[Loaded]] = defaultdict(list)
        for one in sections_in(paths):
            loaded[one.name].append(one)
        table = csv.writer(file)
        for i in range(asked.budgets):
            for one in (own[i % len(own)] for own in loaded.values()):
                if (one.name, one.section.number, i) in done:
                    continue
                of_moment = sampled_between if asked.between else sampled
                row = of_moment(one, i, asked.random, asked.starts)
                table.writerow(row or (one.name, one.section.number, i))
                file.flush()
                if time.monotonic() > end:
                    return


def summary(journal: Path) -> None:
    """A line a case: how many budgets and samples, and how tight the bound is where errors leave something."""
    of_case: dict[str, list] = defaultdict(list)
    with journal.open(newline="") as file:
        for row in csv.reader(file):
            of_case[row[0]].append(row)
    table = csv.writer(sys.stdout)
    table.writerow(
        ("case", "budgets", "touching", "samples", "above_0", "median", "p95", "greatest")
    )
    for name, rows in [*of_case.items(), ("all", [r for own in of_case.values() for r in own])]:
        full = [row for row in rows if len(row) == len(COLUMNS)]
        numbers = np.array([[float(v) for v in row[5:9]] for row in full]).reshape(-1, 4)
        kept = numbers[numbers[:, 1] > 0.0]
        tight = (kept[:, 0] - kept[:, 1]) / (kept[:, 0] - kept[:, 2:].min(axis=1))
        told = (np.median(tight), np.percentile(tight, 95), tight.max()) if len(tight) else ()
        n_samples = sum(int(row[-1]) for row in full)
        figures = (f"{v:.3f}" for v in told)
        table.writerow((name, len(full), len(rows) - len(full), n_samples, len(kept), *figures))


def main() -> None:
    """Samples, or tells what was sampled."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "cases", nargs="*", type=Path, help="case files; all scenes and shared cases"
    )
    parser.add_argument(
        "--budgets", type=int, default=1000, help="for each case; its sections by turns"
    )
    parser.add_argument(
        "--random", type=int, default=10_000, help="samples at random a worst moment"
    )
    parser.add_argument("--starts", type=int, default=1000, help="samples that are made worse")
    parser.add_argument("--between", action="store_true", help="the motion from step to step")
    parser.add_argument("--seconds", type=float, default=np.inf, help="then it stops")
    parser.add_argument("--journal", type=Path, default=Path("budget_campaign.csv"))
    parser.add_argument("--summary", action="store_true", help="of the journal")
    asked = parser.parse_args()
    if asked.summary:
        summary(asked.journal)
        return
    paths = asked.cases or sorted([*SCENES.glob("*/case.yaml"), *SHARED.glob("*/case.yaml")])
    run(asked, paths)


if __name__ == "__main__":
    main()
