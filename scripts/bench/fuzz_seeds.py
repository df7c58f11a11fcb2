"""Small valid files of every kind that is read, and what reads each: where `fuzz_readers` starts from."""

from __future__ import annotations

import json
import logging
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tests.load.making_clouds import pcd, ply, table
from tests.load.making_octree import octree

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = np.array([[q[0], q[i], q[i + 1]] for q in QUADS for i in (1, 2)])

CELLS = {(0, 0, 0): True, (1, 0, 0): True, (0, -1, 2): False, (-9, 4, 4): True}

SKETCH = Path(__file__).parents[2] / "scenes" / "sketches" / "d_cell.yaml"


class Reader(NamedTuple):
    """What is read: a valid file, its name, and a function of content and folder that reads it."""

    name: str
    valid: bytes
    read: Callable[[bytes, Path], object]


def readers() -> dict[str, Reader]:
    """Every reader by name."""
    meshes = {
        "STL binary": ("m.stl", _binary_stl()),
        "STL text": ("m.stl", _text_stl()),
        "OBJ": ("m.obj", _obj()),
        "COLLADA": ("m.dae", _collada()),
        "PLY text": ("m.ply", _ply_text()),
        "PLY binary": ("m.ply", _ply_binary()),
        "OFF": ("m.off", _off()),
        "GLB": ("m.glb", _glb()),
        "STEP": ("m.step", _step()),
        "octomap binary": ("m.bt", octree(CELLS)),
        "octomap full": ("m.ot", octree(CELLS, full=True)),
    }
    made = {kind: Reader(name, data, _mesh_reader(name)) for kind, (name, data) in meshes.items()}
    for kind, (name, data) in _scans().items():
        made[kind] = Reader(name, data, _points_reader(name))
    return made | {
        "DXF": Reader("d.dxf", _dxf(), _file_reader("d.dxf", _read_dxf)),
        "curves": Reader("c.yaml", _CURVES, _file_reader("c.yaml", _read_curves)),
        "profile": Reader("p.yaml", _PROFILE, _file_reader("p.yaml", _read_profile)),
        "sketch": Reader("s.yaml", SKETCH.read_bytes(), _file_reader("s.yaml", _read_sketch)),
        "URDF": Reader("arm.urdf", _URDF, _case_reader("arm.urdf")),
        "MJCF": Reader("arm.xml", _MJCF, _mjcf_reader("arm.xml")),
        "MJCF scene": Reader("world.xml", _MJCF, _mjcf_scene_reader("world.xml")),
        "case": Reader("case.yaml", _CASE, _case_reader("case.yaml")),
        "SRDF": Reader("arm.srdf", _SRDF, _robot_reader("arm.srdf")),
        "joint limits": Reader("limits.yaml", _LIMITS, _robot_reader("limits.yaml")),
        "controllers": Reader("control.yaml", _CONTROL, _robot_reader("control.yaml")),
        "xacro": Reader("arm.xacro", _XACRO, _file_reader("arm.xacro", _read_xacro)),
        "trajectory": Reader("path.csv", _PATH, _trajectory_reader("path.csv")),
        "trajectory semicolons": Reader("path.csv", _COMMAS, _trajectory_reader("path.csv")),
        "JointTrajectory": Reader("path.yaml", _MESSAGE, _trajectory_reader("path.yaml")),
        "JointTrajectory JSON": Reader("path.json", _MESSAGE_JSON, _trajectory_reader("path.json")),
        "pose table": Reader("door.csv", _POSES, _file_reader("door.csv", _read_poses)),
        "poses stamped": Reader("door.yaml", _STAMPED, _file_reader("door.yaml", _read_poses)),
        "PlanningScene": Reader("cell.yaml", _PLANNING_SCENE, _scene_reader("cell.yaml")),
        "scene text": Reader("cell.scene", _SCENE_TEXT, _scene_reader("cell.scene")),
        "SDF": Reader("cell.sdf", _SDF, _scene_reader("cell.sdf")),
        **_bag_readers(),
    }


