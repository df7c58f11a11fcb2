"""One row for each kind of file that is read: a small valid file, what reads it, and how its structure is damaged.

A new format is a row here; `tests/formats/test_damaged_files.py` holds the table of formats
against these rows. Not for: damaging (`campaign`, `trees`, `markup`, `lines`, `bytes`).
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.batch.manifest_file import load_manifest
from clearance.case.waiver_file import load_waivers
from clearance.findings.findings_file import read_findings
from clearance.formats.known_formats import Kind
from clearance.planar.curve_file import read_curve
from clearance.planar.dxf import read_dxf
from clearance.profiles.outline_file import read_outline
from clearance.sketch import Sketch
from tests.formats.damaged import cases, reading, texts
from tests.formats.damaged import meshes as shapes
from tests.formats.damaged.bytes import Damage, after_header, glb_damaged, parts_damaged
from tests.formats.damaged.cases import bag, bag_metadata, states
from tests.formats.damaged.lines import lines_damaged, table_damaged
from tests.formats.damaged.markup import xml_damaged
from tests.formats.damaged.reading import by_path
from tests.formats.damaged.trees import json_damaged, yaml_damaged
from tests.formats.making import CUBE, CUBE_TRIANGLES, cube_stl, text_stl
from tests.formats.making_clouds import pcd, ply, table
from tests.formats.making_meshes import binary_ply, off, text_ply
from tests.formats.making_moveit import FIRST, SECOND
from tests.formats.making_octree import octree
from tests.formats.making_step import cylinder_step

CELLS = {(0, 0, 0): True, (1, 0, 0): True, (0, -1, 2): False, (-9, 4, 4): True}
SKETCH = Path(__file__).parents[3] / "scenes" / "sketches" / "d_cell.yaml"
STL_TEXT = text_stl(CUBE[CUBE_TRIANGLES]).removesuffix(b" made by a vertex test\n")
RUN = "rosbag2 sqlite3"
POINTS = np.concatenate([CUBE, [[np.nan] * 3]])


class Reader(NamedTuple):
    """What is read.

    Attributes:
        name: of the file. valid: its content.
        reads: reads a content, in a folder that it may write into, under a name.
        damage: another content, of which the structure is damaged in ways that a `Random` draws.
        kind: of the rows in `known_formats` that it is for; None where its format is in no row.
        also: other suffixes that are read as this one is.
    """

    name: str
    valid: bytes
    reads: reading.Read
    damage: Damage
    kind: Kind | None = None
    also: tuple[str, ...] = ()

    def read(self, data: bytes, folder: Path) -> object:
        """What is read of a content."""
        return self.reads(data, folder, self.name)


def readers() -> dict[str, Reader]:
    """Every reader by the kind of file that it reads."""
    parts = _meshes, _scans, _drawings, _robots, _scenes, _motions, _programs, _bags, _others
    return {kind: reader for part in parts for kind, reader in part().items()}


def _meshes() -> dict[str, Reader]:
    pieces, words, text = parts_damaged, lines_damaged, after_header(b"end_header")
    read, where, tree = reading.mesh, Kind.MESH, after_header(b"data")
    return {
        "STL binary": Reader("m.stl", cube_stl(), read, pieces, where),
        "STL text": Reader("m.stl", STL_TEXT, read, words, where),
        "OBJ": Reader("m.obj", shapes.obj(), read, words, where),
        "COLLADA": Reader("m.dae", shapes.collada(), read, xml_damaged, where),
        "PLY text": Reader("m.ply", text_ply(), read, words, where),
        "PLY binary": Reader("m.ply", binary_ply(), read, text, where),
        "OFF": Reader("m.off", off(), read, words, where),
        "GLB": Reader("m.glb", shapes.glb(), read, glb_damaged, where),
        "STEP": Reader("m.step", cylinder_step().encode(), read, words, where, (".stp",)),
        "octomap binary": Reader("m.bt", octree(CELLS), read, tree, where),
        "octomap full": Reader("m.ot", octree(CELLS, full=True), read, tree, where),
    }


def _scans() -> dict[str, Reader]:
    read, where, body = reading.points, Kind.CLOUD, after_header(b"DATA")
    in_mm, plain = table(POINTS, ",", "x [mm],y [mm],z [mm]"), table(POINTS, " ", "")
    return {
        "PCD ascii": Reader("s.pcd", pcd(POINTS, "ascii"), read, lines_damaged, where),
        "PCD binary": Reader("s.pcd", pcd(POINTS, "binary"), read, body, where),
        "PCD compressed": Reader("s.pcd", pcd(POINTS, "binary_compressed"), read, body, where),
        "points PLY": Reader("s.ply", ply(POINTS), read, after_header(b"end_header"), where),
        "points CSV": Reader("s.csv", in_mm, read, table_damaged, where),
        "points XYZ": Reader("s.xyz", plain, read, table_damaged, where, (".txt", ".asc")),
    }


def _drawings() -> dict[str, Reader]:
    sketch = SKETCH.read_bytes()
    return {
        "DXF": Reader("d.dxf", shapes.dxf(), by_path(read_dxf), lines_damaged),
        "curves": Reader("c.yaml", texts.CURVES, by_path(read_curve), yaml_damaged),
        "profile": Reader("p.yaml", texts.PROFILE, by_path(read_outline), yaml_damaged),
        "sketch": Reader("s.yaml", sketch, by_path(Sketch.load), yaml_damaged),
    }


def _robots() -> dict[str, Reader]:
    where, beside = Kind.ROBOT, reading.robot_beside
    return {
        "URDF": Reader("arm.urdf", texts.URDF, reading.robot, xml_damaged, where, (".xml",)),
        "MJCF": Reader("arm.xml", texts.MJCF, reading.robot, xml_damaged, where, (".mjcf",)),
        "xacro": Reader("arm.xacro", texts.XACRO, reading.xacro, xml_damaged, where),
        "SRDF": Reader("arm.srdf", texts.SRDF, beside, xml_damaged),
        "joint limits": Reader("limits.yaml", texts.LIMITS, beside, yaml_damaged),
        "controllers": Reader("control.yaml", texts.CONTROL, beside, yaml_damaged),
    }


def _scenes() -> dict[str, Reader]:
    read, where, cells = reading.scene, Kind.SCENE, cases.octomap_scene(octree(CELLS))
    return {
        "scene": Reader("cell.yaml", cases.SCENE, read, yaml_damaged, where, (".yml",)),
        "PlanningScene": Reader("cell.yaml", texts.PLANNING_SCENE, read, yaml_damaged, where),
        "octomap message": Reader("cell.yaml", cells, read, yaml_damaged, where),
        "scene text": Reader("cell.scene", SECOND.encode(), read, lines_damaged, where),
        "scene text 1": Reader("cell.scene", FIRST.encode(), read, lines_damaged, where),
        "SDF": Reader("cell.sdf", texts.SDF, read, xml_damaged, where, (".world",)),
        "MJCF scene": Reader("world.xml", texts.MJCF, read, xml_damaged, where, (".mjcf",)),
    }


def _motions() -> dict[str, Reader]:
    read, where = reading.trajectory, Kind.TRAJECTORY
    poses, tables = reading.poses, Kind.POSES
    yml = (".yml",)
    return {
        "trajectory": Reader("path.csv", texts.PATH, read, table_damaged, where),
        "trajectory semicolons": Reader("path.csv", texts.COMMAS, read, table_damaged, where),
        "JointTrajectory": Reader("path.yaml", texts.MESSAGE, read, yaml_damaged, where, yml),
        "JointTrajectory JSON": Reader("path.json", texts.MESSAGE_JSON, read, json_damaged, where),
        "pose table": Reader("door.csv", texts.POSES, poses, table_damaged, tables),
        "poses stamped": Reader("door.yaml", texts.STAMPED, poses, yaml_damaged, tables, yml),
        "poses JSON": Reader("door.json", cases.POSES_JSON, poses, json_damaged, tables),
    }


def _programs() -> dict[str, Reader]:
    read, where, words = reading.controller, Kind.PROGRAM, lines_damaged
    own = reading.program, yaml_damaged, where, (".yml",)
    return {
        "program": Reader("weld.yaml", cases.PROGRAM, *own),
        "RAPID": Reader("weld.mod", cases.RAPID, read, words, where, (".prg", ".sys", ".modx")),
        "URScript": Reader("weld.script", cases.URSCRIPT, read, words, where, (".urscript",)),
        "KRL": Reader("weld.src", cases.KRL, read, words, where),
        "FANUC": Reader("weld.ls", cases.FANUC, read, words, where),
    }


def _bags() -> dict[str, Reader]:
    read, where = reading.bag, Kind.TRAJECTORY
    return {
        "bag bag": Reader("run.bag", bag("bag"), read, parts_damaged, where),
        "bag mcap": Reader("run.mcap", bag("mcap"), read, parts_damaged, where),
        "bag mcap states": Reader("run.mcap", states("mcap"), read, parts_damaged, where),
        "bag rosbag2 sqlite3": Reader("run.db3", bag(RUN), read, parts_damaged, where),
        "bag metadata": Reader(
            "run/metadata.yaml", bag_metadata(), reading.bag_folder, yaml_damaged
        ),
    }


def _others() -> dict[str, Reader]:
    cases_of, items = reading.case_list, reading.batch_items
    return {
        "case": Reader("case.yaml", texts.CASE, reading.case, yaml_damaged),
        "case list": Reader("all.yaml", b"cases: ['*e.yaml']\n", cases_of, yaml_damaged),
        "manifest": Reader("batch.yaml", cases.MANIFEST, by_path(load_manifest), yaml_damaged),
        "batch": Reader("batch.yaml", cases.MANIFEST, items, yaml_damaged),
        "waivers": Reader("waivers.yaml", cases.WAIVERS, by_path(load_waivers), yaml_damaged),
        "findings": Reader("findings.json", cases.findings(), by_path(read_findings), json_damaged),
    }
