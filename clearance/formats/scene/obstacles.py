"""Obstacles of a case or scene file to solids that stand, ride or move. Not for: their schema, nor whether what
they ride on is there (`case_file`).
"""

from __future__ import annotations

from pathlib import Path

from clearance.errors import at
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.mesh_store import MeshStore
from clearance.formats.schema import obstacle as obstacle_schema
from clearance.formats.text.notes import grouped, note_on_rounded
from clearance.formats.timed_files import pose_table_of
from clearance.geometry.shapes import SHAPES
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.names import require_own_names


def make_obstacles(
    given: list[obstacle_schema.Obstacle], folder: Path, meshes: MeshStore
) -> tuple[tuple[Obstacle, ...], list[str]]:
    """The obstacles in the file's order, and notes on meshes that were mended and on files of poses.

    Args:
        folder: against which files are looked up.

    Raises:
        DuplicateName: two obstacles with one name. BadInput: a shape that no solid can have, a bad
        mesh.
    """
    require_own_names("obstacle", [item.name for item in given])
    obstacles: list[Obstacle] = []
    notes: list[tuple[str, str]] = []
    on_poses: list[str] = []
    for i, item in enumerate(given):
        with at(f"obstacles[{i}]"):
            body, body_notes = _body(item, folder, meshes)
            obstacle, pose_notes = _placed(item, body, folder, meshes.files)
        obstacles.append(obstacle)
        notes += [(body.origin, note) for note in body_notes]
        on_poses += pose_notes
    on_poses += note_on_rounded(sum(item.pose.is_rounded for item in given))
    return tuple(obstacles), [*grouped(notes), *on_poses]


def _placed(
    item: obstacle_schema.Obstacle, body: Body, folder: Path, files: InputFiles
) -> tuple[Obstacle, list[str]]:
    """The body where it stands, or on what it rides, or as it moves; and notes on files of poses."""
    pose, moves, notes = item.pose.matrix(), None, list[str]()
    if item.moves is not None:
        moves, on_moves = pose_table_of(item.moves, folder, files)
        notes += [f"{item.moves.file}: {note}" for note in on_moves]
    if item.on is not None:
        return Obstacle(body, mount=Mount(item.on, pose), moves=moves, padding=item.padding), notes
    return Obstacle(body, pose, moves=moves, padding=item.padding), notes


def _body(
    item: obstacle_schema.Obstacle, folder: Path, meshes: MeshStore
) -> tuple[Body, list[str]]:
    if item.mesh is not None:
        with at("mesh"):
            path = resolved(item.mesh.file, folder)
            asked = item.mesh
            mesh = meshes.load(
                path, asked.factors, asked.collada_up_axis, asked.tolerance_or_default
            )
        shown = meshes.files.shown(path)
        return Body(item.name, mesh.shape, shown), list(mesh.notes)
    if item.points is not None:
        with at("points"):
            path = resolved(item.points.file, folder)
            cloud = meshes.load_points(
                path,
                item.points.radius,
                item.points.factors,
                in_millimetres=item.points.in_millimetres,
            )
        return Body(item.name, cloud.shape, meshes.files.shown(path)), list(cloud.notes)
    with at(item.kind):
        return Body(item.name, SHAPES[item.kind].maker(**item.dimensions), item.kind), []