def _mesh_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.mesh import mesh_from_bytes

        return mesh_from_bytes(data, name)

    return read


def _scans() -> dict[str, tuple[str, bytes]]:
    points = np.concatenate([CUBE, [[np.nan] * 3]])
    return {
        "PCD ascii": ("s.pcd", pcd(points, "ascii")),
        "PCD binary": ("s.pcd", pcd(points, "binary")),
        "PCD compressed": ("s.pcd", pcd(points, "binary_compressed")),
        "points PLY": ("s.ply", ply(points)),
        "points CSV": ("s.csv", table(points, ",", "x [mm],y [mm],z [mm]")),
        "points XYZ": ("s.xyz", table(points, " ", "")),
    }


def _points_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.cloud import cloud_from_bytes

        return cloud_from_bytes(data, name, 0.01)

    return read


def _file_reader(name: str, read_file: Callable[[Path], object]) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        (folder / name).write_bytes(data)
        return read_file(folder / name)

    return read


def _case_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.case_file import load_case

        valid = {"case.yaml": _CASE, "arm.urdf": _URDF, "path.csv": _PATH, "m.stl": _binary_stl()}
        for other, content in (valid | {name: data}).items():
            (folder / other).write_bytes(content)
        return load_case(folder / "case.yaml")

    return read


def _robot_reader(name: str) -> Callable[[bytes, Path], object]:
    """Reads a robot with all the files that may stand beside it, of which one is damaged."""

    def read(data: bytes, folder: Path) -> object:
        from clearance.load import schema
        from clearance.load.input_files import InputFiles
        from clearance.load.mesh_store import MeshStore
        from clearance.load.robots import RobotReader

        valid = {"arm.urdf": _BOXES, "m.stl": _binary_stl(), "arm.srdf": _SRDF}
        valid |= {"limits.yaml": _LIMITS, "control.yaml": _CONTROL}
        for other, content in (valid | {name: data}).items():
            (folder / other).write_bytes(content)
        robot = schema.Robot.model_validate(_ROBOT)
        entry = schema.RobotEntry("robot", robot, None, "trajectory")
        return RobotReader(folder, MeshStore(InputFiles(folder))).moving(entry)

    return read


def _mjcf_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.robot_formats import load_robot

        (folder / name).write_bytes(data)
        (folder / "m.stl").write_bytes(_binary_stl())
        return load_robot(folder / name)

    return read


def _mjcf_scene_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.input_files import InputFiles
        from clearance.load.scene_formats import read_scene
        from clearance.load.scene_request import SceneRequest

        (folder / name).write_bytes(data)
        (folder / "m.stl").write_bytes(_binary_stl())
        return read_scene(SceneRequest(folder / name, InputFiles(folder)))

    return read


def _read_dxf(path: Path) -> object:
    from clearance.planar.dxf import read_dxf

    return read_dxf(str(path))


def _read_xacro(path: Path) -> object:
    """What is evaluated in the process that is started for it, and then read as URDF."""
    from clearance.errors import BadSyntax
    from clearance.load.urdf_elements import parse_document
    from clearance.load.xacro_process import Watch, evaluated

    made = evaluated(path, {}, Watch())
    if "problem" in made:
        raise BadSyntax(made["problem"], where=path.name)
    return parse_document(made["urdf"].encode())


def _read_curves(path: Path) -> object:
    from clearance.planar.curve_file import read_curve

    return read_curve(str(path))


def _read_profile(path: Path) -> object:
    from clearance.profiles.outline_file import read_profile

    return read_profile(path)


def _read_sketch(path: Path) -> object:
    from clearance.sketch import Sketch

    return Sketch.load(path)


def _read_poses(path: Path) -> object:
    from clearance.load.pose_formats import read_poses
    from clearance.load.pose_table_request import PoseRequest

    return read_poses(PoseRequest(lambda: path.open("rb"), path.stat().st_size), path.name)


