"""Ways to find the least clearance of every step where several bodies of a pair may move: ours and the peers'.

All get the same pairs and the same triangles. Pinocchio works out where everything is inside the clock, as we
do; for python-fcl poses are made beforehand. Not for: the clock (`clock`), one robot among standing things
(`loops`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from inputs import Solid
from peers import Fcl, available, silenced

from clearance.kernels.motion.kinematics import FIXED, NO_PARENT, SLIDING, TURNING
from clearance.record.certificate import Certificate
from clearance.record.measurement import Measurement
from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.simulate.measure.sections import SectionPlan, section_plan
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of, joined_positions, link_poses_at
from clearance.world.kinematics import values_by_link
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import BodyIndex, measured_pairs
from clearance.world.timeline import Timeline, timeline_of


class Actors:
    """A case in which nothing changes hands, ready to be measured: its pairs, its motion, its bodies."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.motions = tuple(kinematic_motion(placed) for placed in case.robots)
        self.pairs, _ = measured_pairs(case)
        self.bodies = sorted({body for pair in self.pairs for body in (pair.a, pair.b)})
        self.index = [(self.bodies.index(p.a), self.bodies.index(p.b)) for p in self.pairs]

    @property
    def n_steps(self) -> int:
        """Number of steps."""
        return self.motions[0].n_steps

    @cached_property
    def solids(self) -> list[Solid]:
        """Its bodies as the peers take them."""
        return [inputs.solid(body.body_in(self.case)) for body in self.bodies]

    @cached_property
    def poses(self) -> np.ndarray:
        """(bodies, steps, 4, 4) [m]."""
        links = link_poses_at(self.case, self.motions, slice(None))
        return np.stack([body.poses_in(self.case, links) for body in self.bodies])

    @cached_property
    def values(self) -> np.ndarray:
        """(steps, links) of the joint above each link of the forest [rad or m]."""
        links = forest_of(self.case).links
        return values_by_link(links, joined_positions(self.case, self.motions, slice(None)))

    def measure(self, need: str = "steps") -> Measurement:
        """Ours, on one thread."""
        what = PairsInMotion(self.case, self.motions, self.pairs)  # laid out inside the clock
        return measure(what, need, Resources(jobs=1))


class OurLoop:
    """`clearance.simulate.measure.measure.measure`: kinematics, laying out and sweep, all in the clock."""

    name, library, coherent = "clearance: steps", "clearance", True

    def __init__(self, actors: Actors) -> None:
        self._actors = actors
        self.counters: dict[str, int] = {}

    def run(self, steps: np.ndarray) -> np.ndarray:
        """All steps."""
        found = self._actors.measure()
        self.counters = found.tally
        return found.clearance[steps]


