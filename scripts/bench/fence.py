"""Holds the answers and times of this tree against those of an earlier revision, side by side in one run.

    python scripts/bench/fence.py REVISION [--cases NAME ...] [--cells N] [--verdicts NAME ...] [--passes N]
        [--rounds N]

Each tree answers in processes of its own, the two in turn: the scenes, the shared cases where they are there, and
random cells. Compared are the bits of every clearance, witness point and pair at the steps; the certified bounds,
with and without tolerances, which may differ but must not be looser by more than 1 %; exit code and summary; and
CPU seconds, the least of all rounds: two processes of one tree differ by 10 % in runs of some milliseconds.
Of small cases that end in every kind of verdict, exit code and summary alone are compared. The exit
code is 1 where bits, exit codes or summaries differ, or a bound is looser.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from harness import ROOT, SCENES, SHARED
from verdict_cases import CASES, write_verdict_case

BUILT = Path("clearance/compile/built")

LOOSER = 0.01
"""[-] A proven bound may be lower than before by so much of itself."""

FINE = 1e-6
"""[m] Bounds that differ by less are alike: the proof ends at a gap of 0.1 mm."""

CELLS = ROOT / "scripts" / "makers" / "cells.py"

RUN = """
import hashlib, json, runpy, sys, time
import numpy as np
import clearance as cl

def case_of(name):
    if not name.startswith("cell "):
        return cl.load_case(name)
    return runpy.run_path(sys.argv[3])["cell"](int(name.removeprefix("cell ")))

def least(values):
    known = [value for value in values if value is not None and value == value]
    return min(known) if known else None

def bits(steps):
    proven = {"lower_bound", "upper_bound", "between", "proven", "expected", "status"}
    columns = sorted(set(steps.column_names) - proven)
    text = repr([steps[name].to_pylist() for name in columns])
    return hashlib.sha256(text.encode()).hexdigest()

def asked(name, **options):
    case = case_of(name)
    best, run = 1e9, None
    for _ in range(int(sys.argv[2])):
        start = time.process_time()
        run = cl.check(case, contact="none", **options)
        run.record.worst
        best = min(best, time.process_time() - start)
    return best, run

name = sys.argv[1]
tolerance = {"joints": {"all": 0.001}, "base": {"xyz": 0.001}}
told = {}
try:
    told["steps_s"], run = asked(name, certify=False)
    told["bits"] = bits(run.steps)
    told["certified_s"], run = asked(name)
    told["certified"] = [float(np.min(rule.certificate.lower_bound)) for rule in run.record.rules]
    told["tolerances_s"], run = asked(name, tolerance=tolerance)
    told["tolerances"] = [least([float(rule.proven.min())]) for rule in run.record.budget]
except cl.ClearanceError as error:
    told["refused"] = type(error).__name__
print(json.dumps(told))
"""


def main() -> int:
    """Runs what the command line asks for."""
    asked = _arguments()
    names = [*_cases(asked.cases), *(f"cell {seed}" for seed in range(asked.cells))]
    with _tree_of(asked.revision) as before:
        trees = {"before": before, "now": ROOT}
        differing = sum(_case_differs(trees, name, asked) for name in names)
        small = CASES if asked.verdicts is None else asked.verdicts
        differing += sum(_verdict_differs(trees, name) for name in small)
    print(f"{differing} differ")
    return int(differing > 0)


def _case_differs(trees: dict[str, Path], name: str, asked: argparse.Namespace) -> bool:
    """Holds the answers to a scene, a shared case or a cell against each other, and prints a line."""
    is_cell = name.startswith("cell ")
    answers: dict[str, dict] = {}
    for _ in range(asked.rounds):
        for tree, path in trees.items():
            found = _answer(path, name if is_cell else str(path / name), asked.passes)
            answers[tree] = _faster(answers.get(tree, found), found)
    return _differs(name if is_cell else Path(name).parent.name, answers, _times(answers))


def _faster(one: dict, other: dict) -> dict:
    """The first answer with the lesser times of both."""
    times = {key for key in one if key.endswith("_s") and key in other}
    return one | {key: min(one[key], other[key]) for key in times}


def _verdict_differs(trees: dict[str, Path], name: str) -> bool:
    """Holds the verdicts on a small case against each other, and prints a line."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = write_verdict_case(Path(folder) / "case", name)
        verdicts = {tree: _command(path, arguments) for tree, path in trees.items()}
    return _differs(name, verdicts, f"exit code {verdicts['now']['exit code']}")


