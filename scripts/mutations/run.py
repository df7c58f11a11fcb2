"""Seeds faults in the package, one at a time, and says which test finds each.

    python scripts/mutations/run.py [NAME or TABLE ...] [--jobs N] [--everything]

The tables beside this file list the faults: text before and after, and the tests that find each. Text and tests
are looked for in all files, so that files may move. A fault is seeded in a copy of the tree, never here. The exit
code is 1 where one survives, and where a table does not fit the tree: a text that is not in the package exactly
once, a test that is not there or fails without the fault.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).resolve().parents[2]

LEFT_OUT = shutil.ignore_patterns(".git", ".venv*", "out", ".*_cache", ".hypothesis", "shared")

FAST = "not cold and not browser and not peer and not slow and not shared"
"""The fast lane, as `scripts/test` has it."""

PASSED, FAILED = 0, 1
"""Exit codes of pytest; greater ones say that it ran no test."""

FAULT = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", re.MULTILINE)


class DoesNotFit(Exception):
    """A table does not fit the tree."""


@dataclass(frozen=True)
class Mutation:
    """One fault.

    Attributes:
        table: the file that lists it. fault: what is wrong, in plain words.
        before, after: the text that is replaced, which is in the package once, and what it becomes.
        killed_by: the tests that find it, by name. kernels: `CLEARANCE_KERNELS` for them.
    """

    table: str
    name: str
    fault: str
    before: str
    after: str
    killed_by: tuple[str, ...]
    kernels: str = "built"

    def __str__(self) -> str:
        return f"{self.table}/{self.name}"


@dataclass(frozen=True)
class Outcome:
    """What became of a fault: the test that failed, or why there is none, and how long that took [s]."""

    mutation: Mutation
    killed: bool
    told: str
    seconds: float

    def __str__(self) -> str:
        """A row of the table that is printed."""
        sign = "killed  " if self.killed else "SURVIVED"
        return f"{sign} {self.seconds:5.1f} s  {self.mutation}: {self.told}"


def main() -> int:
    """Runs what the command line asks for."""
    asked = _arguments()
    known = mutations()
    chosen = [one for one in known if not asked.names or {one.name, one.table} & asked.names]
    try:
        unknown = asked.names - {name for one in known for name in (one.name, one.table)}
        if unknown:
            raise DoesNotFit(f"no fault or table is called {', '.join(sorted(unknown))}")
        with _trees(asked.jobs) as trees:
            tree = trees.get()
            _require_sound(tree, chosen, asked.everything)
            trees.put(tree)
            outcomes = _outcomes(trees, chosen, asked)
    except DoesNotFit as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    n_survived = sum(not one.killed for one in outcomes)
    print(f"{len(outcomes) - n_survived} of {len(outcomes)} faults are found")
    return int(n_survived > 0)


def mutations() -> list[Mutation]:
    """All faults of all tables."""
    found = []
    for table in sorted(Path(__file__).parent.glob("*.toml")):
        for name, row in tomllib.loads(table.read_text(encoding="utf-8")).items():
            killed_by = tuple(row.pop("killed_by"))
            found.append(Mutation(table.stem, name, killed_by=killed_by, **row))
    return found


class Tree:
    """A copy of the tree, and where in it things are."""

    def __init__(self, place: Path) -> None:
        self.place = Path(shutil.copytree(ROOT, place, ignore=LEFT_OUT))
        self._package, self._tests = (
            {file: file.read_text(encoding="utf-8") for file in (self.place / room).rglob("*.py")}
            for room in ("clearance", "tests")
        )

    def file_of(self, mutation: Mutation) -> Path:
        """The file that a fault is in.

        Raises:
            DoesNotFit: the text before is not in the package exactly once.
        """
        found = [file for file, text in self._package.items() if mutation.before in text]
        if len(found) != 1 or self._package[found[0]].count(mutation.before) != 1:
            places = ", ".join(str(file.relative_to(self.place)) for file in found) or "no file"
            raise DoesNotFit(f"{mutation}: the text before stands not once, but in {places}")
        return found[0]

    def tests_of(self, mutation: Mutation, everything: bool) -> list[str]:
        """What pytest is asked for; of the fast lane the rooms of the tests come first.

        Raises:
            DoesNotFit: a test is not there.
        """
        found: list[str] = []
        for name in mutation.killed_by:
            files = [file for file, text in self._tests.items() if f"\ndef {name}(" in text]
            if not files:
                raise DoesNotFit(f"{mutation}: there is no test {name}")
            found += [f"{file.relative_to(self.place)}::{name}" for file in sorted(files)]
        if not everything:
            return found
        rooms = {str(Path(*Path(test.partition("::")[0]).parts[:2])) for test in found}
        return [*sorted(rooms), "tests", "-m", FAST, "--hypothesis-profile", "dev"]

    @contextmanager
    def seeded(self, mutation: Mutation) -> Iterator[None]:
        """Has the fault in it, inside."""
        file = self.file_of(mutation)
        file.write_text(self._package[file].replace(mutation.before, mutation.after), "utf-8")
        try:
            yield
        finally:  # with its time, by which Python knows what it has compiled
            shutil.copy2(ROOT / file.relative_to(self.place), file)


@contextmanager
def _trees(n: int) -> Iterator[SimpleQueue[Tree]]:
    """Copies of the tree."""
    with tempfile.TemporaryDirectory(prefix="mutations-") as place:
        trees: SimpleQueue[Tree] = SimpleQueue()
        for i in range(n):
            trees.put(Tree(Path(place, str(i))))
        yield trees


def _require_sound(tree: Tree, chosen: Sequence[Mutation], everything: bool) -> None:
    """Nothing, if all texts are there, and all tests are and pass without a fault.

    Raises:
        DoesNotFit: with the first that does not.
    """
    for one in chosen:
        tree.file_of(one)
    for kernels in sorted({one.kernels for one in chosen}):
        own = [one for one in chosen if one.kernels == kernels]
        tests = dict.fromkeys(test for one in own for test in tree.tests_of(one, everything))
        code, told = _tested(tree, list(tests), kernels)
        if code != PASSED:
            raise DoesNotFit(f"without any fault the tests do not pass:\n{told}")


def _outcomes(
    trees: SimpleQueue[Tree], chosen: Sequence[Mutation], asked: argparse.Namespace
) -> list[Outcome]:
    """What became of each, printed as soon as it is known."""

    def one(mutation: Mutation) -> Outcome:
        tree = trees.get()
        found = _outcome(tree, mutation, asked.everything)
        trees.put(tree)
        print(found, flush=True)
        return found

    with ThreadPoolExecutor(asked.jobs) as pool:
        return list(pool.map(one, chosen))


def _outcome(tree: Tree, mutation: Mutation, everything: bool) -> Outcome:
    """Seeds a fault, and runs its tests."""
    start = time.perf_counter()
    with tree.seeded(mutation):
        code, told = _tested(tree, tree.tests_of(mutation, everything), mutation.kernels)
    seconds = time.perf_counter() - start
    if code == PASSED:
        return Outcome(mutation, False, mutation.fault, seconds)
    failed = FAULT.search(told)
    if code != FAILED or failed is None:
        return Outcome(mutation, False, f"no test ran:\n{told}", seconds)
    return Outcome(mutation, True, failed[1], seconds)


def _tested(tree: Tree, tests: Sequence[str], kernels: str) -> tuple[int, str]:
    """The exit code of pytest in a tree, and the end of what it says."""
    command = [sys.executable, "-m", "pytest", *tests, "-x", "-q", "-n", "0", "-rfE", "--tb=line"]
    surroundings = os.environ | {
        "PYTHONPATH": str(tree.place),
        "PYTHONDONTWRITEBYTECODE": "",  # what is compiled stays in the tree
        "OPENBLAS_NUM_THREADS": "1",
        "CLEARANCE_KERNELS": kernels,
    }
    done = subprocess.run(
        [*command, "-p", "no:cacheprovider"],
        cwd=tree.place, env=surroundings, capture_output=True, text=True,
    )  # fmt: skip
    return done.returncode, (done.stdout + done.stderr)[-4000:]


def _arguments() -> argparse.Namespace:
    assert __doc__ is not None
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", help="faults, or tables of them; all by default")
    parser.add_argument("--jobs", type=int, default=1, help="how many at a time")
    parser.add_argument(
        "--everything", action="store_true", help="run all of the fast lane against each"
    )
    asked = parser.parse_args()
    asked.names = set(asked.names)
    return asked


if __name__ == "__main__":
    sys.exit(main())