class PinocchioLoop:
    """`pinocchio.computeDistances`: kinematics, then Coal on every registered pair; its trees are OBB-RSS.

    Nearest points are not asked for, which makes it faster.
    """

    name, library, coherent = "Pinocchio + Coal: computeDistances", "pinocchio", False

    def __init__(self, actors: Actors) -> None:
        import pinocchio

        self._pin, self._actors = pinocchio, actors
        self.counters: dict[str, int] = {}
        links = forest_of(actors.case).links
        self._model, carriers, self._columns = self._tree(links)
        self._geometry = self._shapes(carriers)
        self._data, self._geometry_data = (
            self._model.createData(),
            self._pin.GeometryData(self._geometry),
        )
        for request in self._geometry_data.distanceRequests:
            request.enable_nearest_points = False

    def _tree(self, links: Any) -> tuple[Any, list, np.ndarray]:
        """A model of the forest, (joint, pose on it) of each link, and the link whose value each joint takes."""
        pin = self._pin
        model, carriers, columns = pin.Model(), [], []
        for i, kind in enumerate(links.kinds):
            joint, pose = 0, np.eye(4)
            if links.parents[i] != NO_PARENT:
                joint, pose = carriers[links.parents[i]]
            pose = pose @ links.parent_from_joint[i]
            if kind == FIXED or links.parents[i] == NO_PARENT:
                carriers.append((joint, pose))
                continue
            made = {
                TURNING: pin.JointModelRevoluteUnaligned,
                SLIDING: pin.JointModelPrismaticUnaligned,
            }
            here = model.addJoint(
                joint, made[int(kind)](links.axes[i]), pin.SE3(pose), f"joint {i}"
            )
            carriers.append((here, np.eye(4)))
            columns.append(i)
        return model, carriers, np.array(columns)

    def _shapes(self, carriers: list) -> Any:
        """All bodies as triangles, and our pairs."""
        pin, actors = self._pin, self._actors
        geometry = pin.GeometryModel()
        for body, solid in zip(actors.bodies, actors.solids, strict=True):
            joint, pose = self._carrier(body, carriers)
            name = body.name_in(actors.case)
            made = pin.GeometryObject(name, joint, pin.SE3(pose), coal_mesh(solid))
            geometry.addGeometryObject(made)
        for i, j in actors.index:
            geometry.addCollisionPair(pin.CollisionPair(i, j))
        return geometry

    def _carrier(self, body: BodyIndex, carriers: list) -> tuple[int, np.ndarray]:
        frame = body.frame_in(self._actors.case)
        if frame == WORLD:
            return 0, self._actors.case.obstacles[body.i_body].world_from_body
        return carriers[frame]

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        found = np.array([self._step(int(step)) for step in steps])
        self.counters = {"queries": len(self._actors.index) * len(steps)}
        return found

    def every(self, step: int) -> np.ndarray:
        """(p,) [m] what it says of each pair at a step."""
        self._step(step)
        return np.array([found.min_distance for found in self._geometry_data.distanceResults])

    def _step(self, step: int) -> float:
        values = self._actors.values[step, self._columns]
        least = self._pin.computeDistances(
            self._model, self._data, self._geometry, self._geometry_data, values
        )
        return self._geometry_data.distanceResults[least].min_distance


class FclLoop:
    """python-fcl: `fcl.distance` on every pair, bodies placed beforehand by us."""

    name, library, coherent = "FCL: all pairs", "FCL", False

    def __init__(self, actors: Actors) -> None:
        self._actors, self._peer = actors, Fcl()
        self.counters: dict[str, int] = {}
        with silenced():
            self._bodies = [self._peer.body(solid) for solid in actors.solids]

    def run(self, steps: np.ndarray) -> np.ndarray:
        """Any steps."""
        found = np.array([self._step(int(step)) for step in steps])
        self.counters = {"queries": len(self._actors.index) * len(steps)}
        return found

    def _step(self, step: int) -> float:
        bodies, distance = self._bodies, self._peer.distance
        for body, pose in zip(bodies, self._actors.poses[:, step], strict=True):
            self._peer.place(body, pose)
        return min(distance(bodies[i], bodies[j]) for i, j in self._actors.index)


@dataclass(frozen=True, eq=False)
class Sections:
    """A case over time, in the parts that are measured together: phases, rules, paddings."""

    timeline: Timeline
    plan: SectionPlan


def sections_of(case: Case) -> Sections:
    """Those of any case, also one in which parts change hands."""
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    return Sections(timeline, section_plan(timeline))


def measured_sections(sections: Sections) -> list[Measurement]:
    """`steps` of each section, on one thread."""
    return [
        measure(replace(own.in_motion), "steps", Resources(jobs=1))  # a new layout
        for own in sections.plan.sections
    ]


def certified_sections(
    sections: Sections, found: list[Measurement], gap: float
) -> list[Certificate]:
    """The certificate of each section to a gap [m], on one thread."""
    return [
        certify_motion(replace(own.in_motion), steps, gap, resources=Resources(jobs=1))
        for own, steps in zip(sections.plan.sections, found, strict=True)
    ]


def coal_mesh(solid: Solid) -> Any:
    """The triangles of a body as Coal's tree of OBB-RSS."""
    import coal

    soup = solid.soup
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(soup.triangles), len(soup.vertices))
    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in soup.vertices:
        points.append(vertex)
    for corners in soup.triangles.tolist():
        triangles.append(coal.Triangle(*corners))
    model.addSubModel(points, triangles)
    model.endModel()
    return model


def loops_of(actors: Actors) -> list:
    """Ours first, then the peers whose library is there."""
    loops: list = [OurLoop(actors)]
    if available("pinocchio"):
        loops.append(PinocchioLoop(actors))
    if available("fcl"):
        loops.append(FclLoop(actors))
    return loops
