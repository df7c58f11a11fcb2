"""Files of scans to clouds of points. Not for: surfaces (`mesh.mesh_file`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import BadShape, BadSyntax, EmptyMesh, at
from clearance.formats.files.input_files import read_bytes
from clearance.formats.known_formats import Kind, format_of, function_at, suffixes_read
from clearance.formats.mesh.ply_file import elements_of, vertices
from clearance.formats.mesh.triangles import COUNTED, on_rounding, rounded_by, scaled_points
from clearance.geometry.point_cloud import MOST_POINTS, PointCloud


class Points(NamedTuple):
    """Points of a scan.

    Attributes:
        places: (n, 3) in the file's unit; NaN or infinity where a beam did not come back.
        notes: what reading had to decide, one line each.
        in_metres: True if the file names its units, so that the places are in metres.
    """

    places: np.ndarray
    notes: tuple[str, ...] = ()
    in_metres: bool = False


def read_ply_points(data: bytes) -> Points:
    """The vertices of a PLY file, as points of a scan; faces are passed over.

    Raises:
        BadSyntax, MissingKey: as `read_ply`.
    """
    elements = elements_of(data)
    faces = [name for name in ("face", "tristrips") if name in elements and elements[name].n_rows]
    notes = ("its faces are passed over: only the vertices are taken",) if faces else ()
    return Points(vertices(elements), notes)


@dataclass(frozen=True, eq=False)
class LoadedCloud:
    """A cloud from a file.

    Attributes:
        shape: in metres, in the file's frame, scaled.
        notes: what was left out or decided, one line each, without the file's name.
    """

    shape: PointCloud
    notes: tuple[str, ...]


def read_points(
    path: str | PathLike[str], radius: float, scale: float | Sequence[float] = 1.0
) -> PointCloud:
    """The cloud in a file of points (`.pcd`, `.ply`, `.csv`, `.xyz`, `.txt`, `.asc`).

    Args:
        radius: [m] of the ball that each point stands for.
        scale: factor of the coordinates, of all axes or of each; 0.001 for a file in millimetres.

    Raises:
        MissingFile, BadSyntax, BadShape, EmptyMesh, BadDimension: with the file's name.
    """
    path = Path(path)
    return cloud_from_bytes(read_bytes(path, path.name), path.name, radius, scale).shape


def cloud_from_bytes(
    data: bytes,
    name: str,
    radius: float,
    scale: float | Sequence[float] = 1.0,
    *,
    in_millimetres: bool = False,
) -> LoadedCloud:
    """The cloud in the content of a file; `name` gives the format and stands in errors.

    Args:
        in_millimetres: True if coordinates are that name no unit themselves.
    """
    with at(name):
        known = format_of(Kind.CLOUD, name)
        if known is None:
            suffix, valid = Path(name).suffix.lower(), ", ".join(suffixes_read(Kind.CLOUD))
            raise BadSyntax(f"unknown format of points {suffix!r}", valid=valid)
        found: Points = function_at(known.read)(data)
        places, notes = _returned(found.places)
        rounded, places = rounded_by(places), places.astype(np.float64)
        if len(places) > MOST_POINTS:
            raise BadShape(f"the file has {len(places):,} points", valid=f"{MOST_POINTS:,} at most")
        if in_millimetres and not found.in_metres:
            places, rounded = places / 1000.0, rounded / 1000.0
        points, factors = scaled_points(places, scale)
        rounded *= float(np.abs(factors).max())
        shape = PointCloud(points, radius + (rounded if rounded > COUNTED else 0.0))
        n_copies = len(places) - shape.n_points
        if n_copies:
            notes.append(f"{n_copies:,} of its points are there more than once and count once")
        notes += on_rounding(rounded, "is added to the radius of its balls")
        return LoadedCloud(shape, (*found.notes, *notes))


def _returned(places: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """The points that are finite, and a note on others: beams that did not come back."""
    finite = np.isfinite(places).all(axis=1)
    n_left_out = int(np.count_nonzero(~finite))
    if n_left_out == len(places):
        raise EmptyMesh(
            f"none of the {len(places)} points is finite" if len(places) else "there are no points",
            valid="at least one point",
        )
    if not n_left_out:
        return places, []
    what = "1 point is" if n_left_out == 1 else f"{n_left_out:,} points are"
    return places[finite], [f"{what} not finite (no return) and left out, of {len(places):,}"]
