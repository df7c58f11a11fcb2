"""Manifests, case files and patterns to the list of cases of a batch, in order, each with a name of its own.

A pattern that nothing matches is refused; a file that is named and is not there is one case that cannot be read.
Not for: reading cases (`measuring`).
"""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from pathlib import Path

from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.options import CaseOptions
from clearance.batch.shared_waivers import as_shared
from clearance.case.tolerance.tolerance_file import tolerance_digest
from clearance.errors import BadInput, DuplicateName, MissingFile, at
from clearance.formats.files.input_files import read_bytes
from clearance.formats.schema.manifest import (
    Manifest,
    TrajectoryOptions,
    is_manifest,
    load_manifest,
)
from clearance.world.names import checked_name
from clearance.world.waiver import Waiver


@dataclass(frozen=True)
class Changes:
    """What the command line says instead of the manifests; None where it says nothing. Lengths in metres; `today`
    as in `run.Question`; `waivers` beside those of the cases; `tolerance` a file instead of the cases' tolerances.
    """

    need: str | None = None
    certify: bool | None = None
    certify_gap: float | None = None
    fail: float | None = None
    warn: float | None = None
    accept: tuple[str, ...] = ()
    today: date | None = None
    waivers: tuple[Waiver, ...] = ()
    tolerance: Path | None = None


def items_of(arguments: Sequence[str], changes: Changes) -> tuple[Item, ...]:
    """All cases, in the order in which they are given, those of a pattern by name.

    Args:
        arguments: paths or patterns of manifests and of case files.

    Raises:
        BadInput: a manifest that is none, a pattern that nothing matches, two cases of one name, or tolerances
            that are none.
    """
    if changes.certify_gap == 0.0:
        raise BadInput("certify: a gap of 0 m", valid="a length above 0")
    items = _with_tolerance(_once(_given(arguments, changes)), changes.tolerance)
    waived = _waived(items, changes.waivers) if changes.waivers else items
    cases = tuple(replace(item, number=i) for i, item in enumerate(waived))
    _require_own_names(cases)
    return cases


def _given(arguments: Sequence[str], changes: Changes) -> Iterator[Item]:
    """The cases of all manifests, then those that are files of their own."""
    plain: list[str] = []
    for argument in arguments:
        for path in _matching(argument, Path()):
            if _is_manifest(Path(path)):
                yield from _of_manifest(Path(path), changes)
            else:
                plain.append(path)
    options = _options(Manifest.model_construct(), changes)
    yield from _of_cases(plain, _common_folder(plain), "", options)


def _once(items: Iterable[Item]) -> Iterator[Item]:
    """The items without those of which the same was measured already."""
    seen: set[object] = set()
    for item in items:
        same = (item.file, item.trajectory, item.options)
        if same not in seen:
            seen.add(same)
            yield item


def _with_tolerance(items: Iterable[Item], path: Path | None) -> Iterator[Item]:
    """The items with the tolerances of a file, if one is given, in place of their cases'."""
    if path is None:
        yield from items
        return
    place, key = os.path.abspath(path), tolerance_digest(path)
    known: dict[CaseOptions, CaseOptions] = {}
    for item in items:
        made = known.get(item.options)
        if made is None:
            made = replace(item.options, tolerance=place, tolerance_key=key)
            known[item.options] = made
        yield replace(item, options=made)


def _waived(items: Iterable[Item], waivers: Sequence[Waiver]) -> Iterator[Item]:
    """The items with the waivers that may be of them: a change of one is no change of what it is not of."""
    shared = as_shared(waivers)
    known: dict[tuple[CaseOptions, tuple[int, ...]], CaseOptions] = {}
    for item in items:  # the name of a case that is a file of its own is not known yet
        own = tuple(
            i
            for i, one in enumerate(shared)
            if item.trajectory is None or one.is_of_case(item.name)
        )
        if (item.options, own) not in known:
            made = item.options.waived_by(tuple(shared[i] for i in own))
            known[item.options, own] = made
        yield replace(item, options=known[item.options, own])


def _is_manifest(path: Path) -> bool:
    """False for a case file, and for what cannot be read: that is a case which tells why."""
    try:
        return is_manifest(read_bytes(path, path.name))
    except MissingFile:
        return False


