"""Builds the library of kernels: `python -m clearance.compile.build`, or the package's build (`build_hook`).

It is built for this machine's level of processor, or for those that are named; `all` names all.

One object file for each kernel and level of processor, named by the hash of what it depends on: only what has
changed is compiled, in as many processes as there are cores. The objects become one shared library for each level;
without a linker they are packed, and llvmlite links them when they are loaded. One process builds at a time; each
file is written under another name and then takes its place, so that what is loaded stays as it is.
"""

from __future__ import annotations

import functools
import importlib
import json
import multiprocessing
import os
import platform
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import AbstractContextManager, suppress
from importlib.util import cache_from_source
from pathlib import Path
from typing import NamedTuple

from filelock import FileLock, Timeout

from clearance.compile.in_process import set_up_compiler
from clearance.compile.library import library_file, processor_level
from clearance.compile.linking import NotLinked, link, linker, pack
from clearance.compile.manifest import FOLDER, Manifest, is_current, say
from clearance.compile.sources import PACKAGE, closure, digest_of, digest_of_sources, modules

LONGEST = 1800
"""[s] After which another process that builds is no longer waited for: it may be stopped."""


class BuildFailed(Exception):
    """The kernels cannot be compiled; the text says why."""


MEMORY_OF_A_WORKER = 3e9
"""[bytes] that a process takes at most, since numba keeps all that it has compiled: 2.8e9 with two processes."""


class Unit(NamedTuple):
    """A kernel to compile: its module, its symbol, the hash of what it depends on."""

    module: str
    symbol: str
    digest: str

    @property
    def file(self) -> str:
        """The name of its object files."""
        return f"{self.symbol}-{self.digest[:16]}.o"


def all_levels() -> tuple[str, ...]:
    """The processors that a wheel is for."""
    if platform.machine() in ("x86_64", "AMD64"):
        return "x86-64-v3", "x86-64-v2"
    return (platform.machine(),)


def units() -> list[Unit]:
    """All kernels of the package, those first that are made of most: they take longest."""
    from clearance.compile import registered

    for module in modules():
        importlib.import_module(module)
    found = [
        Unit(
            kernel.function.__module__,
            kernel.symbol,
            digest_of(kernel.function.__module__),
        )
        for kernel in registered.kernels
        if kernel.function.__module__.startswith("clearance.kernels.")
    ]
    return sorted(found, key=lambda unit: (-len(closure(unit.module)), unit))


def build(levels: Sequence[str]) -> None:
    """Brings the library of these levels up to date, if it is not.

    Raises:
        BuildFailed: a kernel does not compile, or the sources change meanwhile.
    """
    FOLDER.mkdir(exist_ok=True)
    with _alone():
        if is_current(digest_of_sources, levels):
            return
        sources = digest_of_sources()
        _forget_bytecode()
        everything = units()
        for level in levels:
            (FOLDER / level).mkdir(exist_ok=True)
        missing = [unit for unit in everything if not all(map(Path.exists, _files(unit, levels)))]
        if missing:
            _compile_all(missing, levels)
        _drop_others(everything)
        _finish(everything, sources, levels)


def _forget_bytecode() -> None:
    """Removes what Python has kept of the kernels' sources: after two edits within a second it is of the first."""
    for file in (PACKAGE / "kernels").rglob("*.py"):
        with suppress(OSError):
            Path(cache_from_source(str(file))).unlink()


def _alone() -> AbstractContextManager:
    """A lock, taken: the system gives it back when this process ends, however that is."""
    lock = FileLock(FOLDER / "lock", fallback_to_soft=False)
    try:
        return lock.acquire(timeout=0)
    except Timeout:
        say("another process compiles the kernels: waiting for it")
    try:
        return lock.acquire(timeout=LONGEST)
    except Timeout:
        busy = f"another process has held {lock.lock_file} for {LONGEST} s"
        raise BuildFailed(busy) from None


