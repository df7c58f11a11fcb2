"""What is expected under tolerances, against errors drawn at random: `python scripts/bench/budget_expected.py`.

Of the pairs that come nearest in each scene and shared case, at the step at which they do: the standard deviation
that `clearance.budget.expected` works out from slopes at the nearest points, and that of distances measured anew
with errors drawn as it takes them. The distances are those of whole bodies, whose nearest points may change.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from budget_campaign import Loaded, sections_in
from budget_samples import Key, Machine, Size, body_name, sizes_of
from inputs import SCENES, SHARED

from clearance.budget.errors_of import surface_of
from clearance.budget.expected import deviations, witness_of
from clearance.world.pairs import Pair

PAIRS = 4
"""Of a section: the nearest that do not touch."""

BLOCK = 20_000
"""Samples that are worked out together."""


def drawn(
    sizes: Mapping[Key, Size], n: int, normal: bool, rng: np.random.Generator
) -> dict[Key, np.ndarray]:
    """Errors as the estimate takes them: uniform up to their size, or in a ball; or normal."""
    found = {}
    for key, size in sizes.items():
        v = rng.normal(size=(size.n, n))
        if normal:
            found[key] = v * size.most / 3.0
        elif size.n == 1:
            found[key] = size.most * rng.uniform(-1.0, 1.0, (1, n))
        else:
            found[key] = v / np.sqrt((v * v).sum(axis=0)) * size.most * rng.random(n) ** (1 / 3)
    return found


def pairs_at(of: Loaded, machine: Machine) -> Iterator[tuple[Pair, float, np.ndarray]]:
    """The nearest pairs that do not touch: their distance [m] and nearest points (1, 2, 3)."""
    frames = machine.frames({}, 1)
    gaps = [of.apart.of(machine.case, pair, frames) for pair in of.section.pairs]
    order = np.argsort([float(gap[0]) for gap, _ in gaps], kind="stable")
    apart = [i for i in order.tolist() if gaps[i][0][0] > 0.0][:PAIRS]
    for i in apart:
        yield of.section.pairs[i], float(gaps[i][0][0]), gaps[i][1].copy()


def measured(of: Loaded, machine: Machine, pair: Pair, n: int, normal: bool) -> np.ndarray:
    """(n,) [m] distances with errors, less surfaces with theirs."""
    rng, case = np.random.default_rng(0), machine.case
    sizes = sizes_of(case)
    budget = case.tolerance
    found = []
    for _ in range(0, n, BLOCK):
        frames = machine.frames(drawn(sizes, BLOCK, normal, rng), BLOCK)
        gaps = of.apart.of(case, pair, frames)[0].copy()
        for body in pair:
            surface = {("surface", "", ""): Size(surface_of(case, budget, body), 1)}
            gaps -= drawn(surface, BLOCK, normal, rng)["surface", "", ""][0]
        found.append(gaps)
    return np.concatenate(found)


def rows(of: Loaded, n: int) -> Iterator[tuple]:
    """A row a pair and kind of distribution; deviations in mm."""
    apart = np.where(of.found.clearance > 0.0, of.found.clearance, np.inf)
    step = int(np.argmin(apart))
    for normal in (False, True):
        budget = replace(of.case.tolerance, is_normal=normal)
        case = replace(of.section.phase.case, tolerance=budget)
        machine = Machine(case, of.section.phase.motions, step)
        for pair, nominal, points in pairs_at(of, machine):
            witness = witness_of(
                case, budget, of.section.phase.motions, pair, np.array([step]), points
            )
            told = float(deviations(case, budget, witness)[0])
            gaps = measured(of, machine, pair, n, normal)
            names = " - ".join(body_name(case, body) for body in pair)
            found = float(gaps.std())
            yield (
                of.name, names, "normal" if normal else "uniform", f"{1e3 * nominal:.3f}",
                f"{1e3 * told:.4f}", f"{1e3 * found:.4f}", f"{told / found:.3f}",
                f"{1e3 * (gaps.mean() - nominal):.4f}", f"{(gaps <= nominal - 3.0 * told).mean():.5f}",
            )  # fmt: skip


def main() -> None:
    """Prints a row a pair."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "cases", nargs="*", type=Path, help="case files; all scenes and shared cases"
    )
    parser.add_argument("--samples", type=int, default=100_000)
    asked = parser.parse_args()
    table = csv.writer(sys.stdout)
    table.writerow(
        ("case", "pair", "errors", "nominal_mm", "deviation_mm", "measured_mm", "ratio", "shift_mm", "below_3")
    )  # fmt: skip
    paths = asked.cases or sorted([*SCENES.glob("*/case.yaml"), *SHARED.glob("*/case.yaml")])
    done: set[str] = set()
    for one in sections_in(paths):
        if one.name not in done:
            done.add(one.name)
            table.writerows(rows(one, asked.samples))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
