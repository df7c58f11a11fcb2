"""Measures how often, how fast and by how little violated cases are mended, against a general optimiser and Drake.

    python scripts/bench/gain.py [--part ours|general|drake] [--cases N] [--made DIR] [--journals DIR]
    python scripts/bench/gain.py --summary

One process, one thread, compiled code warm; seconds of CPU. Each proposal is written as files, read and certified
anew, `--commands` of them by `clearance check` in a process of its own. "known" is a change that is known to do.
Rows go to a journal for each part, and what is in it is not done again, so that a part may be stopped and taken
up. The other parts take cases that ours keeps, as ours go on.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from itertools import islice
from pathlib import Path

import inputs  # first: it sets the number of threads before numpy is loaded
from gain_cases import KINDS, bent_paths, intervals_of, violated_cases
from gain_drake import drake_path, has_drake, takes
from gain_files import CaseOnDisk, cases_in, kept_afresh, kept_by_command, write_proposal
from gain_general import STARTS, general_change
from gain_journal import Journal, Row
from gain_summary import line_of, print_summary
from rich.console import Console

import clearance as cl
from clearance.gains.answer import gain
from clearance.world.case import Case, index_of_robot

COLUMNS = {
    "ours": (
        "case", "source", "how", "kind", "who", "steps", "joints", "kept", "size", "known", "lower_bound",
        "seconds", "measured", "intervals", "checked", "by", "blocked",
    ),
    "general": ("case", "intervals", "size", "seconds", "given", "starts", "between"),
    "drake": ("case", "intervals", "size", "seconds", "given", "sampled", "proven", "convex"),
}  # fmt: skip

RESULTS = Path(__file__).parent / "results" / "gain.csv"


def ours(cases: list[CaseOnDisk], journal: Journal, asked: argparse.Namespace) -> None:
    """Mends the cases that are not in the journal, or are asked for again."""
    every = max(1, len(cases) // max(1, asked.commands))
    robot = str(cl.load_case(cases[0].file).robots[0].robot.name)
    gain(cl.load_case(cases[0].file), "base", robot=robot)  # compiled code is warm
    for number, one in enumerate(cases):
        if number in asked.again or (not asked.again and not _is_done(journal, number, one)):
            row = {"case": number, **_ours_of(one, by_command=number % every == 0)}
            journal.add(row)
            print(line_of(row), flush=True)


def general(cases: list[CaseOnDisk], journal: Journal, asked: argparse.Namespace) -> None:
    """So many cases of some kinds, of those that ours has kept by now, by the general optimiser."""
    for kind in asked.kinds:
        kept = [row for row in _ours_by_now(asked, kind) if row["kept"]]
        for row in kept[: asked.n]:
            done = journal.rows.get(int(row["case"]))
            if not _is_same(done, row) or not _is_over(done, asked.seconds):
                found = general_change(
                    cases[int(row["case"])], int(row["intervals"]), asked.seconds
                )
                _note(journal, row, asked, vars(found))


def drake(cases: list[CaseOnDisk], journal: Journal, asked: argparse.Namespace) -> None:
    """So many paths by Drake, of those that it takes."""
    if not has_drake():
        raise SystemExit("Drake is not installed: pip install 'clearance[bench]'")
    paths = _ours_by_now(asked, "waypoints")
    taken = (row for row in paths if takes(cl.load_case(cases[int(row["case"])].file)))
    for row in islice(taken, asked.n):
        if not _is_same(journal.rows.get(int(row["case"])), row):
            found = drake_path(cases[int(row["case"])], int(row["intervals"]), asked.seconds)
            _note(journal, row, asked, vars(found))


def _ours_by_now(asked: argparse.Namespace, kind: str) -> list[Row]:
    return [
        row
        for row in Journal(asked.csv, COLUMNS["ours"])
        if row["kind"] == kind and row["case"] < asked.cases
    ]


def _is_same(done: Row | None, row: Row) -> bool:
    """Whether a row is there, on the splines that ours is on."""
    return done is not None and done["intervals"] == row["intervals"]


def _is_over(done: Row, seconds: float) -> bool:
    """Whether so many seconds would come to no more: as many were given, or all searches came to an end."""
    return bool(done["given"] >= seconds or done["starts"] == STARTS)


def _note(journal: Journal, row: Row, asked: argparse.Namespace, found: Row) -> None:
    own = {"case": int(row["case"]), "intervals": int(row["intervals"]), "given": asked.seconds}
    journal.add({**own, **found})
    print({**own, **found}, "ours", row["size"], flush=True)


def _is_done(journal: Journal, number: int, one: CaseOnDisk) -> bool:
    """Whether the journal has a row of it.

    Raises:
        SystemExit: what it has is of another case.
    """
    row = journal.rows.get(number)
    named = ("source", "how", "kind", "who")
    if row is not None and any(row[name] != getattr(one, name) for name in named):
        raise SystemExit(f"{journal.file} is of other cases: {line_of(row)}")
    return row is not None


def _ours_of(one: CaseOnDisk, *, by_command: bool) -> Row:
    """What one case came to, and whether what was proposed holds when it is checked anew."""
    case = cl.load_case(one.file)
    began = time.process_time()
    found = gain(case, one.kind, **one.names)
    seconds = time.process_time() - began
    row: Row = {
        "source": one.source, "how": one.how, "kind": one.kind, "who": one.who, "kept": found.kept,
        "size": found.size, "known": one.known, "lower_bound": found.lower_bound, "seconds": seconds,
        "measured": found.n_measured, "checked": None, "by": None,
        "intervals": intervals_of(case, found), "blocked": str(found.blocked or ""),
    }  # fmt: skip
    row |= dict(zip(("steps", "joints"), _extent(case, one), strict=True))
    if found.kept:
        with tempfile.TemporaryDirectory() as out:
            proposal = write_proposal(found, one.file, Path(out))
            row["by"] = "command" if by_command else "reading"
            row["checked"] = (kept_by_command if by_command else kept_afresh)(proposal)
    return row


def _extent(case: Case, one: CaseOnDisk) -> tuple[int, int]:
    """The steps and joints of a path; of what is shifted the steps of the run, and no joint."""
    if one.kind != "waypoints":
        steps = max(p.trajectory.n_steps for p in case.robots if p.trajectory)
        return steps, 0
    path = case.robots[index_of_robot(case.robots, one.who)].given_trajectory
    return path.n_steps, len(path.joint_names)


def main() -> None:
    """Runs a part, or tells what was run."""
    parts = {"ours": ours, "general": general, "drake": drake}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--part", choices=parts, default="ours")
    parser.add_argument("--summary", action="store_true", help="of the journals")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--sources", nargs="*", default=(), help="names of folders; all of them")
    parser.add_argument("--bent", action="store_true", help="paths bent at joints with room alone")
    parser.add_argument("--made", type=Path, help="where the cases are, or are put")
    parser.add_argument("--csv", type=Path, default=RESULTS, help="of ours; the others beside it")
    parser.add_argument("--again", type=int, nargs="*", default=(), help="only these, of ours")
    parser.add_argument("--commands", type=int, default=30, help="proposals so checked")
    parser.add_argument("--n", type=int, default=10, help="of each kind, by the others")
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=KINDS, help="by the general")
    parser.add_argument("--seconds", type=float, default=600.0, help="of CPU, each, for the others")
    asked = parser.parse_args()
    journals = {part: Journal(_file(asked.csv, part), COLUMNS[part]) for part in parts}
    if asked.summary:
        print_summary(**journals)
        return
    for line in inputs.absent_inputs():
        Console().print(line)
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.made or Path(scratch)
        make = bent_paths if asked.bent else violated_cases
        cases = cases_in(folder, asked.cases, asked.seed, asked.sources, make)
        parts[asked.part](cases, journals[asked.part], asked)


def _file(csv: Path, part: str) -> Path:
    """The journal of a part."""
    return csv if part == "ours" else csv.with_stem(f"{csv.stem}_{part}")


if __name__ == "__main__":
    main()
