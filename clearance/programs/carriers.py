"""What the targets of a program are seen from: links of the robot that move, each by the joints that a move names,
and carriages that move by themselves.

Not for: where frames are (`case.program`), how joints follow (`motion`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.errors import BadProgram, UnknownJoint, at, nearest_name
from clearance.programs.arm import Arm
from clearance.programs.moves import JointMove, Move, PathMove, Program, Wait
from clearance.world.kinematic_chain import chain_between
from clearance.world.robot import Robot


def on_carriers(robot: Robot, program: Program) -> Program:
    """The program with targets seen from the links that carry them: the nearest below which a joint moves.

    A joint moves that is of the arm, or that a move names; all others are where the program begins. A wait goes on
    with the carriage of the target before it.

    Raises:
        BadInput: nobody says where a joint is that a target is on; with the move.
    """
    arm = Arm(robot, program.link, program.link_from_tool)
    moving = {joint.name for joint in arm.own} | program.named
    moves, carriage = list[Move](), ""
    for one in program.moves:
        if isinstance(one, JointMove | PathMove):
            carriage = one.seen_from if one.seen_from in program.carriages else ""
        elif isinstance(one, Wait):
            one = replace(one, seen_from=carriage)
        if isinstance(one, JointMove | PathMove) and one.seen_from and not carriage:
            with at(one.where):
                carrier, pose = _carrier(robot, one.seen_from, moving, program.start)
            if one.pose is not None:
                one = replace(one, pose=pose @ one.pose)
            if isinstance(one, PathMove) and one.via is not None:
                one = replace(one, via=pose[:3, :3] @ one.via + pose[:3, 3])
            one = replace(one, seen_from=carrier)
        moves.append(one)
    return replace(program, moves=tuple(moves))


def _carrier(
    robot: Robot, link: str, moving: set[str], start: dict[str, float]
) -> tuple[str, np.ndarray]:
    """The link that carries another, empty for the root, and (4, 4) the pose of the other on it [m]."""
    above = {joint.child: joint.parent for joint in robot.joints}
    carrier = link
    while carrier in above:
        masters = chain_between(robot, above[carrier], carrier).masters
        if any(joint.name in moving for joint in masters):
            break
        carrier = above[carrier]
    chain = chain_between(robot, carrier, link)
    missing = [joint.name for joint in chain.masters if joint.name not in start]
    if missing:
        fault = f"the position of joint {missing[0]!r} below link {link!r} is not given"
        raise BadProgram(fault, where="start", valid="its position")
    at_rest = np.array([[start[joint.name] for joint in chain.masters]])
    return carrier if carrier in above else "", chain.frames(at_rest)[0, -1]


def arm_of(robot: Robot, program: Program) -> Arm:
    """The arm of a program: all joints that it moves, or that are between its tool and what its targets are on."""
    arm = Arm(robot, program.link, program.link_from_tool)
    names = set(program.named)
    for one in program.moves:
        if isinstance(one, JointMove | PathMove) and one.seen_from not in {"", *program.carriages}:
            chain = chain_between(robot, one.seen_from, program.link)
            names |= {joint.name for joint in chain.masters}
    return replace(arm, beside=tuple(names - {joint.name for joint in arm.own}))


def start_of(arm: Arm, program: Program) -> np.ndarray:
    """(k,) where the joints of the arm are at first.

    Raises:
        UnknownJoint: with the nearest name. BadInput: the place of one is not given.
    """
    names = [joint.name for joint in arm.robot.moving_joints]
    for name in program.start:
        if name not in names:
            valid = nearest_name(name, names)
            raise UnknownJoint(f"unknown joint {name!r}", where="start", valid=valid)
    missing = [joint.name for joint in arm.joints if joint.name not in program.start]
    if missing:
        raise BadProgram(
            f"no position of {', '.join(missing)}",
            where="start",
            valid="one for each joint that the program moves",
        )
    return np.array([program.start[joint.name] for joint in arm.joints])
