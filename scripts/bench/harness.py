"""The harness of the benchmarks: one thread, one clock, one table, one way to write results.

    python scripts/bench/harness.py [--only SCENARIO ...] [--out FOLDER]

runs each scenario beside this file on its smallest size, once a pass, and writes its rows to a CSV of its name. A
scenario is a script with `main(words) -> rows` and the words of its smallest size, `SMALLEST`. It imports this
file first, since the number of threads is set before numpy is loaded. Not for: inputs (`inputs`), other libraries
(`peers`, `loops`).

CPU time of this one-threaded process, not time on the wall: the same on a quiet machine, and still a measurement
on a busy one. Passes of all contenders take turns, so that a change of the machine's speed meets all of them. In
each pass a contender's work is done again until it has taken `LEAST_PASS`: what takes a millisecond is otherwise
half the time it takes to fetch its data again after all the others. That first time is told too.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")  # before numpy is loaded: one thread for everybody

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))  # so that a script runs from the root without an installation

import argparse  # noqa: E402
import csv  # noqa: E402
import time  # noqa: E402
from collections.abc import Callable, Iterable, Sequence  # noqa: E402
from importlib import import_module  # noqa: E402
from typing import Any, NamedTuple  # noqa: E402

import numpy as np  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402

RESULTS = Path(__file__).parent / "results"
SHARED = ROOT.parent / "shared" / "cases"
SCENES = ROOT / "scenes"

LEAST_PASS = 0.05
"""[s] CPU time of a pass at least."""

Row = dict[str, Any]
"""One measurement: a column a key."""


class Timing(NamedTuple):
    """Seconds of CPU that the work takes: median, least and greatest over `n_passes`; what it returned last.

    Attributes:
        first: the median of the first time in each pass, right after the others' turns.
    """

    median: float
    least: float
    greatest: float
    first: float
    n_passes: int
    answer: Any


class Pass(NamedTuple):
    """CPU seconds of the work in one pass: the first time, all times together, and how many there were."""

    first: float
    total: float
    n_times: int


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds of one call, and its value."""
    start = time.process_time()
    answer = work()
    return time.process_time() - start, answer


def least_time(work: Callable[[], Any], n_times: int) -> tuple[float, Any]:
    """[s] CPU time, the least of several calls, and the value of that call."""
    return min((timed(work) for _ in range(n_times)), key=lambda found: found[0])


def interleaved(works: Sequence[Callable[[], Any]], n_passes: int, budget: float) -> list[Timing]:
    """The timing of each of `works`: one call to warm up, then `n_passes` in turns, two at least.

    A work takes no further part once it has spent `budget` [s].
    """
    passes: list[list[Pass]] = [[] for _ in works]
    answers = [work() for work in works]
    for i_pass in range(n_passes):
        for i, work in enumerate(works):
            if i_pass < 2 or sum(each.total for each in passes[i]) < budget:
                done, answers[i] = _pass(work)
                passes[i].append(done)
    return [_timing(done, answer) for done, answer in zip(passes, answers, strict=True)]


def _pass(work: Callable[[], Any]) -> tuple[Pass, Any]:
    first, answer = timed(work)
    total, n_times = first, 1
    while total < LEAST_PASS:
        passed, answer = timed(work)
        total, n_times = total + passed, n_times + 1
    return Pass(first, total, n_times), answer


def _timing(passes: list[Pass], answer: Any) -> Timing:
    seconds = [each.total / each.n_times for each in passes]
    first = float(np.median([each.first for each in passes]))
    median = float(np.median(seconds))
    return Timing(median, min(seconds), max(seconds), first, len(seconds), answer)


def least_on_wall(
    works: dict[str, Callable[[], Any]], n_passes: int
) -> dict[str, tuple[float, Any]]:
    """[s] on the wall, where threads are what is measured: the least of passes in turns, and the last answer."""
    found = {what: (np.inf, work()) for what, work in works.items()}  # warms up
    for _ in range(n_passes):
        for what, work in works.items():
            start = time.perf_counter()
            answer = work()
            found[what] = min(found[what][0], time.perf_counter() - start), answer
    return found


def geometric_mean(ratios: Iterable[float]) -> float:
    """The factor that, in place of each of some ratios of times, would give their product."""
    return float(np.exp(np.log([*ratios]).mean()))


def arguments(about: str, words: Sequence[str] | None, **options: Any) -> argparse.Namespace:
    """The command line of a scenario: its options, by their defaults, and `--csv`.

    Args:
        about: the docstring of the scenario.
        options: a default for each; a list takes several words, of the type of its first; True is a flag.
    """
    kind = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=about, formatter_class=kind)
    for name, default in options.items():
        flag = "--" + name.replace("_", "-")
        if default is True:
            parser.add_argument(flag, action="store_true")
        elif isinstance(default, list | tuple):
            of = type(default[0]) if default else str
            parser.add_argument(flag, nargs="*", type=of, default=[*default])
        else:
            parser.add_argument(flag, type=type(default), default=default)
    parser.add_argument("--csv", type=Path, help="write the rows here")
    return parser.parse_args(words)


def tell(*lines: str) -> None:
    """Prints lines as they are."""
    for line in lines:
        print(line, flush=True)


def show(title: str, rows: Sequence[Row], columns: Sequence[str] = ()) -> None:
    """Prints rows as a table: some columns, or all of the first row."""
    if not rows:
        return
    chosen = columns or tuple(rows[0])
    table = Table(title=title, title_justify="left", title_style="bold")
    for name in chosen:
        is_text = isinstance(next((row[name] for row in rows if name in row), ""), str)
        table.add_column(name.replace("_", " "), justify="left" if is_text else "right")
    for row in rows:
        table.add_row(*(_cell(row.get(name)) for name in chosen))
    Console(width=None if sys.stdout.isatty() else 150, highlight=False).print(table)


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_csv(rows: Sequence[Row], path: Path | None, digits: int = 6) -> None:
    """All rows, numbers to so many digits; makes the folder. Nothing where no file is asked for."""
    if path is None or not rows:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, columns, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow(
                {k: f"{v:.{digits}g}" if isinstance(v, float) else v for k, v in row.items()}
            )


def scenarios() -> dict[str, Any]:
    """The scenarios beside this file, by name."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    names = [path.stem for path in files if "\nSMALLEST = " in path.read_text(encoding="utf-8")]
    return {name: import_module(name) for name in names}


def run_smallest() -> None:
    """Runs the scenarios that the command line names, or all, on their smallest sizes."""
    asked = arguments(__doc__, None, only=[], out="")
    import_module("harness").LEAST_PASS = 0.0  # of the module that scenarios see
    for name, scenario in scenarios().items():
        if not asked.only or name in asked.only:
            rows = scenario.main(scenario.SMALLEST)
            tell(f"scenario {name}: {len(rows)} rows")
            write_csv(rows, Path(asked.out) / f"{name}.csv" if asked.out else None)


if __name__ == "__main__":
    run_smallest()
