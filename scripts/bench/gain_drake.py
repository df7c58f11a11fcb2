"""The same paths by Drake: KinematicTrajectoryOptimization, a MinimumDistanceLowerBoundConstraint at each sample.

The control points of Drake's path, of order 2, are the table's samples, so that it is the table itself. They are
tied to the offsets of our splines, of which the greatest is made least. SNOPT starts from the path as it is.
Meshes are convex hulls, as Drake takes them; pairs are those that we measure. Our measure judges what comes out.
Not for: cases with several actors that move.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import combinations
from typing import Any

import numpy as np
from gain_cases import change_of
from gain_files import CaseOnDisk
from inputs import round_shape

import clearance as cl
from clearance.gains.offsets import JointOffsets
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import OBSTACLE, BodyIndex, measured_pairs
from clearance.world.robot import Joint, JointKind

INFLUENCE = 0.02
"""[m] Above the bound, from where on Drake looks at a pair."""

BEYOND = 3e-4
"""[m] Drake is asked for more than the limit: SNOPT keeps Drake's penalty, which is flat at the bound, to its own
tolerance, which is up to 0.2 mm."""

PER_INTERVAL = 2
"""Looks at the lines between samples; on cubics Drake's path is the samples alone."""

TOLERANCE = 1e-6
"""Of SNOPT, for constraints and optimality."""

WIDEST = 2.0
"""[-] Of the size of the known change, how large any variable may be."""


@dataclass(frozen=True)
class DrakePath:
    """What Drake came to.

    Attributes:
        size: as ours. seconds: of CPU.
        sampled: the samples keep the limit, by our exact measure, and the joints theirs.
        proven: our certificate proves the motion between them as well.
        convex: every body is convex, hence as Drake takes it.
    """

    size: float
    seconds: float
    sampled: bool
    proven: bool
    convex: bool


def has_drake() -> bool:
    """Whether it is installed."""
    return find_spec("pydrake") is not None


def takes(case: Case) -> bool:
    """Whether a case is one robot that moves among obstacles that stand, on straight lines between samples."""
    one = len(case.robots) == 1 and not case.carries
    still = all(o.mount is None and o.moves is None for o in case.obstacles)
    return one and still and all(o.body.origin != "cloud" for o in case.obstacles)


def drake_path(one: CaseOnDisk, n_intervals: int, seconds: float) -> DrakePath:
    """Drake's change of a path, with splines on so many intervals, within so many seconds."""
    from pydrake.solvers import SnoptSolver, SolverOptions

    case = cl.load_case(one.file)
    offsets = change_of(case, "waypoints", one.who, n_intervals)
    assert isinstance(offsets, JointOffsets)
    began = time.process_time()
    program, x, held = _program(case, offsets, one.known)
    options, solver = SolverOptions(), SnoptSolver()
    for name, level in (
        ("Time limit", seconds),
        ("Major feasibility tolerance", TOLERANCE),
        ("Major optimality tolerance", TOLERANCE),
    ):
        options.SetOption(solver.solver_id(), name, level)
    found = np.asarray(solver.Solve(program, None, options).GetSolution(x))
    used = time.process_time() - began
    del held
    sampled = _keeps(offsets, found, certify=False)
    return DrakePath(
        offsets.size(found), used, sampled, sampled and _keeps(offsets, found), _is_convex(case)
    )


def _keeps(offsets: JointOffsets, x: np.ndarray, *, certify: bool = True) -> bool:
    """Whether a path keeps the limit, by our measure, and the limits of joints."""
    run = cl.check(offsets.case_of(x), contact="none", certify=certify)
    return run.passed and bool((offsets.kept.a @ x - offsets.kept.b <= 1e-6).all())


def _program(case: Case, offsets: JointOffsets, known: float) -> tuple[Any, np.ndarray, Any]:
    """Drake's programme, its variables, which are the splines' weights, and what must live as long."""
    from pydrake.multibody.inverse_kinematics import MinimumDistanceLowerBoundConstraint
    from pydrake.planning import KinematicTrajectoryOptimization

    cell, asked = _Cell(case), offsets.placed.given_trajectory
    table, n = asked.positions[:, cell.columns], asked.n_steps
    trajopt = KinematicTrajectoryOptimization(table.shape[1], n, spline_order=2)
    program, points = trajopt.get_mutable_prog(), trajopt.control_points()
    x = program.NewContinuousVariables(offsets.n_joints * offsets.n_splines, "splines")
    splines = offsets.basis.at(asked.times)
    for i, column in enumerate(cell.columns):
        own = x[column * offsets.n_splines : (column + 1) * offsets.n_splines]
        tied = np.hstack([np.eye(n), -splines])
        program.AddLinearEqualityConstraint(tied, table[:, i], np.append(points[i], own))
    _least(program, x, offsets, WIDEST * known)
    program.SetInitialGuess(points, table.T)
    apart = MinimumDistanceLowerBoundConstraint(
        plant=cell.plant, bound=case.limits.fail + BEYOND, plant_context=cell.context,
        influence_distance_offset=INFLUENCE,
    )  # fmt: skip
    n_looks = (n - 1) * (PER_INTERVAL if asked.velocities is None else 1)
    for i in range(n_looks + 1):
        trajopt.AddPathPositionConstraint(apart, i / n_looks)
    return program, x, (cell, trajopt)


