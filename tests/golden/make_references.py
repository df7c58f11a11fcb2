"""Writes `references/*.json`: `python -m tests.golden.make_references [case …]`.

Each holds, of some steps of a case, the pairs of least clearance and that clearance to 30 digits. The steps are
the nearest one by the engine, which the oracle is then asked about as about any other, and some spread over the
motion. Meshes of thousands of triangles take it many minutes a case.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import clearance as cl
from clearance.record.record import PairMinimum
from clearance.world.motion import kinematic_motion
from clearance.world.timeline import timeline_of
from tests import oracle
from tests.golden.exact_clearances import clearance_sq_of, least_clearance_sq

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
CASES = sorted([*ROOT.glob("scenes/*/case.yaml"), *HERE.glob("cells/*.yaml")])
DIGITS = 30
SPREAD = 4
N_PARTS = 8


def main(names: list[str]) -> None:
    """Writes the references of the named cases, of all where none is named."""
    for path in CASES:
        if not names or name_of(path) in names:
            reference_path(path).write_text(text_of(reference_of(path)), encoding="utf-8")
            print(name_of(path), flush=True)


def name_of(path: Path) -> str:
    """A case's name: its folder's, or its file's."""
    return path.parent.name if path.stem == "case" else path.stem


def reference_path(path: Path) -> Path:
    """Where the reference of a case lies."""
    return HERE / "references" / f"{name_of(path)}.json"


def text_of(reference: dict) -> str:
    """JSON with a line for each step and each pair."""
    lists = {name: reference[name] for name in ("steps", "parts") if reference[name]}
    told = [f'"case": {json.dumps(reference["case"])}']
    for name, rows in lists.items():
        lines = ",\n  ".join(json.dumps(row) for row in rows)
        told.append(f'"{name}": [\n  {lines}\n ]')
    return "{\n " + ",\n ".join(told) + "\n}\n"


def reference_of(path: Path) -> dict:
    """The steps of a case and the truth about them."""
    case = without_rules(cl.load_case(path))
    steps = askable_steps(case)
    run = cl.check(case, certify=False)
    clearances = run.record.clearances
    nearest = min(steps, key=lambda step: clearances[step])
    spread = np.array(steps)[np.linspace(0, len(steps) - 1, SPREAD).astype(int)].tolist()
    rows = [row(case, step) for step in sorted({nearest, *spread})]
    parts = [pair_row(case, least) for least in of_parts(run, steps)]
    return {"case": str(path.relative_to(ROOT)), "steps": rows, "parts": parts}


def of_parts(run: cl.Run, steps: list[int]) -> list[PairMinimum]:
    """The nearest minima of pairs with an obstacle that moves, rides or is carried, at some of the steps."""
    case = run.record.case
    names = {one.name for one in case.obstacles if not one.stands}
    names |= {carry.part for carry in case.carries}
    found = [
        least
        for least in run.pair_minima
        if names & {least.link, least.obstacle} and least.step in steps and least.clearance > 0.0
    ]
    return found[:N_PARTS]


def without_rules(case: cl.Case) -> cl.Case:
    """The case with one limit for all pairs, so that the least clearance of a step is told of it."""
    return replace(case, limits=replace(case.limits, rules=()))


def askable_steps(case: cl.Case) -> list[int]:
    """The steps within phases, at which a table that turns a body has a row."""
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    edges = {phase.first for phase in timeline.phases[1:]}
    tables = [one.moves for one in case.obstacles if one.moves is not None]
    turning = [table for table in tables if np.ptp(table.quaternions, axis=0).any()]
    known = [np.isin(timeline.times, table.timing.run_times(table.times)) for table in turning]
    asked = np.logical_and.reduce([np.ones(len(timeline.times), dtype=bool), *known])
    return [step for step in np.flatnonzero(asked).tolist() if step not in edges]


def row(case: cl.Case, step: int) -> dict:
    """One step: its pairs of least clearance, and that clearance [m]."""
    least_sq, pairs = least_clearance_sq(case, step)
    return {
        "step": step,
        "pairs": pairs,
        "clearance": decimal(oracle.root(least_sq, digits=DIGITS + 10)),
    }


def pair_row(case: cl.Case, least: PairMinimum) -> dict:
    """One pair at the step where it comes nearest, and its clearance [m] there."""
    exact = clearance_sq_of(case, least.step, least.link, least.obstacle)
    return {
        "step": least.step,
        "pair": [least.link, least.obstacle],
        "clearance": decimal(oracle.root(exact, digits=DIGITS + 10)),
    }


def decimal(number) -> str:
    """A number from 0 on, cut after `DIGITS` places."""
    whole = int(number * 10**DIGITS)
    return f"{whole // 10**DIGITS}.{whole % 10**DIGITS:0{DIGITS}d}"


if __name__ == "__main__":
    main(sys.argv[1:])
