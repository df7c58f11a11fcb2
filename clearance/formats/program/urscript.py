"""Programs in URScript. Metres, radians, seconds; a pose is a point and a rotation vector, seen from the base.

Sources: Universal Robots, The URScript programming language (moves, `pose_trans`, blends, `movec` modes).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.errors import BadProgram, DuplicateName, MissingKey, at, nearest_name
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
    ProgramRequest,
    Target,
)
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
from clearance.formats.program.statements import Do, Routine, Statement
from clearance.formats.program.tokens import Line, text_of
from clearance.formats.program.urscript_text import UrScript, labels_of, script_of
from clearance.formats.program.urscript_words import (
    BLOCKING,
    BLOCKING_BEFORE,
    DEFAULTS,
    OTHER_MOVES,
    PARAMETERS,
    STILL,
    STILL_BEFORE,
    TARGETS,
)
from clearance.geometry.pose import inverse, pose_from_rotation_vector
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
        tool = asked.asked.tools.get(TCP)
        language = _UrScript(None if tool is None else tool.matrix(), labels_of(text))
        run = Execution(language, script.routines, frozenset(asked.asked.skip))
        entry = _entry(script, asked.asked.entry)
        run.run(_outside(data_of_others, run.routines))
        run.run(script.body if entry is None else _outside(script.body, run.routines))
        if entry is not None:
            run.run(script.routines[entry].body)
        return ControllerProgram((*run.moves,), (*run.notes,), maker="ur", left_out=run.left_out)


def _outside(body: Iterable[Statement], routines: Mapping[str, Routine]) -> list[Statement]:
    """What stands outside of functions, without calls of these."""
    return [one for one in body if not (isinstance(one, Do) and one.call.name in routines)]


def _entry(script: UrScript, asked: str | None) -> str | None:
    """The function that is the program; None where statements outside of all are.

    Raises:
        BadInput: there is no such function, or several could be it.
    """
    outer = [name for name in script.outer if not script.routines[name].is_thread]
    if asked is not None:
        if asked not in outer:
            valid = nearest_name(asked, outer)
            raise BadProgram(f"there is no function {asked!r}", where="entry", valid=valid)
        return asked
    if script.body or not outer:
        return None
    if len(outer) > 1:
        fault = f"functions {', '.join(outer)} are there, and nothing calls one"
        raise MissingKey(fault, where="entry", valid="the one that is the program")
    return outer[0]


@dataclass(eq=False)
class _UrScript:
    """What URScript's functions do.

    Attributes:
        tool: (4, 4) `flange_from_tool` [m]; None until it is known. labels: of nodes, by line.
        last: the target of the last move, if it stops. share: of all speeds, which `set_speed` says.
    """

    tool: np.ndarray | None
    labels: Mapping[int, str]
    last: Any = None
    share: float = 1.0
    suffix = ""
    retiming = frozenset(("set_speed",))

    @property
    def state(self) -> Any:
        """The tool, where it is, and the share of all speeds."""
        return (None if self.tool is None else self.tool.tolist(), self.last, self.share)

    def moves(self, name: str) -> bool | None:
        """Whether a function decides where the robot goes; None for one that is not known."""
        if name in PARAMETERS or name in OTHER_MOVES or name == "set_tcp":
            return True
        still = name in STILL or name in _VALUES or name.startswith(STILL_BEFORE)
        return False if still or name in ("sleep", "pose_trans", "get_inverse_kin") else None

    def waits(self, call: Call) -> bool:
        """Whether a function waits for someone; a popup does if it blocks."""
        if call.name == "popup":
            blocks = call.named.get("blocking", call.args[4] if len(call.args) > 4 else None)
            return blocks not in (None, Constant(False))
        return call.name in BLOCKING or call.name.startswith(BLOCKING_BEFORE)

    def value_of(self, name: str, _: Execution) -> Any:
        """None: all names but `True` and `False` are variables."""
        return {"pi": math.pi}.get(name)

    def writes(self, _: Call) -> tuple[Expression, ...]:
        """None: functions have values and change no variables."""
        return ()

    def items(self, values: list[Any], kind: str) -> Any:
        """A list, or a pose."""
        return ToolPose(values) if kind else values

    def part_of(self, value: Any, by: Any) -> Any:
        """An item of a list."""
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
            (seconds,) = (number(run.evaluated(one), call.line, "the time") for one in call.args)
            if seconds > 0.0:
                where = call.line.number, seconds, call.line.file
                run.add(ControllerWait(*where, reads_on=True))
        elif call.name == "set_tcp":
            (pose, *_) = (run.evaluated(one) for one in (*call.args, *call.named.values()))
            self.tool, self.last = _placed(pose, call.line), None
        elif call.name == "run":
            name = call.args[0].value if isinstance(call.args[0], Constant) else ""
            run.run_concurrently("thread", name, call.line)
            run.note("threads that move nothing", f"{name} ({call.line})")
        elif self.moves(call.name):
            raise BadProgram(
                f"{call.name} moves the robot on a way that the file does not decide",
                where=str(call.line),
                valid=f"{', '.join(PARAMETERS)}",
            )
        elif call.name == "set_speed" and call.args:
            self.share = run.share_of_speeds(run.evaluated(call.args[0]), call, 1.0)
        else:
            run.pass_over(call)

    def result_of(self, call: Call, run: Execution) -> Any:
        """The value of a function."""
        args = [run.evaluated(one) for one in call.args]
        named = {name: run.evaluated(one) for name, one in call.named.items()}
        if call.name in ("get_actual_tcp_pose", "get_target_tcp_pose"):
            if isinstance(self.last, ToolPose):
                return ToolPose(self.last)
        elif call.name in ("get_actual_joint_positions", "get_target_joint_positions"):
            if isinstance(self.last, list) and not isinstance(self.last, ToolPose):
                return [*self.last]
        elif call.name == "get_inverse_kin":
            near = named.get("qnear", args[1] if len(args) > 1 else None)
            pose = args[0] if args else named.get("x")
            if isinstance(pose, Unknown):
                return pose
            with_near = None if near is None else _six(near, call.line, "qnear")
            own = named.get("tcp", args[4] if len(args) > 4 else "")
            tool = self._tool(call.line, False) if isinstance(own, str) else _placed(own, call.line)
            return Solved((_placed(pose, call.line) @ inverse(tool)).tolist(), with_near)
        elif call.name in _VALUES:
            unknown = [one for one in args if isinstance(one, Unknown)]
            return unknown[0] if unknown else _value(call, args)
        return Unknown(f"{call.name}() at {call.line}")

    def _move(self, call: Call, run: Execution) -> None:
        given = _arguments(call, run)
        values = {name: run.evaluated(one) for name, one in given.items()}
        options = {
            name: number(value, call.line, name)
            for name, value in values.items()
            if name in ("a", "v", "t", "r", "mode")
        }
        acceleration, speed = (
            options.get(name, usual)
            for name, usual in zip(("a", "v"), DEFAULTS[call.name], strict=True)
        )
        for name, value in {"a": acceleration, "v": speed}.items():
            if not value > 0.0:
                raise BadProgram(f"{name} is {value:g}", where=str(call.line), valid="more than 0")
        if call.name == "movep":
            run.note(
                "r of movep is taken for the distance of its arc from the corner", f"{call.line}"
            )
        ends = [key for key in TARGETS if key in given]
        if len(ends) != (2 if call.name == "movec" else 1):
            raise MissingKey(f"{call.name} has no target", where=str(call.line))
        label = "" if call.line.file else self.labels.get(call.line.number, "")
        targets = [_target(values[key], given[key], call.line, self.tool, label) for key in ends]
        is_joints = call.name == "movej"
        move = ControllerMove(
            call.line.number,
            "ptp" if is_joints else "lin" if len(ends) == 1 else "circ",
            targets[-1],
            self._tool(call.line, is_joints and isinstance(targets[-1], AxisTarget)),
            targets[0] if len(ends) == 2 else None,
            "tangent" if options.get("mode") == 1.0 else "to",
            speed=None if is_joints else speed,
            acceleration=None if is_joints else acceleration * self.share**2,
            axis_speed=speed if is_joints else None,
            axis_acceleration=acceleration * self.share**2 if is_joints else None,
            time=options["t"] if options.get("t", 0.0) > 0.0 else None,
            zone=options.get("r", 0.0),
            file=call.line.file,
        )
        run.add(move.slowed(self.share))
        self.last = values[ends[-1]] if move.zone == 0.0 else None

    def _tool(self, line: Line, is_any: bool) -> np.ndarray:
        """The tool.

        Raises:
            MissingKey: the script takes that of the installation, and the case does not say it.
        """
        if self.tool is not None or is_any:
            return np.eye(4) if self.tool is None else self.tool
        raise MissingKey(
            "no set_tcp before this move: its tool is that of the installation",
            where=str(line),
            valid=f"program: {{tools: {{{TCP}: {{xyz: […]}}}}}}, its pose on the flange",
        )


def _target(value: Any, one: Expression, line: Line, tool: np.ndarray | None, label: str) -> Target:
    """The target of a tool that a value is, with the name that it has in the script, or else its node's."""
    known(value, line, "the target")
    by = one.args[0] if isinstance(one, Call) and isinstance(value, Solved) and one.args else one
    name = by.name if isinstance(by, Name) else label
    if isinstance(value, Solved):
        near = None if value.near is None else tuple(value.near)
        flange = np.array(value.flange)
        return PoseTarget(flange if tool is None else flange @ tool, near=near, name=name)
    if isinstance(value, ToolPose):
        return PoseTarget(_placed(value, line), name=name)
    return AxisTarget(tuple(_six(value, line, "the target")), name=name)