def _differs(name: str, answers: dict[str, dict], told: str) -> bool:
    faults = list(_faults(answers["before"], answers["now"]))
    print(f"{name:34} {told}  {'; '.join(faults) or 'same'}", flush=True)
    return bool(faults)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("revision", help="what git calls the earlier state, as HEAD~3 or a tag")
    parser.add_argument("--cases", nargs="*", help="names of scenes or shared cases; default: all")
    parser.add_argument(
        "--verdicts", nargs="*", choices=[*CASES], help="small cases; default: all", metavar="NAME"
    )
    parser.add_argument("--cells", type=int, default=200, help="number of random cells")
    parser.add_argument("--passes", type=int, default=3, help="runs of which the least time counts")
    parser.add_argument("--rounds", type=int, default=1, help="processes of each tree, in turn")
    return parser.parse_args()


@contextmanager
def _tree_of(revision: str) -> Iterator[Path]:
    """A folder with the earlier state, beside the shared cases as this one is."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "before"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), revision], check=True)
        if SHARED.is_dir():
            (Path(folder) / "shared").symlink_to(SHARED.parent)
        if (tree / BUILT).parent.joinpath("build.py").exists() and (ROOT / BUILT).is_dir():
            shutil.copytree(ROOT / BUILT, tree / BUILT)  # what fits of it is not compiled again
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def _cases(names: list[str] | None) -> list[str]:
    """The case files that are asked about, as seen from a tree."""
    scenes = [f"scenes/{path.parent.name}/case.yaml" for path in sorted(SCENES.glob("*/case.yaml"))]
    shared = [
        f"../shared/cases/{path.parent.name}/case.yaml"
        for path in sorted(SHARED.glob("*/case.yaml"))
    ]
    return [path for path in scenes + shared if names is None or Path(path).parent.name in names]


def _answer(tree: Path, name: str, passes: int) -> dict:
    """What a tree says of a case: bits, bounds, seconds; exit code and summary of the command."""
    done = _run(tree, "-c", RUN, name, str(passes), str(CELLS))
    if done.returncode:
        return {"crashed": done.stderr.strip().rpartition("\n")[2]}
    told = json.loads(done.stdout)
    return told if name.startswith("cell ") else told | _command(tree, [name])


def _run(tree: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A Python process that has its modules from a tree."""
    own = {"PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=tree, env=os.environ | own, capture_output=True, text=True)


def _command(tree: Path, arguments: list[str]) -> dict:
    """Exit code and summary of `clearance check`; of one that gives none, what it says."""
    done = _run(tree, "-m", "clearance", "check", *arguments, "--json")
    said = json.loads(done.stdout) if done.stdout else {"said": done.stderr.strip()}
    return {"exit code": done.returncode, "summary": said}


def _faults(before: dict, now: dict) -> Iterator[str]:
    """What differs that must not."""
    for key in ("crashed", "refused", "bits", "exit code"):
        if before.get(key) != now.get(key):
            yield f"{key}: {before.get(key)} -> {now.get(key)}"
    for key in ("certified", "tolerances"):
        for old, new in zip(before.get(key, ()), now.get(key, ()), strict=False):
            if old is not None and (new is None or new < old - LOOSER * abs(old) - FINE):
                yield f"{key}: {old:.9g} -> {new}"
    changed = sorted(_changed(before.get("summary", {}), now.get("summary", {})))
    if changed:
        yield f"summary: {', '.join(changed)}"


def _changed(before: dict, now: dict) -> set[str]:
    """The keys at the top of two summaries that have other values; what was read and by what may differ."""
    left_out = {"provenance", "sources", "versions", "made_by"}
    return {key for key in {*before, *now} - left_out if before.get(key) != now.get(key)}


def _times(answers: dict[str, dict]) -> str:
    """CPU seconds now over those before."""
    ratios = []
    for key in ("steps_s", "certified_s", "tolerances_s"):
        old, new = (answers[tree].get(key) for tree in ("before", "now"))
        ratios.append(f"{key[:-2]} {new / old:.2f}" if old and new else f"{key[:-2]} -")
    return "  ".join(ratios)


if __name__ == "__main__":
    sys.exit(main())