def _of_manifest(path: Path, changes: Changes) -> Iterator[Item]:
    given = load_manifest(path)
    with at(path.name):
        options, folder = _options(given, changes), path.absolute().parent
        before = f"{given.name}/" if given.name else ""
        with at("cases"):
            yield from _of_cases(_all_matching(given.cases or [], folder), folder, before, options)
        if given.cell is None:
            return
        cell = os.path.abspath(folder / given.cell)
        reading = _reading(given.read_as)
        with at("trajectories"):
            for one in _all_matching(given.trajectories or [], folder):
                asked = GivenTrajectory(os.path.abspath(one), reading, given.robot)
                yield Item(0, before + _name(one, folder), cell, asked, options)


def _of_cases(
    paths: Iterable[str], folder: Path, before: str, options: CaseOptions
) -> Iterator[Item]:
    for path in paths:
        yield Item(0, before + _name(path, folder), os.path.abspath(path), None, options)


def _options(given: Manifest, changes: Changes) -> CaseOptions:
    """What is asked, of the manifest and the command line, which goes before."""
    usual = CaseOptions()
    certify = not given.samples_only if changes.certify is None else changes.certify
    return CaseOptions(
        need=changes.need or given.need or usual.need,
        certify=certify,
        certify_gap=changes.certify_gap or given.certify_gap or usual.certify_gap,
        fail=given.limits.fail if changes.fail is None else changes.fail,
        warn=given.limits.warn if changes.warn is None else changes.warn,
        accept=tuple(dict.fromkeys([*given.accept, *changes.accept])),
        today=(changes.today or datetime.now(UTC).date()).isoformat(),
    )


def _reading(given: TrajectoryOptions | None) -> str:
    return (given or TrajectoryOptions.model_validate({})).model_dump_json(
        exclude_defaults=True, exclude={"file"}
    )


def _all_matching(patterns: Sequence[str], folder: Path) -> Iterator[str]:
    for pattern in patterns:
        yield from _matching(pattern, folder)


def _matching(pattern: str, folder: Path) -> Iterator[str]:
    """The files of a pattern, by name; of a plain path that path, whether it is there or not.

    Raises:
        MissingFile: nothing matches.
    """
    place = os.path.join(folder, pattern)
    if os.path.exists(place) or not glob.has_magic(pattern):
        yield os.path.normpath(place)
        return
    found = sorted(glob.glob(pattern, root_dir=str(folder), recursive=True))
    if not found:
        raise MissingFile(f"no file matches {pattern!r}", valid="a pattern of files that are there")
    for (
        one
    ) in found:  # a `Path` for each would stay behind in part: Python keeps a table of their names
        yield os.path.normpath(os.path.join(folder, one))


def _name(path: str, folder: Path) -> str:
    """A file's path from a folder, without its suffix."""
    inside = os.path.join(folder, "")
    relative = path[len(inside) :] if path.startswith(inside) else os.path.relpath(path, folder)
    begin, _, name = relative.replace(os.sep, "/").rpartition("/")
    dot = name.rfind(".")
    stem = name[:dot] if 0 < dot < len(name) - 1 else name
    return checked_name(f"{begin}/{stem}" if begin else stem)


def _common_folder(paths: Sequence[str]) -> Path:
    """The folder that all files are in."""
    if not paths:
        return Path()
    return Path(
        os.path.commonpath({os.path.dirname(os.path.join(Path.cwd(), path)) for path in paths})
    )


def _require_own_names(cases: Sequence[Item]) -> None:
    seen: dict[str, Item] = {}
    for item in cases:
        other = seen.setdefault(item.name, item)
        if other is not item:
            files = dict.fromkeys([_file(other), _file(item)])
            told = " and ".join(files) if len(files) > 1 else f"{_file(item)}, asked in two ways"
            raise DuplicateName(
                f"two cases would be called {item.name!r}: {told}",
                valid="a name: in each manifest, which goes before the names of its cases",
            )
    if not cases:
        raise BadInput("no case is given", valid="a manifest, case files, or a pattern of them")


def _file(item: Item) -> str:
    return os.path.relpath(item.file if item.trajectory is None else item.trajectory.path)