def _arguments(call: Call, run: Execution) -> dict[str, Expression]:
    """The arguments of a move, by name.

    Raises:
        BadInput: one that it does not have.
    """
    names = PARAMETERS[call.name]
    if len(call.args) > len(names):
        fault = f"{call.name} is given {len(call.args)} arguments"
        raise BadProgram(fault, where=str(call.line), valid=f"at most {len(names)}")
    for name in call.named:
        if name not in names:
            valid = nearest_name(name, names)
            raise BadProgram(f"{call.name} has no {name!r}", where=str(call.line), valid=valid)
    return {**dict(zip(names, call.args, strict=False)), **call.named}


def _index(by: Any) -> int:
    if by != int(by) or by < 0:
        raise IndexError(by)
    return int(by)


def _six(value: Any, line: Line, what: str) -> list[float]:
    if not isinstance(value, list) or len(value) != 6:
        raise BadProgram(f"{what} is {value!r:.60}", where=str(line), valid="six numbers")
    return [number(one, line, what) for one in value]


def _pose(value: Any, line: Line) -> ToolPose:
    known(value, line, "the pose")
    if not isinstance(value, ToolPose):
        raise BadProgram(f"{value!r:.60} is given", where=str(line), valid="a pose p[…]")
    return ToolPose(_six(value, line, "the pose"))