def _scene_reader(name: str) -> Callable[[bytes, Path], object]:
    """Reads a scene as a case would: its content, then the solids that it names."""

    def read(data: bytes, folder: Path) -> object:
        from clearance.load.input_files import InputFiles
        from clearance.load.mesh_store import MeshStore
        from clearance.load.obstacle_schema import Scene
        from clearance.load.scene_file import make_obstacles
        from clearance.load.scene_formats import read_scene
        from clearance.load.scene_request import SceneRequest
        from clearance.load.schema_errors import validated

        (folder / "m.stl").write_bytes(_binary_stl())
        (folder / name).write_bytes(data)
        files = InputFiles(folder)
        content = read_scene(SceneRequest(folder / name, files))
        given = validated(Scene, content.scene, name).obstacles
        return make_obstacles(given, folder, MeshStore(files))

    return read


def _bag_readers() -> dict[str, Reader]:
    """Bags in each container that rosbags writes; of a folder its one file with the messages."""
    files = {"bag": "run.bag", "mcap": "run.mcap", "rosbag2 sqlite3": "run.db3"}
    return {
        f"bag {kind}": Reader(name, _bag(kind), _file_reader(name, _read_bag))
        for kind, name in files.items()
    }


def _read_bag(path: Path) -> object:
    from clearance.load.timed_files import load_trajectory
    from clearance.load.trajectory_request import Choice

    return load_trajectory(path, Choice())


def _bag(kind: str) -> bytes:
    from tests.load.making_bags import planned, write_bag

    with tempfile.TemporaryDirectory() as folder:
        topics = {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]}
        path = write_bag(Path(folder) / "made", kind, topics)
        file = next(path.glob("*.db3")) if path.is_dir() else path
        return file.read_bytes()


def _trajectory_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.trajectory_file import parse_trajectory

        return parse_trajectory(data, name)

    return read


def _binary_stl() -> bytes:
    facets = [struct.pack("<12fH", 0, 0, 0, *CUBE[t].ravel(), 0) for t in TRIANGLES]
    return bytes(80) + struct.pack("<I", len(facets)) + b"".join(facets)


def _text_stl() -> bytes:
    lines = ["solid cube"]
    for triangle in CUBE[TRIANGLES].tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(str, point)) for point in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid cube", ""]).encode()


def _rows(rows: np.ndarray | list, before: str = "", one: int = 0) -> str:
    return "".join(
        before + " ".join(str(value + one) for value in list(row)) + "\n" for row in rows
    )


def _obj() -> bytes:
    return (
        "# cube\no c\n"
        + _rows(CUBE.tolist(), "v ")
        + _rows(QUADS[:5], "f ", 1)
        + "f -7/1 -3 -1 -5\n"
    ).encode()


def _faces() -> str:
    return _rows([[len(quad), *quad] for quad in QUADS])


def _off() -> bytes:
    return ("OFF\n8 6 0\n" + _rows(CUBE.tolist()) + _faces()).encode()


def _ply_head(kind: str) -> str:
    lines = [
        "ply",
        f"format {kind} 1.0",
        "element vertex 8",
        *(f"property double {x}" for x in "xyz"),
    ]
    return "\n".join(
        [*lines, "element face 6", "property list uchar int vertex_indices", "end_header", ""]
    )


def _ply_text() -> bytes:
    return (_ply_head("ascii") + _rows(CUBE.tolist()) + _faces()).encode()


def _ply_binary() -> bytes:
    faces = b"".join(struct.pack("<B4i", 4, *quad) for quad in QUADS)
    return _ply_head("binary_little_endian").encode() + CUBE.astype("<f8").tobytes() + faces


def _collada() -> bytes:
    polygons = " ".join(str(i) for quad in QUADS for i in quad)
    return f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.001"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p">
