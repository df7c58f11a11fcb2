"""Writes `references/*.json`: `python -m tests.golden.make_references [case …]`.

Each holds, of some steps of a case, the pairs of least clearance and that clearance to 30 digits. The steps are
the nearest one by the engine, which the oracle is then asked about as about any other, and some spread over the
motion. Meshes of thousands of triangles take it many minutes a case.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

import clearance as cl
from tests import oracle
from tests.golden.exact_clearances import least_clearance_sq

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
CASES = sorted([*ROOT.glob("scenes/*/case.yaml"), *HERE.glob("cells/*.yaml")])
DIGITS = 30
SPREAD = 4


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
    """JSON with a line for each step."""
    rows = ",\n  ".join(json.dumps(row) for row in reference["steps"])
    return f'{{\n "case": {json.dumps(reference["case"])},\n "steps": [\n  {rows}\n ]\n}}\n'


def reference_of(path: Path) -> dict:
    """The steps of a case and the truth about them."""
    case = cl.load_case(path)
    n_steps = len(case.robots[0].trajectory.times)
    worst = cl.check(case, certify=False).worst_sample["step"]
    steps = sorted({worst, *np.linspace(0, n_steps - 1, SPREAD).astype(int).tolist()})
    return {"case": str(path.relative_to(ROOT)), "steps": [row(case, step) for step in steps]}


def row(case: cl.Case, step: int) -> dict:
    """One step: its pairs of least clearance, and that clearance [m]."""
    least_sq, pairs = least_clearance_sq(case, step)
    return {
        "step": step,
        "pairs": pairs,
        "clearance": decimal(oracle.root(least_sq, digits=DIGITS + 10)),
    }


def decimal(number) -> str:
    """A number from 0 on, cut after `DIGITS` places."""
    whole = int(number * 10**DIGITS)
    return f"{whole // 10**DIGITS}.{whole % 10**DIGITS:0{DIGITS}d}"


if __name__ == "__main__":
    main(sys.argv[1:])
