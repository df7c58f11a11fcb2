"""The schema of a batch's manifest: which cases, or which trajectories in one cell, and what is asked of all of
them.

Lengths in metres, as in a case file. Not for: finding the files (`batch.manifest`).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from clearance.errors import BadInput, MissingKey
from clearance.formats.files.input_files import read_bytes
from clearance.formats.schema.case import Kind
from clearance.formats.schema.pose import TrajectoryFile
from clearance.formats.schema.strict_model import Level, Name, StrictModel, validated
from clearance.formats.text.yaml_file import parse_yaml

_KEYS = re.compile(rb"^(cases|cell|trajectories)\s*:", re.MULTILINE)
"""A key at the start of a line that manifests have and case files do not."""


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
            raise BadInput("a file is given", where="file", valid="the files under trajectories")
        return {"file": "-", **data}


class Levels(StrictModel):
    """Limits instead of those of the cases; rules that give their own keep them."""

    FILLED = frozenset({"fail", "warn"})

    fail: Level | None = None
    warn: Level | None = None


class Manifest(StrictModel):
    """A whole manifest: `cases`, or `cell` and `trajectories`, or both."""

    FILLED = frozenset({"name", "cases", "cell", "trajectories", "robot", "read_as", "limits"})

    name: Name | None = None
    cases: Files | None = None
    cell: Name | None = None
    trajectories: Files | None = None
    read_as: TrajectoryOptions | None = None
    robot: Name | None = None
    need: Literal["steps", "limit", "minimum"] | None = None
    samples_only: bool | None = None
    certify_gap: Annotated[float | None, Field(gt=0)] = None
    limits: Levels = Levels()
    accept: list[Kind] = []

    @model_validator(mode="after")
    def _complete(self) -> Manifest:
        if (self.cell is None) != (self.trajectories is None):
            missing = "trajectories" if self.trajectories is None else "cell"
            raise MissingKey(f"{missing!r} is missing", valid="cell and trajectories, together")
        if self.cases is None and self.cell is None:
            raise MissingKey("nothing to check", valid="cases, or cell and trajectories")
        for key in ("robot", "read_as"):
            if self.cell is None and getattr(self, key) is not None:
                raise BadInput("there is no cell", where=key, valid="cell and trajectories")
        if self.samples_only and self.certify_gap is not None:
            raise BadInput(
                "samples_only proves nothing", where="certify_gap", valid="one of the two"
            )
        return self


def is_manifest(data: bytes) -> bool:
    """True if a file's content is meant as a manifest, not as a case."""
    return _KEYS.search(data) is not None


def load_manifest(path: Path) -> Manifest:
    """The checked content of a manifest.

    Raises:
        BadInput: with the file and the field.
    """
    shown = path.name
    return validated(Manifest, parse_yaml(read_bytes(path, shown), shown), shown)