<float_array id="pa" count="24">{" ".join(map(str, CUBE.ravel().tolist()))}</float_array><technique_common>
<accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><polylist count="6">
<input semantic="VERTEX" source="#v" offset="0"/>
<vcount>4 4 4 4 4 4</vcount><p>{polygons}</p></polylist></mesh></geometry></library_geometries><library_nodes>
<node id="n"><instance_geometry url="#g"/></node></library_nodes><library_visual_scenes><visual_scene id="s"><node>
<rotate>0 0 1 90</rotate><scale>1 2 3</scale><instance_node url="#n"/><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


def _glb() -> bytes:
    points, indices = CUBE.astype("<f4").tobytes(), TRIANGLES.astype("<u2").tobytes()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "scale": [1, 2, 3]},
                  {"mesh": 0, "translation": [9, 0, 0], "rotation": [0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168}],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", 168, b"BIN\0")
        + points
        + indices
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _step() -> bytes:
    from tests.load.making_step import cylinder_step

    return cylinder_step().encode()


def _dxf() -> bytes:
    """Written by ezdxf, so that it has all the tables that a drawing needs."""
    import ezdxf

    logging.getLogger("ezdxf").setLevel(
        logging.ERROR
    )  # R12 has no units, which it would tell each time
    drawing = ezdxf.new("R12")
    space = drawing.modelspace()
    space.add_line((0, 0), (2, 0))
    space.add_arc((2, 1), 1, -90, 90)
    space.add_polyline2d([(2, 2, 0), (0, 2, 0.5), (0, 0, 0)], format="xyb")
    space.add_circle((5, 5), 2)
    with tempfile.TemporaryDirectory() as folder:
        drawing.saveas(Path(folder) / "d.dxf")
        return (Path(folder) / "d.dxf").read_bytes()


_CURVES = b"""curves:
- line: {start: [0, 0], end: [1, 2]}
- polyline: {points: [[0, 0], [1, 0], [1, 1]], closed: true}
- bspline: {control: [[0, 0], [1, 2], [3, 1], [4, 0]], degree: 2}
- arc: {center: [0, 0], radius: 1, start: 0.5, end: 2}
- circle: {center: [3, 3], radius: 0.5}
"""

_PROFILE = b"""format: clearance-profile-1
name: port
plane: {name: xy, origin: [0, 0, 0.5], axes: [[1, 0, 0], [0, 1, 0]]}
tolerance: 0.001
bound: 0.002
steps: 3
contours:
- [[0, 0, 0], [1, 0, 0.5], [1, 1, 0], [0, 1, -0.25]]
- [[0.2, 0.2, 0], [0.2, 0.4, 0], [0.4, 0.4, 0]]
notes: [made]
"""

_URDF = b"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.5" rpy="0 0.1 0"/><geometry><mesh filename="m.stl"
    scale="0.1 0.1 1"/></geometry></collision></link>
  <link name="tip"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="finger"><collision><geometry><cylinder radius="0.01" length="0.1"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.1"/>
    <axis xyz="0 0 2"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="tip"/><origin xyz="0 0 1.5"/></joint>
  <joint name="grip" type="prismatic"><parent link="tip"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/>
    <mimic joint="shoulder" multiplier="0.1" offset="0.01"/></joint>
