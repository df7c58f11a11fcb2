"""Programs in URScript. Metres, radians, seconds; a pose is a point and a rotation vector, seen from the base.

Sources: Universal Robots, The URScript programming language (moves, `pose_trans`, blends, `movec` modes).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.errors import BadProgram, DuplicateName, MissingKey, at
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    PoseTarget,
    ProgramRequest,
    Target,
)
from clearance.formats.program.effects import arguments_of
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    Name,
    Unknown,
    known,
    number,
)
from clearance.formats.program.language import Language, entry_of
from clearance.formats.program.statements import Do, Routine, Statement
from clearance.formats.program.tokens import text_of
from clearance.formats.program.urscript_text import labels_of, script_of
from clearance.formats.program.urscript_words import (
    BLOCKING,
    DEFAULTS,
    OTHER_MOVES,
    PARAMETERS,
    STILL,
    TARGETS,
)
from clearance.geometry.pose import inverse, pose_from_rotation_vector, pose_from_rpy
from clearance.geometry.quaternions import rotation_vector

TCP = "tcp"
"""The tool that a script takes from the installation, among the tools of a case."""


class ToolPose(list[Any]):
    """A value `p[…]`: a point [m] and a rotation vector [rad]."""


@dataclass(frozen=True)
class Solved:
    """The axes that bring the flange to a pose (4, 4) [m], nearest to some."""

    flange: list[list[float]]
    near: list[float] | None

    def __repr__(self) -> str:
        return "the axes of get_inverse_kin"


def read_urscript(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a script.

    Raises:
        BadInput: with the file and the line.
    """
    with at(asked.shown):
        script = script_of(text := text_of(asked.data))
        data_of_others = list[Statement]()
        for file, data in asked.beside.items():
            another = script_of(text_of(data, file), file)
            for name in another.routines.keys() & script.routines.keys():
                raise DuplicateName(f"{name!r} is defined twice", where=file)
            script.routines |= another.routines
            data_of_others += another.body
        tool, entry = asked.asked.tools.get(TCP), asked.asked.entry
        language = _UrScript(None if tool is None else tool.matrix(), labels_of(text))
        run = Execution(language, script.routines, frozenset(asked.asked.skip))
        names = [name for name in script.outer if not script.routines[name].is_thread]
        is_bare = entry is None and bool(script.body or not names)
        name = "" if is_bare else entry_of("function", names, entry, entry or "", "")
        run.run(_outside(data_of_others, run.routines))
        run.run(script.body if is_bare else _outside(script.body, run.routines))
        run.run(() if is_bare else script.routines[name].body)
        return language.program_of(run)


def _outside(body: Iterable[Statement], routines: Mapping[str, Routine]) -> list[Statement]:
    """What stands outside of functions, without calls of these."""
    return [one for one in body if not (isinstance(one, Do) and one.call.name in routines)]


def _target(value: Any, one: Expression, tool: np.ndarray | None, label: str) -> Target:
    """The target of a tool that a value is, with the name that it has in the script, or else its node's."""
    known(value, "the target")
    by = one.args[0] if isinstance(one, Call) and isinstance(value, Solved) and one.args else one
    name = by.name if isinstance(by, Name) else label
    if isinstance(value, Solved):
        near = None if value.near is None else tuple(value.near)
        flange = np.array(value.flange)
        return PoseTarget(flange if tool is None else flange @ tool, near=near, name=name)
    if isinstance(value, ToolPose):
        return PoseTarget(_placed(value), name=name)
    return AxisTarget(tuple(_six(value, "the target")), name=name)


def _index(by: Any) -> int:
    if by != int(by) or by < 0:
        raise IndexError(by)
    return int(by)


def _six(value: Any, what: str) -> list[float]:
    if not isinstance(value, list) or len(value) != 6:
        raise BadProgram(f"{what} is {value!r:.60}", valid="six numbers")
    return [number(one, what) for one in value]


def _placed(value: Any) -> np.ndarray:
    """(4, 4) of a value that has to be a pose [m].

    Raises:
        BadInput: it is none, or not known.
    """
    known(value, "the pose")
    if not isinstance(value, ToolPose):
        raise BadProgram(f"{value!r:.60} is given", valid="a pose p[…]")
    pose = _six(value, "the pose")
    return pose_from_rotation_vector(pose[:3], pose[3:])


