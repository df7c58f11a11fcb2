"""Tolerances by name, each with its source: files in `presets`. Not for: what they are of (`block`)."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.formats.preset_files import FOLDER
from clearance.formats.schema.errors import validated
from clearance.formats.schema.strict_model import StrictModel
from clearance.formats.schema.tolerance import Tolerance
from clearance.formats.text.yaml_file import parse_yaml


class _File(StrictModel):
    source: str
    tolerance: Tolerance


@dataclass(frozen=True)
class Preset:
    """Tolerances, and where their numbers come from, in one line."""

    name: str
    source: str
    tolerance: Tolerance


def preset(name: str) -> Preset:
    """The preset of a name, which is there."""
    path = FOLDER / f"{name}.yaml"
    read = validated(_File, parse_yaml(path.read_bytes(), path.name), path.name)
    return Preset(name, " ".join(read.source.split()), read.tolerance)
