"""The files of tolerances that have a name. Not for: reading them (`tolerance.presets`)."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent / "presets"


def preset_names() -> tuple[str, ...]:
    """The names of all presets."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))
