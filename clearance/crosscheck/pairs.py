"""The measured pairs of a record, each body ready for both questions: how far (FCL), inside or not
(winding).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.crosscheck.containment import is_inside
from clearance.crosscheck.fcl_adapter import PeerBody
from clearance.crosscheck.triangles import TriangleSoup, triangle_soup
from clearance.crosscheck.witness import PointLocator
from clearance.simulate.record import Samples
from clearance.world.body import Body
from clearance.world.pairs import measured_pairs


@dataclass(frozen=True, eq=False)
class PeerSide:
    """One body of the run."""

    name: str
    soup: TriangleSoup
    peer: PeerBody
    locator: PointLocator

    def distance(self, point: np.ndarray, solid: bool) -> float:
        """The distance [m] of a point (3,) in the body frame from the surface, or from the
        solid.
        """
        if solid and is_inside(self.soup, point[None])[0]:
            return 0.0
        return self.locator.distance(point)


@dataclass(frozen=True, eq=False)
class PeerPair:
    """A measured pair.

    Attributes:
        i_mover: index into the movers of the run.
        world_from_obstacle: (4, 4) pose [m].
    """

    i_mover: int
    link: PeerSide
    obstacle: PeerSide
    world_from_obstacle: np.ndarray


@dataclass(frozen=True)
class Mover:
    """A link that is measured against something: its robot, its column in `Motion.poses`, its
    name.
    """

    i_robot: int
    i_link: int
    name: str


def peer_pairs(record: Samples) -> tuple[list[Mover], list[PeerPair]]:
    """The links that take part and every pair that the record does not list as unmeasured.

    Links are named as in the record: with their robot's name where there are several.
    """
    left_out = {(entry.link, entry.obstacle) for entry in record.unmeasured}
    measured = {
        (p.a.i_robot, p.a.i_body, p.b.i_body)
        for p in measured_pairs(record.case)[0]
        if p.b.is_obstacle
    }
    obstacles = [(o, peer_side(o.body)) for o in record.case.obstacles]
    movers: list[Mover] = []
    pairs: list[PeerPair] = []
    several = len(record.motions) > 1
    for i_robot, motion in enumerate(record.motions):
        robot = motion.placed.robot
        prefix = f"{robot.name}/" if several else ""
        for i_body, body in enumerate(robot.bodies):
            name = prefix + body.name
            facing = [
                (o, side) for k, (o, side) in enumerate(obstacles)
                if (i_robot, i_body, k) in measured and (name, o.name) not in left_out
            ]  # fmt: skip
            if (name, "*") in left_out or not facing:
                continue
            link = replace(peer_side(body), name=name)
            pairs += [PeerPair(len(movers), link, side, o.world_from_body) for o, side in facing]
            movers.append(Mover(i_robot, robot.link_names.index(body.name), name))
    return movers, pairs


def peer_side(body: Body) -> PeerSide:
    """A body cut into triangles, as FCL tree and as numpy arrays."""
    soup = triangle_soup(body.shape)
    return PeerSide(body.name, soup, PeerBody(soup), PointLocator(soup))
