"""Tolerances that are given beside a case: a file, or plain data. Not for: what they mean (`block`)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from clearance.case.tolerance.block import budget_of
from clearance.case.tolerance.checks import require_numbers, require_there
from clearance.errors import BadInput, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.errors import validated
from clearance.formats.schema.tolerance import Tolerance
from clearance.formats.text.yaml_file import parse_yaml
from clearance.world.budget import Budget
from clearance.world.case import Case

KEY = "tolerance"
"""The key of the block in a case; a file may begin with it."""


def with_tolerance(case: Case, given: Budget | Mapping[str, Any] | str | PathLike[str]) -> Case:
    """The case with other tolerances in place of its own, which a note says.

    Args:
        given: a budget, the block of a case file as plain data, or the path of a YAML file with it. Files in plain
            data are looked up from the current folder, those in a file from the folder of that.

    Raises:
        BadInput: with the field and the file.
    """
    if isinstance(given, Budget):
        with at(KEY):
            require_there(given, case)
            require_numbers(given, case)
        return _replaced(case, given, "tolerances that were given")
    if isinstance(given, str | PathLike):
        return _with_file(case, Path(given))
    if not isinstance(given, Mapping):
        raise BadInput(
            f"tolerances are {given!r:.60}", valid="a mapping, the path of a file, or a Budget"
        )
    files = InputFiles(Path.cwd())
    budget = _budget(dict(given), KEY, case, files)
    return _with_sources(_replaced(case, budget, "tolerances that were given"), files)


def tolerance_digest(path: Path) -> str:
    """sha256 of a file of tolerances and of the file of controllers that it names, if it names one.

    Raises:
        BadInput: with the field and the file; what only a case can tell is not looked at.
    """
    files = InputFiles(path.parent)
    block, place = _block(path, files)
    if block.tracking is not None and block.tracking.file is not None:
        with at(f"{place}: tracking.file"):
            files.read(path.parent / block.tracking.file)
    told = [(source.path, source.sha256) for source in files.sources]
    return hashlib.sha256(repr(told).encode()).hexdigest()


def _with_file(case: Case, path: Path) -> Case:
    files = InputFiles(path.parent)
    block, place = _block(path, files)
    with at(place):
        budget = budget_of(block, case, files.folder, files)
    return _with_sources(_replaced(case, budget, f"tolerances of {files.shown(path)}"), files)


def _block(path: Path, files: InputFiles) -> tuple[Tolerance, str]:
    """The block in a file, and how messages call it."""
    shown = files.shown(path)
    raw = parse_yaml(files.read(path), shown)
    inside = isinstance(raw, dict) and list(raw) == [KEY]
    place = f"{shown}: {KEY}" if inside else shown
    return validated(Tolerance, raw[KEY] if inside else raw, place), place  # type: ignore[index]


def _budget(raw: object, place: str, case: Case, files: InputFiles) -> Budget:
    block = validated(Tolerance, raw, place)
    with at(place):
        return budget_of(block, case, files.folder, files)


def _replaced(case: Case, budget: Budget, what: str) -> Case:
    """The case with a budget; a note says so where it had another."""
    notes = case.notes
    if case.tolerance is not None:
        notes = (*notes, f"{what} take the place of the case's own")
    return replace(case, tolerance=budget, notes=notes)


def _with_sources(case: Case, files: InputFiles) -> Case:
    found = {source.path: source for source in case.sources}
    found |= {source.path: source for source in files.sources}
    return replace(case, sources=tuple(found[path] for path in sorted(found)))
