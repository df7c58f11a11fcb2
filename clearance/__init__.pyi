from .case.case_file import load_case
from .case.waiver_file import load_waivers
from .errors import BadInput, ClearanceError
from .findings.finding import Finding
from .formats.cloud.formats import read_points
from .formats.mesh.mesh_file import read_mesh
from .formats.robot.request import load_robot
from .gains.answer import gain
from .gains.result import Gain
from .gains.turn import Turn
from .geometry.point_cloud import PointCloud
from .geometry.polyhedron import Polyhedron
from .geometry.polytope import Polytope
from .geometry.shapes import box, capsule, cylinder, ellipsoid, pipe, sphere
from .planar.biarcs import biarcs
from .planar.curve import Curve
from .planar.curve_file import read_curve
from .planar.deviation import deviation
from .planar.hausdorff import Undecided, hausdorff, within
from .planar.minimum import minimum_distance
from .profiles.fit import Fit, fit
from .profiles.profile import Profile
from .profiles.sweep import swept_profile
from .query.common_point import common_point, common_point_paper
from .query.contact import Contact, contact
from .query.distance import distance, polygon_distance, polygon_distances
from .query.intersection import Intersection, intersect
from .query.pair_query import Query
from .query.penetration import penetration
from .query.result import Nearest
from .receipt.verification import Verification
from .receipt.verifying import verify
from .receipt.writing import write_receipt
from .record.record import CrossCheck, Record
from .record.workspace import Workspace
from .run import CheckOptions, Question, Resources, Run, answer, check
from .simulate.answers.workspace.workspace import shared_workspace
from .simulate.measure.checker import Checker
from .sketch import Sketch, SketchResult
from .world.body import Body, Mount, Obstacle
from .world.carry import Carry
from .world.case import Case, Clock, Limits
from .world.placed_robot import PlacedRobot, SelfClearance
from .world.pose_table import PoseTable
from .world.robot import Robot
from .world.rules import Allowance, Rule, Waiver
from .world.timing import Timing, Window
from .world.trajectory import Trajectory

__all__ = [
    "Allowance",
    "BadInput",
    "Body",
    "Carry",
    "Case",
    "CheckOptions",
    "Checker",
    "ClearanceError",
    "Clock",
    "Contact",
    "CrossCheck",
    "Curve",
    "Finding",
    "Fit",
    "Gain",
    "Intersection",
    "Limits",
    "Mount",
    "Nearest",
    "Obstacle",
    "PlacedRobot",
    "PointCloud",
    "Polyhedron",
    "Polytope",
    "PoseTable",
    "Profile",
    "Query",
    "Question",
    "Record",
    "Resources",
    "Robot",
    "Rule",
    "Run",
    "SelfClearance",
    "Sketch",
    "SketchResult",
    "Timing",
    "Trajectory",
    "Turn",
    "Undecided",
    "Verification",
    "Waiver",
    "Window",
    "Workspace",
    "__version__",
    "answer",
    "biarcs",
    "box",
    "capsule",
    "check",
    "common_point",
    "common_point_paper",
    "contact",
    "cylinder",
    "deviation",
    "distance",
    "ellipsoid",
    "fit",
    "gain",
    "hausdorff",
    "intersect",
    "load_case",
    "load_robot",
    "load_waivers",
    "minimum_distance",
    "penetration",
    "pipe",
    "polygon_distance",
    "polygon_distances",
    "read_curve",
    "read_mesh",
    "read_points",
    "shared_workspace",
    "sphere",
    "swept_profile",
    "verify",
    "within",
    "write_receipt",
]

__version__: str