def _least(program: Any, x: np.ndarray, offsets: JointOffsets, widest: float) -> None:
    """The greatest offset is to be least, within the limits of joints; it starts from none."""
    t = program.NewContinuousVariables(1, "size")
    program.AddLinearCost(t[0])
    rows = np.kron(np.diag(offsets.weights), offsets.few_samples)
    for sign in (1.0, -1.0):
        a = np.hstack([sign * rows, -np.ones((len(rows), 1))])
        below = np.full(len(a), -np.inf)
        program.AddLinearConstraint(a, below, np.zeros(len(a)), np.append(x, t))
    far = widest / np.repeat(offsets.weights, offsets.n_splines)
    program.AddBoundingBoxConstraint(-far, far, x)
    kept = offsets.kept
    reached = np.flatnonzero(abs(kept.a) @ far > kept.b)
    if len(reached):
        a = kept.a[reached].toarray()
        program.AddLinearConstraint(a, np.full(len(a), -np.inf), kept.b[reached], x)
    program.SetInitialGuess(x, np.zeros(len(x)))
    program.SetInitialGuess(t, np.zeros(1))


class _Cell:
    """A case as Drake's plant: the joints of the table move, all others stand at what they are.

    Attributes:
        columns: of the table, for each position of the plant.
    """

    def __init__(self, case: Case) -> None:
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        self.case, self.placed = case, case.robots[0]
        self.plant, self.graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        self._linked()
        ids = self._shaped()
        self.plant.Finalize()
        self.columns = self._columns()
        self._leave_out(ids)
        self.diagram = builder.Build()
        self.root = self.diagram.CreateDefaultContext()
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)

    def _linked(self) -> None:
        """Links and joints."""
        robot = self.placed.robot
        poses = kinematic_motion(self.placed).poses()[0]
        links = {name: self.plant.AddRigidBody(name) for name in robot.link_names}
        at = dict(zip(robot.link_names, poses, strict=True))
        root = robot.link_names[0]
        self.plant.WeldFrames(self.plant.world_frame(), links[root].body_frame(), _rigid(at[root]))
        for joint in robot.joints:
            parent, child = links[joint.parent], links[joint.child]
            if joint.name in self.placed.given_trajectory.joint_names:
                self._moving(joint, parent, child)
            else:
                fixed = _rigid(np.linalg.inv(at[joint.parent]) @ at[joint.child])
                self.plant.WeldFrames(parent.body_frame(), child.body_frame(), fixed)

    def _columns(self) -> list[int]:
        """The column of the table of each position."""
        names = self.placed.given_trajectory.joint_names
        starts = [self.plant.GetJointByName(name).position_start() for name in names]
        return [int(column) for column in np.argsort(starts)]

    def _moving(self, joint: Joint, parent: Any, child: Any) -> None:
        from pydrake.multibody.tree import FixedOffsetFrame, PrismaticJoint, RevoluteJoint

        frame = self.plant.AddFrame(
            FixedOffsetFrame(
                f"{joint.name}/at", parent.body_frame(), _rigid(joint.parent_from_joint)
            )
        )
        made = PrismaticJoint if joint.kind == JointKind.PRISMATIC else RevoluteJoint
        self.plant.AddJoint(made(joint.name, frame, child.body_frame(), joint.axis))

    def _shaped(self) -> dict[BodyIndex, Any]:
        """All bodies, by ours."""
        found = {}
        robot, found = self.placed.robot, {}
        for i, body in enumerate(robot.bodies):
            carrier = self.plant.GetBodyByName(body.name)
            found[BodyIndex(0, i)] = self._added(body, carrier, np.eye(4), f"link {i}")
        for i, one in enumerate(self.case.obstacles):
            carrier, pose = self.plant.world_body(), one.world_from_body
            found[BodyIndex(OBSTACLE, i)] = self._added(one.body, carrier, pose, f"obstacle {i}")
        return found

    def _added(self, body: Body, carrier: Any, pose: np.ndarray, name: str) -> Any:
        """A body as Drake's own box, sphere or cylinder where it is one, else as the hull of its vertices."""
        from pydrake.geometry import Box, Convex, Cylinder, Sphere
        from pydrake.multibody.plant import CoulombFriction

        at, low, high = pose.copy(), *body.shape.bounds
        round_one = round_shape(body)
        corners = ((body.shape.vertices == low) | (body.shape.vertices == high)).all()
        if body.origin == "box" and corners:
            shape = Box(*(high - low))
            at[:3, 3] += pose[:3, :3] @ (0.5 * (low + high))
        elif round_one is not None:
            radius, length = round_one.radius, round_one.length
            shape = Sphere(radius) if body.origin == "sphere" else Cylinder(radius, length)
            at[:3, 3] += pose[:3, :3] @ round_one.centre
        else:
            shape = Convex(body.shape.vertices.T, label=name)
        return self.plant.RegisterCollisionGeometry(
            carrier, _rigid(at), shape, name, CoulombFriction()
        )

    def _leave_out(self, ids: dict[BodyIndex, Any]) -> None:
        """All pairs that are not measured."""
        from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

        meant = {frozenset(pair) for pair in measured_pairs(self.case)[0]}
        out = CollisionFilterDeclaration()
        for a, b in combinations(ids, 2):
            if frozenset((a, b)) not in meant:
                out.ExcludeBetween(GeometrySet(ids[a]), GeometrySet(ids[b]))
        self.graph.collision_filter_manager().Apply(out)


def _rigid(pose: np.ndarray) -> Any:
    from pydrake.math import RigidTransform, RotationMatrix

    return RigidTransform(RotationMatrix.ProjectToRotationMatrix(pose[:3, :3]), pose[:3, 3])


def _is_convex(case: Case) -> bool:
    """Whether all bodies are the hulls of their vertices, to a micrometre."""
    shapes = [body.shape for body in case.robots[0].robot.bodies]
    shapes += [one.body.shape for one in case.obstacles]
    for shape in shapes:
        above = (shape.normals @ shape.vertices.T).max(axis=1)
        if (above - (shape.normals * shape.centres).sum(axis=1)).max() > 1e-6:
            return False
    return True
