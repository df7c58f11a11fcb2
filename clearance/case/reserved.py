"""The outlines of a case that the sweep must keep to: their sketches read and solved, their names checked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.case.allow import require_link_patterns
from clearance.errors import BadShape, DuplicateName, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema import case as schema
from clearance.world.case import ReservedSpace

if TYPE_CHECKING:
    from clearance.sketch import Sketch


def reserved_spaces(
    given: Sequence[schema.Profile], files: InputFiles, links: Iterable[str]
) -> tuple[ReservedSpace, ...]:
    """The outlines of a case file.

    Raises:
        DuplicateName, UnknownLink, MissingFile and what sketches raise; BadShape: a sketch that contradicts
        itself or has an open contour.
    """
    links = tuple(links)
    made: list[ReservedSpace] = []
    for i, entry in enumerate(given):
        with at(f"profiles[{i}]"):
            if entry.name in [space.name for space in made]:
                raise DuplicateName(f"the name {entry.name!r} is taken", where="name")
            with at("links"):
                require_link_patterns(entry.links, links)
            sketch, drift = _sketch(files.resolved(entry.sketch), files)
            made.append(
                ReservedSpace(
                    entry.name,
                    sketch,
                    entry.plane,
                    entry.section,
                    entry.mode,
                    entry.limit,
                    tuple(entry.links),
                    drift,
                )
            )
    return tuple(made)


def _sketch(path: Path, files: InputFiles) -> tuple[Sketch, float]:
    """A solved sketch, and how far it is from where it is drawn [m] though nothing fixes it."""
    from clearance.sketch import Sketch

    with at("sketch"):
        files.read(path)  # remembered with its checksum
        sketch = Sketch.load(path)
        result = sketch.solve()
        with at(files.shown(path)):
            if not result.solved:
                raise BadShape(result.fault)
            if not sketch.curves().is_closed:
                raise BadShape(
                    "an open contour", valid="closed contours, since a region is asked for"
                )
    return sketch, result.drift
