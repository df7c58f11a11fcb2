"""Definitions of MoveIt's messages for bags that do not bring them: those of rosbag2 in sqlite3 before Iron.

The lists of fields are those of moveit_msgs 2, of ROS 2. All other bags bring their own definitions, which go
before these. Not for: what ROS itself defines, which rosbags knows.
"""

from __future__ import annotations

DEFINITIONS: dict[str, str] = {
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "moveit_msgs/msg/CollisionObject": """
        std_msgs/Header header
        geometry_msgs/Pose pose
        string id
        object_recognition_msgs/ObjectType type
        shape_msgs/SolidPrimitive[] primitives
        geometry_msgs/Pose[] primitive_poses
        shape_msgs/Mesh[] meshes
        geometry_msgs/Pose[] mesh_poses
        shape_msgs/Plane[] planes
        geometry_msgs/Pose[] plane_poses
        string[] subframe_names
        geometry_msgs/Pose[] subframe_poses
        byte operation""",
    "moveit_msgs/msg/AttachedCollisionObject": """
        string link_name
        moveit_msgs/CollisionObject object
        string[] touch_links
        trajectory_msgs/JointTrajectory detach_posture
        float64 weight""",
    "moveit_msgs/msg/RobotState": """
        sensor_msgs/JointState joint_state
        sensor_msgs/MultiDOFJointState multi_dof_joint_state
        moveit_msgs/AttachedCollisionObject[] attached_collision_objects
        bool is_diff""",
    "moveit_msgs/msg/RobotTrajectory": """
        trajectory_msgs/JointTrajectory joint_trajectory
        trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory""",
    "moveit_msgs/msg/DisplayTrajectory": """
        string model_id
        moveit_msgs/RobotTrajectory[] trajectory
        moveit_msgs/RobotState trajectory_start""",
}
"""By kind of message: its fields, one a line."""