</robot>
"""

_BOXES = _URDF
for _round in (b'<sphere radius="0.05"/>', b'<cylinder radius="0.01" length="0.1"/>'):
    _BOXES = _BOXES.replace(_round, b'<box size="0.1 0.1 0.1"/>')
_MJCF = b"""<mujoco model="arm"><compiler autolimits="true" angle="radian"/>
<default><geom solref="0.01 1"/><default class="seen"><geom contype="0" conaffinity="0"/></default></default>
<asset><mesh name="m" file="m.stl" scale="0.1 0.2 0.3" refpos="0 0 1" refquat="1 0 1 0"/></asset>
<worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="upper" pos="0 0 0.1" euler="0 0.1 0"><joint name="shoulder" axis="0 0 1" range="-1 1" ref="0.2"/>
<joint name="slide" type="slide" axis="1 0 0" pos="0 0 0.1"/><geom size="0.1 0.2" type="capsule"/>
<body name="tip" pos="0 0 1"><joint type="ball"/><geom type="mesh" mesh="m" pos="0 0 0.2" quat="1 0 0 1"/>
<geom class="seen" type="ellipsoid" size="0.1 0.2 0.3"/></body></body>
<replicate count="3" offset="0 1 0"><body name="post" pos="3 0 0"><geom type="box" size="0.1 0.1 1"/></body>
</replicate>
</worldbody><equality><joint joint1="slide" joint2="shoulder" polycoef="0 0.1 0 0 0"/></equality>
<contact><exclude body1="upper" body2="tip"/></contact></mujoco>
"""

_CASE = b"""name: small
robot: {urdf: arm.urdf, base: {xyz: [0, 0, 0.5], rpy: [0, 0, 1.57]}, exclude_links: [tip]}
scene:
  obstacles:
  - {name: post, pose: {xyz: [2, 0, 0]}, box: {size: [0.1, 0.1, 1]}}
  - {name: ball, pose: {xyz: [2, 1, 0]}, sphere: {radius: 0.2}}
  - {name: part, pose: {xyz: [-2, 1, 0]}, mesh: {file: m.stl, scale: 0.5}}
trajectory: {file: path.csv}
limits: {fail: 0.005, warn: 0.02}
allow:
- [base, post]
"""

_ROBOT = {
    "urdf": "arm.urdf",
    "srdf": "arm.srdf",
    "self_clearance": True,
    "joints": {"state": "home"},
    "joint_limits": "limits.yaml",
    "controllers": "control.yaml",
}

_SRDF = b"""<?xml version="1.0"?>
<robot name="arm">
  <group name="arm"><joint name="shoulder"/></group>
  <group_state name="home" group="arm"><joint name="shoulder" value="0.1"/><joint name="x" value="0 1"/>
  </group_state>
  <disable_default_collisions link="finger"/>
  <enable_collisions link1="finger" link2="base"/>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="base" link2="gripper" reason="Never"/>
</robot>
"""

_LIMITS = b"""robot_description_planning:
  joint_limits:
    shoulder:
      has_position_limits: true
      min_position: -0.5
      max_position: 0.9
      has_velocity_limits: true
      max_velocity: 2.5e0
    grip: {has_acceleration_limits: true, max_acceleration: 3, has_jerk_limits: false, max_jerk: 1}
"""

_CONTROL = b"""controller_manager: {ros__parameters: {update_rate: 100}}
arm_controller:
  ros__parameters:
    joints: [shoulder]
    constraints:
      goal_time: 0.6
      shoulder: {trajectory: 0.2, goal: 1.0e-2}
"""

_XACRO = b"""<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="size" default="0.2"/>
  <xacro:property name="long" value="${2 * pi / 4}"/>
  <xacro:macro name="part" params="name size:=0.1 *more">
    <link name="${name}"><collision><geometry><box size="${size} ${size} 0.5"/></geometry></collision></link>
    <xacro:insert_block name="more"/>
  </xacro:macro>
  <xacro:part name="base" size="$(arg size)"><origin/></xacro:part>
  <xacro:if value="${long > 1}"><xacro:part name="tip"><origin/></xacro:part></xacro:if>
  <joint name="j" type="continuous"><parent link="base"/><child link="tip"/></joint>
</robot>
"""

_COMMAS = b"time [ms];shoulder [deg]\n0;0,5\n500;11,25\n1e3;-2,5e0\n"

_MESSAGE = b"""joint_names:
- shoulder
points:
- positions: [0.0]
  velocities: [0.5]
  time_from_start:
    sec: 0
    nanosec: 0
- positions: &a [0.25]
  velocities: *a
  time_from_start: {secs: 1, nsecs: 500000000}
