"""Where several processes test at once with an empty cache, each kernel is compiled by one of them.

Each begins with small questions to domains of its own (`lane_of_domains`) and to the command line (`rehearsal`),
before it collects; who comes later to a kernel that another one is compiling waits and takes it from the cache.
Without this all of them compile the same kernels at the same time, first those that test modules need when they
are imported. Not for: processes that tests start.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TypeVar

import pytest
from filelock import FileLock

from tests.guards import ALONE

Item = TypeVar("Item")

MAIN_KERNELS = {
    "search": "search.body_pair.search",
    "sweep": "motion.sweep.sweep",
    "certify": "motion.certify._certify",
    "polytope": "polytope.clip.cut_by_bodies",
    "hausdorff": "hausdorff.both_directions.both_directions",
}
"""Of each domain a kernel that is kept once the domain is compiled; neighbours have most in common."""

QUESTIONS = {
    "tolerances": "budget.sweep.budget_moments",
    "two robots on two clocks": "motion.unsynchronised.certify_unsynchronised",
}
"""Questions of `clearance compile` that need much beside the domains, and a kernel of each in the same way."""


def share_of_list(items: Sequence[Item], i: int, n: int) -> Sequence[Item]:
    """The part of a list, in one piece, that is for process `i` of `n`."""
    return items[i * len(items) // n : (i + 1) * len(items) // n]


def spread(files: Sequence[Path]) -> list[Path]:
    """The files, those of each folder spread evenly over the whole; each folder's first one comes early."""
    folders: dict[Path, list[Path]] = {}
    for file in files:
        folders.setdefault(file.parent, []).append(file)
    places = {f: i / len(own) for own in folders.values() for i, f in enumerate(own)}
    return sorted(files, key=places.__getitem__)


def compile_share(i: int, n: int) -> None:
    """Compiles what process `i` of `n` begins with, as far as it is not kept."""
    missing = [domain for domain in share_of_list(list(MAIN_KERNELS), i, n) if not is_kept(domain)]
    if missing:
        from tests.query.lane_of_domains import DOMAINS

        for domain in missing:
            DOMAINS[domain]()
    for question in share_of_list(list(QUESTIONS), i, n):
        if not is_kept(question):
            ask(question)


def ask(question: str) -> None:
    """Asks one of the questions of `clearance compile`, in this process alone."""
    from clearance.cli import compile_kernels, rehearsal

    (call,) = (one for one in rehearsal.THE_REST if one.about == question)
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv(ALONE, "1")
        compile_kernels._ask([call])


def is_kept(asked: str) -> bool:
    """True if the main kernel of a domain or a question lies compiled in the cache."""
    module, _, name = (MAIN_KERNELS | QUESTIONS)[asked].rpartition(".")
    return getattr(import_module(f"clearance.kernels.{module}"), name).kept.holds_any()


def turns_beside(temporary: Path) -> Path:
    """Where the processes of one session take turns, each given its own temporary folder in that of the session.

    pytest takes the session's away, with those of sessions that were killed, when some later ones have begun.
    """
    folder = temporary.with_name("turns")
    folder.mkdir(exist_ok=True)
    return folder


def in_turns(compile_it: Callable, folder: Path) -> Callable:
    """`Kernel.compile` that at each time one process calls for a kernel; the others find it in the cache then.

    Kernels that tests make have no turns: nobody else compiles them. What is compiled on the way has none of its
    own either: who waits holds nothing that another one waits for.
    """
    inside = threading.local()

    def compile_in_turn(kernel, signature):
        is_shared = kernel.py_func.__module__.startswith("clearance.kernels.")
        if getattr(inside, "is_so", False) or not is_shared:
            return compile_it(kernel, signature)
        inside.is_so = True
        try:
            with FileLock(folder / f"{kernel.py_func.__module__}.{kernel.py_func.__qualname__}"):
                return compile_it(kernel, signature)
        finally:
            inside.is_so = False

    return compile_in_turn