def _files(unit: Unit, levels: Sequence[str]) -> list[Path]:
    return [FOLDER / level / unit.file for level in levels]


def _compile_all(missing: Sequence[Unit], levels: Sequence[str]) -> None:
    begun = time.monotonic()
    n_workers = min(len(missing), _n_workers())
    say(f"compiling {len(missing)} kernels, {n_workers} at a time; this takes minutes")
    with ProcessPoolExecutor(
        n_workers,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_begin,
    ) as pool:
        asked = {pool.submit(_compile, unit, levels): unit for unit in missing}
        try:
            for n_done, done in enumerate(as_completed(asked), 1):
                say(f"{n_done:3} of {len(missing)}: {asked[done].symbol} ({done.result():.1f} s)")
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    say(f"compiled in {time.monotonic() - begun:.0f} s")


def _n_workers() -> int:
    """As many as there are cores, and as fit into the machine's memory."""
    if not hasattr(os, "sched_getaffinity"):
        return os.cpu_count() or 1
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return max(1, min(len(os.sched_getaffinity(0)), int(memory / MEMORY_OF_A_WORKER)))


def _begin() -> None:
    """In a process that compiles: it ends with the one that asks it, however that ends."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    set_up_compiler()
    for module in modules():
        importlib.import_module(module)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _compile(unit: Unit, levels: Sequence[str]) -> float:
    """Seconds of processor time that it took."""
    begun = time.process_time()
    from clearance.compile import registered
    from clearance.compile.compiler import objects_of

    (kernel,) = (each for each in registered.kernels if each.symbol == unit.symbol)
    try:
        made = objects_of(kernel, levels)
    except Exception as error:
        raise BuildFailed(f"{unit.symbol} does not compile: {error}") from None
    if digest_of(unit.module) != unit.digest:  # read again: as it was when this process imported it
        raise BuildFailed("the sources have changed while they were compiled; start again")
    for file, one in zip(_files(unit, levels), made, strict=True):
        _replace(file, lambda draft, one=one: draft.write_bytes(one.content))
    return time.process_time() - begun


def _replace(file: Path, write: Callable[[Path], object]) -> None:
    """Writes a file anew: whoever has the one before keeps it."""
    draft = file.with_name(f"{file.name}.{os.getpid()}")
    write(draft)
    draft.replace(file)


def _drop_others(everything: Sequence[Unit]) -> None:
    wanted = {unit.file for unit in everything}
    for level in all_levels():
        for file in (FOLDER / level).glob("*"):
            if file.name not in wanted:
                file.unlink()


def _finish(everything: Sequence[Unit], sources: str, levels: Sequence[str]) -> None:
    """Makes the libraries of the objects; the manifest, which says so, comes last."""
    from clearance.compile.objects import memory_object

    is_linked = linker() is not None
    sizes = {}
    for level in levels:
        memory = FOLDER / level / "memory.o"
        memory.write_bytes(memory_object(level))
        make = functools.partial(
            link if is_linked else pack,
            [memory, *(FOLDER / level / unit.file for unit in everything)],
        )
        library = library_file(level, is_linked)
        _replace(library, make)
        sizes[library.name] = library.stat().st_size
    built = Manifest(sources, is_linked, sizes)
    manifest = json.dumps(built._asdict(), indent=1) + "\n"
    _replace(FOLDER / "manifest.json", lambda draft: draft.write_text(manifest))


def main(named: Sequence[str]) -> None:
    """Builds for the named levels, and says in one line why that cannot be."""
    unknown = set(named) - {"all", *all_levels()}
    if unknown:
        valid = ", ".join(all_levels())
        sys.exit(f"error: no level of processor is called {min(unknown)!r}; all, {valid} are")
    levels = all_levels() if "all" in named else named or [processor_level()]
    try:
        build(levels)
    except (BuildFailed, NotLinked, OSError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