def _placed(value: Any, line: Line) -> np.ndarray:
    """(4, 4) of a value that has to be a pose [m].

    Raises:
        BadInput: with the line.
    """
    pose = _pose(value, line)
    with at(str(line)):
        return _matrix(pose)


def _matrix(pose: ToolPose) -> np.ndarray:
    """(4, 4) of a pose [m]."""
    return pose_from_rotation_vector(pose[:3], pose[3:])


def _written(matrix: np.ndarray) -> ToolPose:
    """The pose of a (4, 4) matrix [m]."""
    return ToolPose([*matrix[:3, 3].tolist(), *rotation_vector(matrix[:3, :3]).tolist()])


def _value(call: Call, args: list[Any]) -> Any:
    try:
        return _VALUES[call.name](*args)
    except (ArithmeticError, IndexError, TypeError, ValueError, AttributeError):
        given = ", ".join(f"{one!r:.40}" for one in args)
        raise BadProgram(f"{call.name} has no value for {given}", where=str(call.line)) from None


def _of_poses(act: Callable[..., np.ndarray]) -> Callable[..., ToolPose]:
    """A function of poses by one of their matrices."""

    def applied(*poses: Any) -> ToolPose:
        if not all(isinstance(one, ToolPose) and len(one) == 6 for one in poses):
            raise TypeError
        return _written(act(*(_matrix(one) for one in poses)))

    return applied


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
    "norm": lambda a: abs(a) if isinstance(a, float) else math.hypot(*a),
    "length": lambda a: float(len(a)),
    "pose_trans": _of_poses(lambda a, b: a @ b),
    "pose_inv": _of_poses(inverse),
    "pose_add": _of_poses(_added),
    "point_dist": lambda a, b: math.dist(a[:3], b[:3]),
}
