"""The greatest motion of bodies at any positions of their joints: bounds that need no state.

The distance of a body's point from the frame of a link below its own is bounded. The bound is the sum of the
lengths between, the travel of the slides and the offsets by errors. It is the lever about any axis there. Not for:
a state (`rows`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import dot, rigid, row, sub
from clearance.kernels.budget.rows import ball_of, chord
from clearance.kernels.motion.joint_path import ANGLE, OUTWARD
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING


class Levers(NamedTuple):
    """Bounds on the motion of bodies.

    Attributes:
        reach: (bodies,) [m] the greatest motion of any point of each by errors.
        of_links: (bodies, links) [m/rad] or [m/m] the greatest motion of any point by the joint above a link.
        excess: (bodies, links) [m/rad] or [m/m] how much greater errors make the motion of any point by it.
        slides: (links,) [m] the greatest travel of slides from their frames. sizes: (bodies,) [m] the greatest
            distance of any point of each from its origin, or -1 before the levers are filled.
        steps: (links, 2) by `TRAVEL` [rad or m] of the joint above each between two steps, by `UNMOVED` 1 where no
            joint above moves between them.
    """

    reach: Floats
    of_links: Floats2
    excess: Floats2
    slides: Floats
    sizes: Floats
    steps: Floats2


TRAVEL, UNMOVED = 0, 1


@inline
def new_levers(n_bodies, n_links):
    """Levers, not filled yet."""
    return Levers(
        np.zeros(n_bodies), np.zeros((n_bodies, n_links)), np.zeros((n_bodies, n_links)),
        np.zeros(n_links), np.full(n_bodies, -1.0), np.zeros((n_links, 2)),
    )  # fmt: skip


@inline
def fill_levers(surface, world, path, errors, levers):
    """Fills the levers of all bodies for joints that move along a path, once."""
    if len(levers.sizes) == 0 or levers.sizes[0] >= 0.0:
        return
    for link in range(len(levers.slides)):
        if world.links.kinds[link] == SLIDING:
            levers.slides[link] = _farthest_travel(path, link) + errors.joint[link]
    for body in range(len(world.frames)):
        levers.sizes[body] = _size(surface, world, body)
        if world.frames[body] < 0:
            levers.reach[body] = _reach_of_standing(surface, world, body, errors)
        else:
            levers.reach[body] = _fill(surface, world, body, errors, levers)


@inline
def _farthest_travel(path, link):
    """[m] the greatest distance of a joint from 0, between steps as well."""
    travel = bow = 0.0
    for step in range(len(path.times)):
        travel = max(travel, abs(path.positions[step, link]))
    for step in range(len(path.times) - 1):
        bow = max(bow, bow_of(path, step, link))
    return (travel + bow) * OUTWARD


@inline
def bow_of(path, step, link):
    """[rad or m] the greatest deviation of a joint from linear motion to the next step."""
    if len(path.velocities) == 0 or not path.is_cubic[link]:
        return 0.0
    length = path.times[step + 1] - path.times[step]
    travel = path.positions[step + 1, link] - path.positions[step, link]
    e0 = length * path.velocities[step, link] - travel
    e1 = length * path.velocities[step + 1, link] - travel
    return 0.25 * max(abs(e0), abs(e1))


@inline
def _length(v):
    return math.sqrt(dot(v, v))


@inline
def _size(surface, world, body):
    """[m] the greatest distance of any point of a body from its origin."""
    ball = ball_of(surface, surface.roots[world.solids[body]])
    return _length(ball.t) + ball.radius


@inline
def _reach_of_standing(surface, world, body, errors):
    ball, extras = ball_of(surface, surface.roots[world.solids[body]]), errors.of_bodies
    reach = 0.0
    for k in range(extras.starts[body], extras.starts[body + 1]):
        far = _length(sub(ball.t, row(extras.origins, k))) + ball.radius
        reach += chord(extras.angle[k]) * (far + reach) + extras.xyz[k]
    return reach * OUTWARD


@inline
def _turns(links, i, errors):
    """[rad] the greatest turn by all errors from a link to the base."""
    turns = 0.0
    while i != NO_PARENT:
        turns += errors.angle[i]
        if links.parents[i] != NO_PARENT and links.kinds[i] == TURNING:
            turns += errors.joint[i]
        for k in range(errors.of_links.starts[i], errors.of_links.starts[i + 1]):
            turns += errors.of_links.angle[k]
        i = links.parents[i]
    return turns


@inline
def _fill(surface, world, body, errors, levers):
    """Writes the levers of a body that a link carries; [m] the greatest motion of any point of it by errors."""
    links, i = world.links, world.frames[body]
    far = levers.sizes[body]
    reach, turned = 0.0, chord(_turns(links, i, errors))
    while i != NO_PARENT:
        if links.parents[i] != NO_PARENT:
            if links.kinds[i] == TURNING:
                levers.of_links[body, i] = far + reach
                levers.excess[body, i] = turned * (far + reach) + reach
                reach += chord(errors.joint[i]) * (far + reach)
            elif links.kinds[i] == SLIDING:
                levers.of_links[body, i], levers.excess[body, i] = 1.0, turned
                reach += errors.joint[i]
                far += levers.slides[i]
        reach += chord(errors.angle[i]) * (far + reach) + errors.xyz[i]
        far += errors.xyz[i]
        extras = errors.of_links
        for k in range(extras.starts[i], extras.starts[i + 1]):
            arm = far + _length(row(extras.origins, k))
            reach += chord(extras.angle[k]) * (arm + reach) + extras.xyz[k]
            far += extras.xyz[k]
        far += _length(rigid(links.parent_from_joint[i]).t)
        i = links.parents[i]
    return reach * OUTWARD


@inline(force=True)
def moved_from_step(world, path, step, body, levers):
    """[m] the greatest motion of any point of a body from one step to the next, with any errors."""
    links, i = world.links, world.frames[body]
    moved = 0.0
    while i >= 0 and links.parents[i] != NO_PARENT:
        travel = abs(path.positions[step + 1, i] - path.positions[step, i]) + bow_of(path, step, i)
        moved += travel * levers.of_links[body, i]
        i = links.parents[i]
    for ball in range(len(path.balls.links)):
        lever = levers.of_links[body, path.balls.links[ball]]
        moved += path.balls.arcs[step, ball, ANGLE] * lever
    return moved * (1.0 + 1e-9)


@inline
def _turns_not(balls, ball, before, step):
    """True if a ball joint has one orientation from one step to a later one."""
    last = min(step, len(balls.arcs) - 1)
    for between in range(before, step):
        if balls.arcs[between, ball, ANGLE] != 0.0:
            return False
    for between in range(before + 1, last + 1):
        for k in range(4):
            if balls.arcs[between, ball, k] != balls.arcs[before, ball, k]:
                return False
    return True


@inline
def fill_steps(world, path, before, step, levers):
    """Writes the travel of joints from one step to a later one, and the links that do not move meanwhile."""
    links, steps = world.links, levers.steps
    for link in range(len(links.parents)):
        travel = abs(path.positions[step, link] - path.positions[before, link])
        steps[link, TRAVEL], steps[link, UNMOVED] = travel, 1.0 if travel == 0.0 else 0.0
    for ball in range(len(path.balls.links)):
        if not _turns_not(path.balls, ball, before, step):
            steps[path.balls.links[ball], UNMOVED] = 0.0
    for link in range(len(links.parents)):
        if links.parents[link] != NO_PARENT and steps[links.parents[link], UNMOVED] == 0.0:
            steps[link, UNMOVED] = 0.0


@inline(force=True)
def excess_of_motion(world, path, before, step, body, levers):
    """[m] how much errors increase the motion of any point of a body from one step to a later one.

    `levers.steps` has the motion of joints between these steps.
    """
    links, i = world.links, world.frames[body]
    moved = 0.0
    while i >= 0 and links.parents[i] != NO_PARENT:
        moved += levers.steps[i, TRAVEL] * levers.excess[body, i]
        i = links.parents[i]
    for ball in range(len(path.balls.links)):
        excess = levers.excess[body, path.balls.links[ball]]
        for between in range(before, step):
            moved += path.balls.arcs[between, ball, ANGLE] * excess
    return moved * (1.0 + 1e-9)


@inline(force=True)
def moved_in_part(world, middle, body, levers):
    """[m] the greatest motion of any point of a body from the middle of a part of an interval, without errors."""
    links, i = world.links, world.frames[body]
    moved = 0.0
    while i >= 0 and links.parents[i] != NO_PARENT:
        moved += (abs(middle.swing[i]) + middle.bend[i]) * levers.of_links[body, i]
        i = links.parents[i]
    return moved * (1.0 + 1e-9)