---
"""

_MESSAGE_JSON = b"""{"trajectory": [{"joint_trajectory": {"joint_names": ["shoulder"], "points": [
{"positions": [0.0], "velocities": [0.5], "time_from_start": {"sec": 0, "nanosec": 0}},
{"positions": [0.25], "velocities": [0.1], "time_from_start": 1.5}]}}]}
"""

_POSES = (
    b"time,x,y,z,qx,qy,qz,qw\n0,1,-2.5,3e-1,0,0,0,1\n1.5,0,0,0,0.6,0,0,0.8\n2,0,0,0.125,1,0,0,0\n"
)

_STAMPED = b"""header:
  stamp: {sec: 3, nanosec: 5}
  frame_id: map
pose:
  position: {x: 1.0, y: -2.5, z: 0.5}
  orientation: {x: 0.0, y: 0.0, z: 0.6, w: 0.8}
---
header: {stamp: {secs: 4, nsecs: 0}, frame_id: map}
pose: {position: {x: 1.0, y: -2.5, z: 0.5}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}
"""

_PLANNING_SCENE = b"""name: cell
robot_state:
  joint_state: {name: [shoulder], position: [0.5]}
  attached_collision_objects:
  - link_name: tip
    object: {header: {frame_id: tip}, id: tool, operation: 0, primitives: [{type: 2, dimensions: [0.05]}]}
    touch_links: [upper]
allowed_collision_matrix:
  entry_names: [base, post]
  entry_values: [{enabled: [false, true]}, {enabled: [true, false]}]
fixed_frame_transforms:
- child_frame_id: base_link
  header: {frame_id: map}
  transform: {translation: [0, 0, 3], rotation: [0, 0, 0, 1]}
link_padding: [{link_name: upper, padding: 0.01}]
link_scale: [{link_name: base, scale: 1.0}]
world:
  collision_objects:
  - header: {frame_id: map}
    id: post
    operation: 0
    primitives: [{type: 1, dimensions: [0.1, 0.1, 1.0]}, {type: cylinder, dimensions: [0.5, 0.1]}]
    primitive_poses:
    - {position: {x: 0.0, y: 2.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}
    - {position: [1, 2, 3], orientation: [0, 0, 1, 0]}
  - id: tetrahedron
    header: {frame_id: map}
    meshes:
    - vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
      triangles: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    mesh_poses: [{position: [4, 0, 0], orientation: [0, 0, 0, 1]}]
is_diff: false
"""

_SCENE_TEXT = b"""cell
* post
1 0 0
0 0 0 1
2
sphere
0.25
0 2 0
0 0 0 1
0 0 0 0
mesh
4 4
0 0 0
1 0 0
0 1 0
0 0 1
0 2 1
0 1 3
1 2 3
0 3 2
0 2 0
0 0 0 1
0 0 0 0
1
grip
0 0 0
0 0 0 1
.
"""

_SDF = b"""<?xml version="1.0"?>
<sdf version="1.7"><world name="w"><frame name="f" attached_to="m"><pose>1 0 0 0 0 0.5</pose></frame>
<model name="m"><static>true</static><pose>0 0 1 0 0 0</pose>
<link name="a"><pose>0.1 0 0 0 0 0</pose>
<collision name="c"><pose relative_to="b">0 0 0.5 0 0 0</pose><geometry><box><size>1 2 3</size></box></geometry>
</collision></link>
<link name="b"><collision name="d"><geometry><mesh><uri>m.stl</uri><scale>0.5 0.5 0.5</scale></mesh></geometry>
</collision></link></model>
<model name="n"><pose relative_to="f">3 0 0 0 0 0</pose><link name="a">
<collision name="c"><geometry><cylinder><radius>0.2</radius><length>1</length></cylinder></geometry></collision>
<collision name="e"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
</world></sdf>
"""

_PATH = b"time,shoulder\n0,0\n0.5,0.25\n1,0.5\n1.5,-0.25\n"
