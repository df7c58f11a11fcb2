"""A shared workspace as a folder: the region as STL and GLB, a picture, the figures as JSON."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from clearance.files import fill_folder
from clearance.formats.mesh.mesh_file import mesh_file
from clearance.record.workspace import Workspace
from clearance.report.summary import json_text
from clearance.report.withdrawn import older_name, withdraw_file
from clearance.report.workspace_picture import picture_of

MESHES = {"workspace.stl": "stl", "workspace.glb": "glb"}
ANSWER = ("workspace.json", "workspace.svg")
"""What says how much is shared, if anything."""

OWN = (*ANSWER, *(older_name(Path(name)).name for name in ANSWER), *MESHES)
"""All files that it can have."""

SCHEMA = "urn:clearance:workspace:1"
"""The name of the JSON Schema, which `clearance schema --results workspace` prints."""


def workspace_summary(workspace: Workspace) -> dict[str, Any]:
    """The figures as JSON-ready values: lengths in metres, volume in cubic metres."""
    region = workspace.region
    return {
        "$schema": SCHEMA,
        "robots": list(workspace.names),
        "volume": workspace.volume,
        "volume_is": "upper bound",
        "centroid": None if region.is_empty else region.centroid.tolist(),
        "bounding_box": None
        if region.is_empty
        else [region.vertices.min(axis=0).tolist(), region.vertices.max(axis=0).tolist()],
        "links": [asdict(pair) for pair in workspace.links],
        "n_pieces": list(workspace.n_pieces),
        "within": workspace.within,
        "leaves": workspace.leaves,
        "excluded": list(workspace.excluded),
        "without": workspace.uncounted,
        "not_counted": [list(pair) for pair in workspace.carried],
        "triangles": len(region.triangles),
    }


def withdraw_workspace(folder: Path) -> None:
    """Gives figures and picture in a folder the names of older ones, if they are there.

    Raises:
        Unwritable: they cannot have other names.
    """
    for name in ANSWER:
        withdraw_file(folder / name)


def write_workspace(workspace: Workspace, folder: Path) -> None:
    """Writes `workspace.svg`, `workspace.json` and, where a region is shared, `workspace.stl` and `.glb`.

    Raises:
        Unwritable: `folder` cannot be written.
    """
    region = workspace.region

    def fill(place: Path) -> None:
        if not region.is_empty:
            for name, kind in MESHES.items():
                (place / name).write_bytes(mesh_file(region.vertices, region.triangles, kind))
        (place / "workspace.svg").write_text(picture_of(workspace), encoding="utf-8")
        (place / "workspace.json").write_text(
            json_text(workspace_summary(workspace)), encoding="utf-8"
        )

    fill_folder(folder, fill, OWN)
