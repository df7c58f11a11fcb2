"""Small valid files of robots, cases, scenes and motions. Not for: damaging them (`campaign`)."""

from __future__ import annotations

CURVES = b"""curves:
- line: {start: [0, 0], end: [1, 2]}
- polyline: {points: [[0, 0], [1, 0], [1, 1]], closed: true}
- bspline: {control: [[0, 0], [1, 2], [3, 1], [4, 0]], degree: 2}
- arc: {center: [0, 0], radius: 1, start: 0.5, end: 2}
- circle: {center: [3, 3], radius: 0.5}
"""

PROFILE = b"""format: clearance-profile-1
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

URDF = b"""<?xml version="1.0"?>
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

BOXES = URDF
for _round in (b'<sphere radius="0.05"/>', b'<cylinder radius="0.01" length="0.1"/>'):
    BOXES = BOXES.replace(_round, b'<box size="0.1 0.1 0.1"/>')
MJCF = b"""<mujoco model="arm"><compiler autolimits="true" angle="radian"/>
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
<contact><exclude body1="upper" body2="tip"/></contact>
<keyframe><key name="home" qpos="0.2 0.1 1 0 0 0" ctrl="1"/></keyframe></mujoco>
"""

CASE = b"""name: small
robot: {urdf: arm.urdf, base: {xyz: [0, 0, 0.5], rpy: [0, 0, 1.57]}, exclude_links: [tip]}
scene:
  obstacles:
  - {name: post, pose: {xyz: [2, 0, 0]}, box: {size: [0.1, 0.1, 1]}}
  - {name: ball, pose: {xyz: [2, 1, 0]}, sphere: {radius: 0.02}}
  - {name: part, pose: {xyz: [-2, 1, 0]}, mesh: {file: m.stl, scale: 0.5}}
trajectory: {file: path.csv}
limits: {fail: 0.005, warn: 0.02}
allow:
- [base, post]
"""

ROBOT = {
    "urdf": "arm.urdf",
    "srdf": "arm.srdf",
    "self_clearance": True,
    "joints": {"state": "home"},
    "joint_limits": "limits.yaml",
    "controllers": "control.yaml",
}

SRDF = b"""<?xml version="1.0"?>
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

LIMITS = b"""robot_description_planning:
  joint_limits:
    shoulder:
      has_position_limits: true
      min_position: -0.5
      max_position: 0.9
      has_velocity_limits: true
      max_velocity: 2.5e0
    grip: {has_acceleration_limits: true, max_acceleration: 3, has_jerk_limits: false, max_jerk: 1}
"""

CONTROL = b"""controller_manager: {ros__parameters: {update_rate: 100}}
arm_controller:
  ros__parameters:
    joints: [shoulder]
    constraints:
      goal_time: 0.6
      shoulder: {trajectory: 0.2, goal: 1.0e-2}
"""

XACRO = b"""<?xml version="1.0"?>
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

COMMAS = b"time [ms];shoulder [deg]\n0;0,5\n500;11,25\n1e3;-2,5e0\n"

MESSAGE = b"""joint_names:
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

MESSAGE_JSON = b"""{"trajectory": [{"joint_trajectory": {"joint_names": ["shoulder"], "points": [
{"positions": [0.0], "velocities": [0.5], "time_from_start": {"sec": 0, "nanosec": 0}},
{"positions": [0.25], "velocities": [0.1], "time_from_start": 1.5}]}}]}
"""

POSES = (
    b"time,x,y,z,qx,qy,qz,qw\n0,1,-2.5,3e-1,0,0,0,1\n1.5,0,0,0,0.6,0,0,0.8\n2,0,0,0.125,1,0,0,0\n"
)

STAMPED = b"""header:
  stamp: {sec: 3, nanosec: 5}
  frame_id: map
pose:
  position: {x: 1.0, y: -2.5, z: 0.5}
  orientation: {x: 0.0, y: 0.0, z: 0.6, w: 0.8}
---
header: {stamp: {secs: 4, nsecs: 0}, frame_id: map}
pose: {position: {x: 1.0, y: -2.5, z: 0.5}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}
"""

PLANNING_SCENE = b"""name: cell
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

SDF = b"""<?xml version="1.0"?>
<sdf version="1.7"><world name="w"><frame name="f" attached_to="m"><pose>1 0 0 0 0 0.5</pose></frame>
<model name="m"><static>true</static><pose>0 0 1 0 0 0</pose>
<link name="a"><pose>0.1 0 0 0 0 0</pose>
<collision name="c"><pose relative_to="b">0 0 0.5 0 0 0</pose><geometry><box><size>1 2 3</size></box></geometry>
</collision></link>
<link name="b"><collision name="d"><geometry><mesh><uri>m.stl</uri><scale>0.5 0.5 0.5</scale></mesh></geometry>
</collision></link></model>
<model name="n"><pose relative_to="f">3 0 0 0 0 0</pose><link name="a">
<collision name="c"><geometry><cylinder><radius>0.02</radius><length>1</length></cylinder></geometry></collision>
<collision name="e"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
</world></sdf>
"""

PATH = b"time,shoulder\n0,0\n0.5,0.25\n1,0.5\n1.5,-0.25\n"
