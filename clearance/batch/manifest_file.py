"""A batch's manifest: which cases, or which trajectories in one cell, and what is asked of all of them.

Lengths in metres, as in a case file. Not for: finding the files (`batch.manifest`).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from clearance.errors import BadBatch, MissingKey, at
from clearance.formats.files.input_files import read_bytes
from clearance.formats.schema.strict_model import Name, StrictModel, validated
from clearance.formats.schema.timed import TrajectoryFile
from clearance.options import FILE, SWITCH, made, options_in
from clearance.plain_yaml import parse_yaml
from clearance.run.options import CheckOptions

_KEYS = re.compile(rb"^(cases|cell|trajectories)\s*:", re.MULTILINE)
"""A key at the start of a line that manifests have and case files do not."""

_LEVELS = ("fail", "warn")
"""Options that stand under `limits`."""


def _listed(data: Any) -> Any:
    return [data] if isinstance(data, str) else data


Files = Annotated[list[Name], BeforeValidator(_listed), Field(min_length=1)]
"""Paths or patterns (`*`, `?`, `**`), one or a list."""


class TrajectoryOptions(TrajectoryFile):
    """How every trajectory is read and followed: as `trajectory` of a case file, but without `file`."""

    @model_validator(mode="before")
    @classmethod
    def _without_file(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        if "file" in data:
            raise BadBatch("a file is given", where="file", valid="the files under trajectories")
        return {"file": "-", **data}


class Manifest(StrictModel):
    """The keys of a manifest that say which cases: `cases`, or `cell` and `trajectories`, or both.

    The others are options (`said_in`).
    """

    name: Name | None = None
    cases: Files | None = None
    cell: Name | None = None
    trajectories: Files | None = None
    read_as: TrajectoryOptions | None = None
    robot: Name | None = None

    @classmethod
    def keys(cls) -> tuple[str, ...]:
        """The keys of a whole manifest."""
        return (*super().keys(), *_option_keys())

    @model_validator(mode="after")
    def _complete(self) -> Manifest:
        if (self.cell is None) != (self.trajectories is None):
            missing = "trajectories" if self.trajectories is None else "cell"
            raise MissingKey(f"{missing!r} is missing", valid="cell and trajectories, together")
        if self.cases is None and self.cell is None:
            raise MissingKey("nothing to check", valid="cases, or cell and trajectories")
        for key in ("robot", "read_as"):
            if self.cell is None and getattr(self, key) is not None:
                raise BadBatch("there is no cell", where=key, valid="cell and trajectories")
        return self


class _Levels(StrictModel):
    """Limits instead of those of the cases; rules that give their own keep them."""

    fail: Any = None
    warn: Any = None


def _option_keys() -> dict[str, str]:
    """The keys that are options, with the option that each is of."""
    known = {name: one for name, one in options_in(CheckOptions).items() if one.said}
    found = {one.off or name: name for name, one in known.items() if name not in _LEVELS}
    return {"limits": "", **found}


def _spelled(name: str, value: object) -> str:
    """A key, with its value as YAML has it."""
    off = options_in(CheckOptions)[name].off
    key = off or ("limits." + name if name in _LEVELS else name)
    if value is None:
        return key
    shown = not value if off else value
    return f"{key}: {str(shown).lower() if isinstance(shown, bool) else shown}"


def is_manifest(data: bytes) -> bool:
    """True if a file's content is meant as a manifest, not as a case."""
    return _KEYS.search(data) is not None


def load_manifest(path: Path) -> tuple[Manifest, dict[str, Any]]:
    """The cases that a manifest names, and the options that it says; paths of files absolute.

    Raises:
        BadInput: with the file and the field.
    """
    shown = path.name
    return manifest_of(parse_yaml(read_bytes(path, shown), shown), path)


def manifest_of(raw: object, path: Path) -> tuple[Manifest, dict[str, Any]]:
    """The same of the plain data in a manifest at `path`."""
    if not isinstance(raw, dict):
        return validated(Manifest, raw, path.name), {}
    keys = _option_keys()
    rest = {key: one for key, one in raw.items() if key not in keys}
    manifest = validated(Manifest, rest, path.name)
    with at(path.name):
        said: dict[str, Any] = {}
        for key in keys:
            if key in raw:
                said |= _said(key, raw[key])
        asked = made(CheckOptions, said, _spelled)
        return manifest, {name: _from_there(name, getattr(asked, name), path) for name in said}


def _said(key: str, value: Any) -> dict[str, Any]:
    """The options that a key says."""
    if value is None:
        raise BadBatch("nothing is given", where=key, valid="a value; else leave the key out")
    if key == "limits":
        levels = validated(_Levels, value, key)
        return {name: getattr(levels, name) for name in levels.model_fields_set}
    name = _option_keys()[key]
    if name == key:
        return {name: value}
    with at(key):
        return {name: not SWITCH.checked(value)}


def _from_there(name: str, value: Any, path: Path) -> Any:
    """The value of an option; of one that names files, as seen from the folder of a manifest."""
    if not options_in(CheckOptions)[name].is_of_files:
        return value
    with at(name):
        if isinstance(value, tuple):
            return tuple(path.absolute().parent / FILE.checked(one) for one in value)
        return path.absolute().parent / FILE.checked(value)