def _written(matrix: np.ndarray) -> ToolPose:
    """The pose of a (4, 4) matrix [m]."""
    return ToolPose([*matrix[:3, 3].tolist(), *rotation_vector(matrix[:3, :3]).tolist()])


def _turned(*rpy: Any) -> Any:
    """The rotation vector of angles about the fixed x, then y, then z [rad]."""
    unknown = next((one for one in rpy if isinstance(one, Unknown)), None)
    turn = [number(one, "an angle") for one in rpy] if unknown is None else [0.0, 0.0, 0.0]
    return unknown or rotation_vector(pose_from_rpy([0.0, 0.0, 0.0], turn)[:3, :3]).tolist()


def _of_poses(act: Callable[..., np.ndarray]) -> Callable[..., ToolPose]:
    """A function of poses by one of their matrices."""
    return lambda *poses: _written(act(*map(_placed, poses)))


def _added(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """`pose_add`: points added, the rotations one after the other."""
    found = a @ b
    found[:3, 3] = a[:3, 3] + b[:3, 3]
    return found


_VALUES: Mapping[str, Callable[..., Any]] = {
    "d2r": math.radians,
    "r2d": math.degrees,
    **{
        name: getattr(math, name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "atan2")
    },
    **{name: getattr(math, name) for name in ("sqrt", "pow", "floor", "ceil", "log")},
    "fabs": abs,
    "abs": abs,
    "norm": lambda a: abs(a) if isinstance(a, float | int) else math.hypot(*a),
    "length": lambda a: float(len(a)),
    "pose_trans": _of_poses(lambda a, b: a @ b),
    "pose_inv": _of_poses(inverse),
    "pose_add": _of_poses(_added),
    "rpy2rotvec": lambda angles: _turned(*angles),
    "point_dist": lambda a, b: math.dist(a[:3], b[:3]),
}


@dataclass(eq=False)
class _UrScript(Language):
    """What URScript's functions do.

    Attributes:
        tool: (4, 4) `flange_from_tool` [m]; None until it is known. labels: of nodes, by line.
        last: the target of the last move, if it stops. share: of all speeds, which `set_speed` says.
    """

    tool: np.ndarray | None
    labels: Mapping[int, str]
    last: Any = None
    share: float = 1.0
    maker = "ur"
    moving = frozenset((*PARAMETERS, *OTHER_MOVES, "set_tcp"))
    still = frozenset((*STILL, *BLOCKING, *_VALUES))
    timed = BLOCKING
    retiming = ("set_speed",)
    values = _VALUES
    skips_overlaps = True

    @property
    def state(self) -> Any:
        """The tool, where it is, and the share of all speeds."""
        return (None if self.tool is None else self.tool.tolist(), self.last, self.share)

    def waits(self, call: Call) -> bool:
        """Whether a function waits for someone; a popup does if it blocks."""
        if call.name == "popup":
            blocks = call.named.get("blocking", call.args[4] if len(call.args) > 4 else None)
            return blocks not in (None, Constant(False))
        return super().waits(call)

    def value_of(self, name: str, run: Execution) -> Any:
        """None: all names but `True`, `False` and `pi` are variables."""
        return {"pi": math.pi}.get(name)

    def items(self, values: list[Any], kind: str) -> Any:
        """A list, or a pose."""
        return ToolPose(values) if kind else values

    def part_of(self, value: Any, by: Any) -> Any:
        """An item of a list.

        Raises:
            BadProgram: of axes that the robot alone decides.
        """
        if isinstance(value, Solved):
            fault = "one axis of get_inverse_kin is asked for, and they are not worked out"
            raise BadProgram(fault, valid="six numbers in its place")
        return value[_index(by)]

    def with_part(self, value: Any, by: Any, new: Any) -> None:
        """Changes an item of a list."""
        value[_index(by)] = new

    def instruct(self, call: Call, run: Execution) -> None:
        """A move, a wait, another tool; all else moves nothing.

        Raises:
            BadInput: a move of another kind.
        """
        if call.name in PARAMETERS:
            self._move(call, run)
        elif call.name == "sleep":
            self.wait(call, run)
        elif call.name == "set_tcp":
            (pose, *_) = (run.evaluated(one) for one in (*call.args, *call.named.values()))
            self.tool, self.last = _placed(pose), None
        elif call.name == "run":
            name = call.args[0].value if isinstance(call.args[0], Constant) else ""
            run.run_concurrently("thread", name)
            run.note("threads that move nothing", f"{name} ({call.line})")
        elif self.moves(call.name):
            fault = f"{call.name} moves the robot on a way that the file does not decide"
            raise BadProgram(fault, valid=", ".join(PARAMETERS))
        elif call.name == "set_speed" and call.args:
            self.share = run.share_of_speeds(run.evaluated(call.args[0]), call, 1.0)
        else:
            run.pass_over(call)

    def result_of(self, call: Call, run: Execution) -> Any:
        """The value of a function."""
        asks_pose = call.name in ("get_actual_tcp_pose", "get_target_tcp_pose")
        if asks_pose or call.name in ("get_actual_joint_positions", "get_target_joint_positions"):
            if isinstance(self.last, ToolPose) == asks_pose and isinstance(self.last, list):
                return copy.copy(self.last)
            if isinstance(self.last, list):
                form = "joints" if asks_pose else "a pose"
                text = f"the move before ends at {form}; joints and poses are not converted"
                return Unknown(f"{call.name}() at {call.line} ({text})")
        elif call.name == "get_inverse_kin":
            names = ("x", "qnear", "maxPositionError", "maxOrientationError", "tcp")
            given = arguments_of(call, names)
            pose, near, own = (
                run.evaluated(given[name]) if name in given else None
                for name in ("x", "qnear", "tcp")
            )
            if isinstance(pose, Unknown):
                return pose
            tool = self._tool(False) if own is None or isinstance(own, str) else _placed(own)
            with_near = None if near is None else _six(near, "qnear")
            return Solved((_placed(pose) @ inverse(tool)).tolist(), with_near)
        return super().result_of(call, run)

    def _move(self, call: Call, run: Execution) -> None:
        given = arguments_of(call, PARAMETERS[call.name])
        values = {name: run.evaluated(one) for name, one in given.items()}
        options = {
            name: number(value, name)
            for name, value in values.items()
            if name in ("a", "v", "t", "r", "mode")
        }
        acceleration, speed = (
            options.get(name, usual)
            for name, usual in zip(("a", "v"), DEFAULTS[call.name], strict=True)
        )
        for name, value in {"a": acceleration, "v": speed}.items():
            if not value > 0.0:
                raise BadProgram(f"{name} is {value:g}", valid="more than 0")
        if call.name == "movep":
            what = "r of movep is taken for the distance of its arc from the corner"
            run.note(what, f"{call.line}")
        ends = [key for key in TARGETS if key in given]
        if len(ends) != (2 if call.name == "movec" else 1):
            raise MissingKey(f"{call.name} has no target")
        label = "" if call.line.file else self.labels.get(call.line.number, "")
        targets = [_target(values[key], given[key], self.tool, label) for key in ends]
        is_joints = call.name == "movej"
        move = ControllerMove(
            call.line,
            "ptp" if is_joints else "lin" if len(ends) == 1 else "circ",
            targets[-1],
            self._tool(is_joints and isinstance(targets[-1], AxisTarget) and not options.get("r")),
            targets[0] if len(ends) == 2 else None,
            "tangent" if options.get("mode") == 1.0 else "to",
            speed=None if is_joints else speed,
            acceleration=None if is_joints else acceleration * self.share**2,
            axis_speed=speed if is_joints else None,
            axis_acceleration=acceleration * self.share**2 if is_joints else None,
            time=options["t"] if options.get("t", 0.0) > 0.0 else None,
            zone=options.get("r", 0.0),
        )
        run.add(move.slowed(self.share))
        self.last = values[ends[-1]] if move.zone == 0.0 else None

    def _tool(self, is_any: bool) -> np.ndarray:
        """The tool.

        Raises:
            MissingKey: the script takes that of the installation, and the case does not say it.
        """
        if self.tool is not None or is_any:
            return np.eye(4) if self.tool is None else self.tool
        fault = "no set_tcp before this move: its tool is that of the installation"
        valid = f"program: {{tools: {{{TCP}: {{xyz: […]}}}}}}, its pose on the flange"
        raise MissingKey(fault, valid=valid)
