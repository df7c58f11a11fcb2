"""Manifests, case files and patterns to the list of cases of a batch, in order, each with a name of its own.

A pattern that nothing matches is refused; a file that is named and is not there is one case that cannot be read.
Not for: reading cases (`measuring`).
"""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.manifest_file import TrajectoryOptions, is_manifest, load_manifest
from clearance.batch.options import CaseOptions
from clearance.batch.shared_waivers import as_shared
from clearance.case.packed import is_zip
from clearance.case.waiver_file import load_waivers
from clearance.errors import BadBatch, DuplicateName, MissingFile, at
from clearance.formats.files.input_files import read_bytes
from clearance.options import made
from clearance.run import CheckOptions
from clearance.run.options import USUAL
from clearance.world.names import checked_name
from clearance.world.rules import Waiver


class Batch(NamedTuple):
    """All cases of a batch, and the waivers that they share."""

    items: tuple[Item, ...]
    waivers: tuple[Waiver, ...]


def batch_of(arguments: Sequence[str], said: Mapping[str, Any] = {}) -> Batch:
    """All cases, in the order in which they are given, those of a pattern by name.

    Args:
        arguments: paths or patterns of manifests and of case files.
        said: options that go before those of manifests; waivers, and kinds of input to accept, are added.

    Raises:
        BadInput: a manifest that is none, a pattern that nothing matches, two cases of one name, options or files
            that they name that are none.
    """
    shared: dict[Waiver, None] = {}
    items = _waived(_once(_given(arguments, said, shared)))
    cases = tuple(replace(item, number=i) for i, item in enumerate(items))
    _require_own_names(cases)
    return Batch(cases, tuple(shared))


def _given(
    arguments: Sequence[str], said: Mapping[str, Any], shared: dict[Waiver, None]
) -> Iterator[Item]:
    """The cases of all manifests, then those that are files of their own.

    Args:
        shared: takes the waivers that cases share.
    """
    plain: list[str] = []
    for argument in arguments:
        for path in _matching(argument, Path()):
            if _is_manifest(Path(path)):
                yield from _of_manifest(Path(path), said, shared)
            else:
                plain.append(path)
    options = _options({}, said, shared)
    yield from _of_cases(plain, _common_folder(plain), "", options)


def _once(items: Iterable[Item]) -> Iterator[Item]:
    """The items without those of which the same was measured already."""
    seen: set[object] = set()
    for item in items:
        same = (item.file, item.trajectory, item.options)
        if same not in seen:
            seen.add(same)
            yield item


def _waived(items: Iterable[Item]) -> Iterator[Item]:
    """The items with those of their waivers that may be of them: a change of one is no change of what it is not
    of.
    """
    known: dict[tuple[CaseOptions, tuple[Waiver, ...]], CaseOptions] = {}
    for item in items:
        given: Any = item.options.asked.waivers
        own = given  # the name of a case that is a file of its own is not known yet
        if item.trajectory is not None:
            own = tuple(one for one in given if one.is_of_case(item.name))
        if (item.options, own) not in known:
            known[item.options, own] = item.options.waived_by(own) if given else item.options
        yield replace(item, options=known[item.options, own])


def _is_manifest(path: Path) -> bool:
    """False for a case file, packed too, and for what cannot be read: that is a case which tells why."""
    try:
        return not is_zip(path) and is_manifest(read_bytes(path, path.name))
    except MissingFile:
        return False


def _of_manifest(path: Path, said: Mapping[str, Any], shared: dict[Waiver, None]) -> Iterator[Item]:
    given, own = load_manifest(path)
    with at(path.name):
        options, folder = _options(own, said, shared), path.absolute().parent
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


def _options(
    own: Mapping[str, Any], said: Mapping[str, Any], shared: dict[Waiver, None]
) -> CaseOptions:
    """What is asked, of a manifest and of the command line, which goes before."""
    added = {name: (*own.get(name, ()), *said.get(name, ())) for name in ("accept", "waivers")}
    asked = made(CheckOptions, {"today": datetime.now(UTC).date(), **USUAL, **own, **said, **added})
    asked = replace(asked, **{name: _absolute(getattr(asked, name)) for name in _FILES})
    waivers = as_shared(_read(asked.waivers))
    shared.update(dict.fromkeys(waivers))
    return CaseOptions.of(replace(asked, waivers=waivers))


_FILES = ("tolerance", "recorded")


def _absolute(path: Any) -> Any:
    return path.absolute() if isinstance(path, Path) else path


def _read(waivers: Iterable[Waiver | str | PathLike[str]]) -> Iterator[Waiver]:
    """Waivers, those of files among them."""
    for one in waivers:
        yield from [one] if isinstance(one, Waiver) else load_waivers(Path(one))


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
        raise MissingFile(f"no file matches {pattern!r}", valid="a pattern that matches files")
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
            where = " and ".join(files) if len(files) > 1 else f"{_file(item)}, asked in two ways"
            raise DuplicateName(
                f"two cases would be called {item.name!r}: {where}",
                valid="a name: in each manifest, which goes before the names of its cases",
            )
    if not cases:
        raise BadBatch("no case is given", valid="a manifest, case files, or a pattern of them")


def _file(item: Item) -> str:
    return os.path.relpath(item.file if item.trajectory is None else item.trajectory.path)
